"""The stand-alone checker refuses, each for its own reason, what no random change of a certificate is sure to meet."""

from __future__ import annotations

from typing import Any

import pytest

from safety.prove import check
from safety.prove.certificate import described
from safety.system import State
from safety.terms.graph import BIT, uint, variable
from tests.prove.certified import problem_of

N: Any = variable("n", uint(4))
STEP: Any = variable("step", uint(2))
UP: Any = variable("up", BIT)


def text(**more: Any) -> Any:
    """A small problem with a slice, a bit, a division and an addition, as json."""
    after = (N // 3 + N + STEP).low(4)
    return described(problem_of([State(N, after, 0)], [STEP, UP], (N <= 15) | N.bit(0), **more), 0)


def test_the_small_problem_is_read() -> None:
    assert check.read(text()).depth == 0


@pytest.mark.parametrize(
    ("op", "place", "value"),
    [
        ("slice", 2, [0, 512]), ("slice", 2, [-1, 4]), ("slice", 2, [0]), ("bit", 2, 512), ("bit", 2, -1),
        ("bit", 2, True), ("div", 2, 0), ("div", 2, 1 << 511), ("add", 2, 1), ("add", 1, [0, 99]), ("add", 1, [0, -1]),
        ("add", 1, [0]), ("add", 1, [0, True]), ("add", 0, "plus"),
    ],
)  # fmt: skip
def test_a_node_that_means_nothing_is_refused(op: str, place: int, value: Any) -> None:
    json_ = text()
    next(node for node in json_["nodes"] if node[0] == op)[place] = value
    with pytest.raises(check.Malformed, match=r"nodes\["):
        check.read(json_)


@pytest.mark.parametrize(("key", "value"), [("format", "another"), ("arithmetic", "reals"), ("depth", -1)])
def test_a_certificate_of_another_kind_is_refused(key: str, value: Any) -> None:
    with pytest.raises(check.Malformed, match=f"{key}: expected"):
        check.read(text() | {key: value})


@pytest.mark.parametrize("more", [{"start": ~UP}, {"lemmas": {"up": UP}}])
def test_inputs_in_the_start_or_in_lemmas_are_refused(more: Any) -> None:
    with pytest.raises(check.Malformed, match=r"registers only, not the inputs \['up'\]"):
        check.read(text(**more))


SORTS = [  # operation, attribute, arguments, the least sort that has every value
    ("add", None, ["u2", "int[-1, 5]"], (-1, 8)),
    ("sub", None, ["u2", "int[-1, 5]"], (-5, 4)),
    ("mul", None, ["int[-2, 3]", "int[-1, 5]"], (-10, 15)),
    ("select", None, ["bit", "int[-2, 3]", "u4"], (-2, 15)),
    ("cast", None, ["u3"], (0, 7)),
    ("slice", [1, 3], ["u8"], (0, 7)),
    ("concat", None, ["u2", "u3"], (0, 31)),
    ("div", 3, ["u4"], (0, 5)),
    ("mod", 3, ["u4"], (0, 2)),
    *((op, None, ["u2", "u4"], (0, 15)) for op in check.WORDWISE),
]


def test_every_operation_with_a_range_is_among_them() -> None:
    assert {op for op, *_ in SORTS} == set(check.RANGES)


@pytest.mark.parametrize(("op", "attr", "args", "ends"), SORTS)
def test_a_sort_that_lacks_a_value_is_refused(op: str, attr: Any, args: list[str], ends: tuple[int, int]) -> None:
    kind = check.SIGNATURES[op].rpartition(">")[2].replace("r", "n")
    given = [check.sort_of(arg, "") for arg in args]

    def fits(low: int, high: int) -> bool:
        return check.well_sorted(op, attr, check.Sort("word" if kind == "w" else "int", low, high), given)

    low, high = ends
    assert fits(low, high) and fits(low - 1, high + 1)
    assert not fits(low + 1, high) and not fits(low, high - 1)


CLAUSES = [(1, 2), (-1,), (-2, 3)]  # satisfiable: 2 and 3


@pytest.mark.parametrize(
    "proof",
    [
        "4 0 1 2 0",  # the first hint leaves two literals open
        "4 0 2 3 0",  # the last hint is not false
        "4 2 0 2 1 0\n5 0 4 1 0",  # the last is true
        "4 0 2 9 0",  # a clause that there is not
        "4 0 0",  # no hints
        "4 2 0 2 1 0",  # never empty
        "4 2 0 2 1",  # no end
    ],
)
def test_a_proof_with_a_step_that_does_not_follow_is_refused(proof: str) -> None:
    with pytest.raises(check.Rejected):
        check.check_lrat(CLAUSES, proof)


def test_a_proof_whose_steps_follow_is_accepted() -> None:
    check.check_lrat([*CLAUSES, (-3,)], "5 2 0 2 1 0\n6 0 5 3 4 0")


def test_a_number_that_is_taken_is_refused() -> None:
    with pytest.raises(check.Rejected, match="line 1"):
        check.check_lrat([*CLAUSES, (-3,)], "4 2 0 2 1 0\n6 0 4 3 4 0")
