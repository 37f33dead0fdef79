"""What is in a file, and what no file can be made of."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from safety.export import FORMATS, aiger, export
from safety.export.bits import GATES
from safety.export.gates import FALSE
from safety.export.transition import transition
from safety.system import ANY, ModelError, State
from safety.terms import TermError, UInt
from safety.terms.graph import BIT, REAL, integer, uint, variable
from safety.terms.values import all_of, bit
from tests.export.claims import CLAIMS
from tests.export.readers import read_aiger
from tests.export.systems import Question, system_of
from tests.export.test_runs import check_folded, check_plain, ours
from tests.export.test_tools import READERS

# --- names ---------------------------------------------------------------------------------------------------------

AWKWARD = [
    *("ite", "div", "true", "let", "bvadd", "n3", "n12", "$3", "clk", "module", "wire", "always", "tool.first"),
    *("a b", "a_b", "a b_2", "x'", "x", "start", "given", "holds", "next", "a.b (step 0)", "sort", "claim"),
]


def named(names: list[str], wrong: int | None) -> Question:
    """Registers and inputs by these names, each with a value of its own; one is said to be another."""
    own: list[Any] = [variable(name, uint(6)) for name in names]
    states = [State(v, v, i) for i, v in enumerate(own) if i % 2]
    inputs = [v for i, v in enumerate(own) if i % 2 == 0]
    given = all_of(*(v == i for i, v in enumerate(own) if i % 2 == 0))
    holds = all_of(*(v == (63 if i == wrong else i) for i, v in enumerate(own)))
    return Question(system_of(states, inputs, {"out": own[0].bit(0), "n5": own[1].bit(0)}), holds, given, own[1] == 1)


@pytest.mark.parametrize("reader", READERS)
def test_any_name_will_do(reader: str, tmp_path: Path) -> None:
    assert READERS[reader](named(AWKWARD, None), tmp_path) is None  # type: ignore[arg-type]
    for wrong in (4, 5):
        assert READERS[reader](named(AWKWARD, wrong), tmp_path) == 1  # type: ignore[arg-type]


# --- what is written -----------------------------------------------------------------------------------------------


def question(state: State, holds: Any, **more: Any) -> Question:
    return Question(system_of([state], [], {}), holds, **more)


def test_only_what_the_verdict_depends_on_is_written() -> None:
    n, other = (variable(name, uint(4)) for name in ("n", "other"))
    whole = system_of([State(n, n, 0), State(other, other, 0)], [variable("p", BIT)], {"seen": n, "unseen": other})
    what = transition(Question(whole, n < 3))  # type: ignore[operator]
    assert ([s.path for s in what.states], what.inputs, list(what.named)) == (["n"], (), ["seen"])
    kept = transition(Question(whole, n < 3, given=other < 3))  # type: ignore[operator]
    assert [s.path for s in kept.states] == ["n", "other"]


def test_lemmas_have_to_be_shown_and_are_not_assumed() -> None:
    make, _ = CLAIMS["no fault"]
    problem = make()
    assert transition(problem, lemmas=True).given is transition(problem).given is problem.given
    assert transition(problem, lemmas=True).holds is all_of(problem.holds, *problem.lemmas.values())


def test_the_file_of_2007_has_neither_power_up_values_nor_constraints() -> None:
    for make, _ in CLAIMS.values():
        file = read_aiger(aiger.aiger(make()))
        assert {reset for _, _, reset in file.registers} == {0}
        assert (len(file.bad), file.constraints) == (1, [])


def test_binary_and_ascii_are_one_file() -> None:
    for make, _ in CLAIMS.values():
        problem = make()
        for folded in (True, False):
            ascii_text = aiger.aag(problem, fold_constraints=folded).encode()
            assert read_aiger(ascii_text) == read_aiger(aiger.aiger(problem, fold_constraints=folded))


def test_a_file_is_the_same_every_time() -> None:
    make, _ = CLAIMS["fault"]
    for form in FORMATS:
        assert export(make(), form) == export(make(), form)


# --- what is refused -----------------------------------------------------------------------------------------------


@pytest.mark.parametrize("form", FORMATS)
def test_a_real_has_no_bits(form: str) -> None:
    level = variable("level", REAL)
    claim = question(State(level, level, ANY), level < 3)  # type: ignore[operator]
    if FORMATS[form].numbers:
        assert "Real" in export(claim, form)  # type: ignore[operator]
    with pytest.raises(TermError, match="level is a real: it has no bits; write SMT-LIB or VMT over integers"):
        export(claim, form, integers=False)


def test_there_are_formats_and_no_others() -> None:
    with pytest.raises(ModelError, match="there is no format 'btor'; did you mean btor2"):
        export(CLAIMS["nine"][0](), "btor")


def test_a_register_that_changes_its_sort_is_refused() -> None:
    n: UInt = variable("n", uint(4))  # type: ignore[assignment]
    for after in (n + 1, variable("n", integer(0, 15))):
        with pytest.raises(ModelError, match="n is u4, its next value"):
            transition(question(State(n, after, 0), n < 3))


def test_a_start_that_reads_an_input_is_refused() -> None:
    n, p = variable("n", uint(4)), variable("p", BIT)
    claim = Question(system_of([State(n, n, 0)], [p], {}), n < 3, start=p)  # type: ignore[operator]
    with pytest.raises(ModelError, match="the start reads the input p"):
        transition(claim)


# --- the comparison of runs can fail -------------------------------------------------------------------------------


def drawn() -> Question:
    n: Any = variable("n", uint(4))
    phase: Any = variable("phase", uint(4))
    k: Any = variable("k", uint(4))
    states = [State(n, (n + k).low(4), 5), State(phase, (phase - n).low(4), ANY)]
    said = {"holds": n != 3, "given": phase != 9, "start": phase < 8}
    return Question(system_of(states, [k], said), **said)


@pytest.mark.parametrize("check", [check_folded, check_plain])
@pytest.mark.parametrize("what", ["nothing", "power-up", "operation", "given", "start"])
def test_a_run_that_differs_is_found(
    what: str, check: Callable[[Question, Any], None], monkeypatch: pytest.MonkeyPatch
) -> None:
    from dataclasses import replace
    from random import Random

    traces = [ours(drawn(), Random(seed)) for seed in range(8)]
    planted = drawn()
    if what == "power-up":
        monkeypatch.setattr("safety.export.aiger.constant", lambda value, count: (FALSE,) * count)
    elif what == "operation":
        monkeypatch.setitem(GATES, "sub", GATES["add"])
    elif what in ("given", "start"):
        planted = replace(planted, **{what: bit(True)})
    if what == "nothing":
        for trace in traces:
            check(planted, trace)
    else:
        with pytest.raises(AssertionError):
            for trace in traces:
                check(planted, trace)
