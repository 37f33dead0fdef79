"""Results kept between runs: one key for one problem, another for any other, and nothing damaged is ever believed."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from dataclasses import dataclass, field, replace
from fractions import Fraction
from pathlib import Path
from typing import Any

import pytest

from safety.canonical import NoKeyError, digest, files, read, text_of, written
from safety.faults import ANY_TIME, Fault, any_of_faults, at_most, byzantine, every, stuck
from safety.model import Model, parameter, point, power_up
from safety.prove import cache as caches
from safety.prove.cache import Cache, prover
from safety.prove.canonical import problem_key
from safety.prove.claims import BITS, REFUTED, VERDICTS, Claim, Scenario, age, once, persists
from safety.prove.prove import stated
from safety.system import ANY
from safety.terms import U4, Bit, implies, select
from tests.prove.small import asked, below_sixteen, passed_in_time
from tests.test_house import CORE

ROOT = Path(__file__).resolve().parents[2]
KEY = "0" * 64


def key(claim: Claim, *surroundings: str) -> str:
    return problem_key(stated(claim), *surroundings)


def test_what_is_tried_for_a_claim_is_part_of_its_key() -> None:
    """A bounded verdict where no more was asked for is not the last word where a proof is."""
    assert len({key(asked(below_sixteen, expect=expect)) for expect in VERDICTS}) == len(VERDICTS)


# --- the store -----------------------------------------------------------------------------------------------------


RECORD = {"big": 2**200, "infinite": float("inf"), "none": None, "list": [1, "a", {"deep": True}]}


def test_a_record_comes_back_as_it_was(cache: Cache, said: list[str]) -> None:
    assert cache.get(KEY) is None
    cache.put(KEY, RECORD)
    assert (cache.get(KEY), said) == (RECORD, [])
    cache.drop(KEY)
    cache.drop(KEY)
    assert (cache.get(KEY), said) == (None, [])


def test_no_damage_to_a_file_is_overlooked(cache: Cache, said: list[str]) -> None:
    cache.put(KEY, RECORD)
    path = next(cache.folder.iterdir())
    whole = path.read_bytes()
    for n in range(len(whole)):
        path.write_bytes(whole[:n] + bytes([whole[n] ^ 1]) + whole[n + 1 :])
        assert cache.get(KEY) is None, f"byte {n} changed"
        path.write_bytes(whole[:n])
        assert cache.get(KEY) is None, f"cut at byte {n}"
    assert len(said) == 2 * len(whole) and all("is damaged" in text and "worked out anew" in text for text in said)
    path.write_bytes(whole)
    assert cache.get(KEY) == RECORD


def test_a_record_under_another_name_is_not_believed(cache: Cache, said: list[str]) -> None:
    cache.put(KEY, {"verdict": "proved"})
    other = "1" * 64
    os.rename(cache.folder / f"{KEY}.json", cache.folder / f"{other}.json")
    assert cache.get(other) is None
    assert "checksum" in said[0]


def test_a_planted_cache_without_a_checksum_is_noticed(
    cache: Cache, said: list[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(caches, "_seal", lambda key, content: "ok")
    with pytest.raises(AssertionError):
        test_no_damage_to_a_file_is_overlooked(cache, said)


def test_the_longest_unused_go_first(tmp_path: Path, said: list[str]) -> None:
    cache = Cache(tmp_path, said.append, largest=510)
    for n in range(8):
        cache.put(f"{n}", "x" * 100)
        os.utime(tmp_path / f"{n}.json", (n, n))
    assert cache.get("0") is not None  # used now
    cache.prune()
    assert sorted(path.stem for path in tmp_path.iterdir()) == ["0", "6", "7"]


def test_a_folder_that_cannot_be_written_costs_a_note_and_no_result(tmp_path: Path, said: list[str]) -> None:
    (tmp_path / "file").write_text("")
    cache = Cache(tmp_path / "file" / "cache", said.append)
    cache.put(KEY, 1)
    cache.put(KEY, 1)
    cache.prune()
    assert len(said) == 1 and "cannot be kept" in said[0]


def test_digests_tell_texts_apart() -> None:
    assert len({digest(parts) for parts in (["ab", "c"], ["a", "bc"], ["abc"], ["ab", "c", ""], [b"ab", "d"])}) == 5


def test_every_source_of_the_prover_counts(tmp_path: Path) -> None:
    found = {path.relative_to(caches.PACKAGE).as_posix() for path in files(caches.PACKAGE, caches.PROVER)}
    assert {"system.py", "terms/smt.py", "prove/induction.py", "prove/prove.py"} <= found
    parts = {path.partition("/")[0].removesuffix(".py") for path in found}
    assert parts >= CORE
    (tmp_path / "terms").mkdir()
    (tmp_path / "terms" / "a.py").write_text("x = 1")
    before = text_of(tmp_path, files(tmp_path, caches.PROVER))
    (tmp_path / "terms" / "a.py").write_text("x = 2")
    assert text_of(tmp_path, files(tmp_path, caches.PROVER)) != before


def test_another_solver_version_is_another_prover(monkeypatch: pytest.MonkeyPatch) -> None:
    before = prover()
    monkeypatch.setattr("importlib.metadata.version", lambda name: "0.1" if name == "cvc5" else "4.0")
    assert prover() != before


# --- keys ------------------------------------------------------------------------------------------------------------


def test_words_do_not_count() -> None:
    plain = asked(below_sixteen)
    other = asked(
        below_sixteen,
        id="x.y",
        statement="else",
        requirement="R",
        source="[P]",
        twin_of="z",
        role="twin",
        expect="proved",
    )
    assert key(plain) == key(other)
    assert key(plain) != key(plain, "another prover")


class Other(Model, event="tick"):
    """The counter, with one thing changed."""

    n: U4 = power_up(0)
    passed: Bit = power_up(False)

    def step(self, go: Bit) -> tuple[Other, Bit]:
        n = point("n", select(go, (self.n + 2).low(4), self.n))
        return Other(n=n, passed=point("passed", self.passed | (self.n == 3))), point("high", self.n >= 8)


def claims() -> list[Claim]:
    """Claims no two of which ask the same."""
    run = Scenario(4, {"go": True})
    stuck_n, stuck_passed = Fault(stuck(0), ["n"]), Fault(stuck(0), ["passed"])
    one = asked(lambda s: s.n < 9)
    return [
        one,
        replace(one, expect=REFUTED),
        replace(one, model=Other),
        asked(lambda s: s.n < 8),
        asked(lambda s: s.n <= 9),
        asked(lambda s: implies(s.passed, s.n < 9)),
        replace(one, given=lambda s: s.go),
        replace(one, given=lambda s: ~s.go),
        replace(one, start=lambda s: s.n < 9),
        replace(one, anywhere=True),
        replace(one, lemmas=(below_sixteen,)),
        replace(one, lemmas=(below_sixteen, passed_in_time)),
        replace(one, steps=13),
        replace(one, induction=2),
        replace(one, arithmetic=BITS),
        replace(one, steps_per_frame=2),
        replace(one, faults=at_most(1, [stuck_n, stuck_passed])),
        replace(one, faults=any_of_faults([stuck_n, stuck_passed])),
        replace(one, faults=any_of_faults([stuck_passed, stuck_n])),
        replace(one, faults=at_most(1, [stuck_n, replace(stuck_passed, name="called")])),
        replace(one, faults=at_most(1, [stuck_n, replace(stuck_passed, onset=ANY_TIME)])),
        replace(one, faults=at_most(1, [stuck_n, Fault(byzantine(), ["passed"])])),
        replace(one, faults=at_most(1, every(stuck(0, bit=1), "n"))),
        replace(one, scenario=run),
        replace(one, witness=run),
        replace(one, scenario=replace(run, steps=5)),
        replace(one, scenario=replace(run, inputs={"go": lambda k: k < 3})),
        replace(one, scenario=replace(run, inputs={"go": lambda k: k < 2})),
        replace(one, scenario=replace(run, start={"n": 1})),
        replace(one, scenario=replace(run, at=1)),
        replace(one, scenario=replace(run, present=("a",))),
        replace(one, scenario=replace(run, values={"n": 1})),
        replace(one, scenario=replace(run, values={"n": Fraction(1)})),
        asked(lambda s: persists(s.go, 3)),
        asked(lambda s: persists(s.go, 4)),
        asked(lambda s: once(s.go)),
        asked(lambda s: age(s.go, 3) < 3),
    ]


def test_two_questions_never_share_a_key() -> None:
    keys = [key(claim) for claim in claims()]
    assert len(set(keys)) == len(keys)


def test_a_key_that_forgets_a_field_is_noticed(monkeypatch: pytest.MonkeyPatch) -> None:
    from safety.prove import canonical

    shown = canonical.ProblemText.shown
    monkeypatch.setattr(canonical.ProblemText, "shown", {**shown, "claim": shown["claim"] | {"steps"}})
    with pytest.raises(AssertionError):
        test_two_questions_never_share_a_key()


def test_the_same_values_of_a_scenario_are_the_same_question() -> None:
    one = asked(below_sixteen)
    scripts = [
        Scenario(4, {"go": True, "x": 1}),
        Scenario(4, {"x": 1, "go": True}),
    ]
    assert len({key(replace(one, scenario=script)) for script in scripts}) == 1
    moving = [Scenario(4, {"go": lambda k: k < 2}), Scenario(4, {"go": lambda k: k in (0, 1)})]
    assert len({key(replace(one, scenario=script)) for script in moving}) == 1


def test_what_cannot_be_written_down_has_no_key() -> None:
    one = asked(below_sixteen)
    with pytest.raises(NoKeyError, match="object"):
        key(replace(one, scenario=Scenario(4, {"go": object()})))
    with pytest.raises(NoKeyError, match="ZeroDivisionError"):
        key(replace(one, scenario=Scenario(4, {"go": lambda k: 1 // k})))


@dataclass(frozen=True)
class Later(Claim):
    """A claim with a field that came later."""

    engine: Any = field(default="induction", kw_only=True)


def test_a_field_that_came_later_counts_until_it_is_known_not_to() -> None:
    claim = asked(below_sixteen)
    values = {name: getattr(claim, name) for name in claim.__dataclass_fields__}
    one, other = Later(**values), Later(**values, engine="reachability")
    assert key(one) != key(other)
    with pytest.raises(NoKeyError, match="engine"):
        key(Later(**values, engine=len))


class Set(Model, event="tick"):
    """A counter that starts anywhere, with an open limit."""

    n: U4 = power_up(ANY)
    limit: U4 = parameter(8, unit="", within=(4, 12), source="[A] here")

    def step(self, go: Bit) -> tuple[Set, Bit]:
        return Set(n=select(go, (self.n + 1).low(4), self.n)), point("high", self.n >= self.limit)


def test_parameters_count_by_value() -> None:
    claim = asked(lambda s: s.high, Set)
    keys = [key(replace(claim, **changes)) for changes in ({}, {"settings": {"limit": 9}}, {"symbolic": ("limit",)})]
    assert len(set(keys)) == 3


ORDER = """
import sys, random
from tests.prove.test_cache import claims, key
asked = list(enumerate(claims()))
random.Random(int(sys.argv[1])).shuffle(asked)
print(*sorted(f"{n} {key(claim)}" for n, claim in asked), sep="\\n")
"""


def test_a_key_depends_neither_on_the_process_nor_on_what_was_asked_before() -> None:
    told = [
        subprocess.run(
            [sys.executable, "-c", ORDER, seed], cwd=ROOT, env={**os.environ, "PYTHONHASHSEED": seed},
            capture_output=True, text=True, check=True,
        ).stdout
        for seed in ("1", "2")
    ]  # fmt: skip
    assert told[0] == told[1]
    assert sorted(told[0].split()) == sorted(word for n, claim in enumerate(claims()) for word in (str(n), key(claim)))


@pytest.mark.parametrize(
    "data", [None, [], [[["add", None, ["int", 0, 1], [7]]], []], [[], [["a", 0]]], "text", [1, 2]]
)
def test_what_is_no_term_is_refused(data: Any) -> None:
    with pytest.raises(ValueError, match="no terms"):
        read(data)


def test_every_kind_of_term_comes_back() -> None:
    for claim in claims():
        problem = stated(claim)
        terms = dict(enumerate(problem.system.roots())) | {"holds": problem.holds, "given": problem.given}
        named = {str(name): term for name, term in terms.items()}
        back = read(json.loads(json.dumps(written(named))))
        assert all(back[name] is term for name, term in named.items())
