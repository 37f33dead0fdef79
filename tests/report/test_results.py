"""A results document survives reading, merging and writing; a wrong one is refused with place and reason."""

import copy
import json
import os
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from safety.report import results as documents
from safety.report.results import ResultsError, canonical, dumps, empty, load, loads, merge, save

Results = dict[str, Any]

plain = st.none() | st.booleans() | st.integers() | st.floats(allow_nan=False, allow_infinity=False) | st.text()
values = st.recursive(plain, lambda inner: st.lists(inner) | st.dictionaries(st.text(), inner), max_leaves=12)


@given(extra=values)
def test_what_is_written_is_read_back(extra: Any) -> None:
    document = empty(rightside="0.1.0") | {"extra": extra}
    if any("\ud800" <= letter <= "\udfff" for letter in repr(extra)):
        return
    assert loads(dumps(document)) == document


@pytest.mark.parametrize("count", [2**63, 2**64 + 1, 10**300 + 7])
def test_integers_stay_exact_at_any_size(count: int) -> None:
    tree = {"id": "t", "minimal_cut_sets": {"count": count, "by_order": {"9": count}}}
    assert loads(dumps(empty() | {"trees": [tree]}))["trees"] == [tree]


def test_an_infinite_value_is_the_word_inf() -> None:
    rate = {"id": "r", "quantity": "MTTF", "value": float("inf"), "low": None}
    assert loads(dumps(empty() | {"rates": [rate]}))["rates"] == [rate | {"value": "inf"}]


@pytest.mark.parametrize("value", [float("nan"), float("-inf"), {1}, "\ud800"])
def test_what_json_cannot_hold_is_refused(value: Any) -> None:
    with pytest.raises(ResultsError, match="cannot be written as JSON"):
        dumps(empty() | {"extra": value})


def test_a_full_disk_is_told_with_the_file(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def full(*_: object) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(os, "replace", full)
    with pytest.raises(OSError, match=r"No space left on device: '.*results.json'"):
        save(empty(), tmp_path / "results.json")
    assert not list(tmp_path.iterdir())


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="there is no device that is always full")
def test_a_full_device_is_told_by_name() -> None:
    with pytest.raises(OSError, match="'/dev/full'") as told:
        save(empty(), Path("/dev/full"))
    assert told.value.filename == "/dev/full"


def test_text_does_not_depend_on_order(sample: Results) -> None:
    turned = {name: value[::-1] if isinstance(value, list) else value for name, value in reversed(sample.items())}
    assert dumps(canonical(turned)) == dumps(canonical(sample) | {"limits": turned["limits"]})


def test_canonical_form_is_a_fixed_point(sample: Results) -> None:
    assert canonical(canonical(sample)) == canonical(sample)


def test_canonical_form_does_not_touch_its_source(sample: Results) -> None:
    before = copy.deepcopy(sample)
    canonical(sample)
    assert sample == before


def test_canonical_form_has_no_times_no_machine_and_no_solver_version(sample: Results) -> None:
    text = dumps(canonical(sample))
    assert not {"seconds", "injections_per_second", "build-7", "5.4.0", "runs"} & set(json.loads(text))
    for volatile in ('"seconds"', "per_second", "build-7", "5.4.0", '"runs"'):
        assert volatile not in text


def test_canonical_form_forgets_the_last_digits_of_a_double() -> None:
    first, second = ({"rates": [{"id": "r", "quantity": "q", "value": value}]} for value in (0.1 + 0.2, 0.3))
    assert canonical(empty() | first) == canonical(empty() | second)


def test_canonical_form_keeps_every_judged_key(sample: Results) -> None:
    for section in ("claims", "campaigns", "trees", "rates", "figures"):
        before_and_after = zip(sorted(sample[section], key=documents.key), canonical(sample)[section], strict=True)
        for before, after in before_and_after:
            assert before.keys() - after.keys() <= documents.VOLATILE


def test_merging_the_parts_gives_the_whole(sample: Results) -> None:
    sections = ("claims", "campaigns", "trees", "rates", "figures")
    base = {name: value for name, value in sample.items() if name not in sections}
    parts = [base | {section: sample[section]} for section in sections]
    assert canonical(merge(*parts)) == canonical(sample)


def test_a_later_entry_of_the_same_model_and_id_wins() -> None:
    def claim(model: str, verdict: str) -> Results:
        return empty() | {"claims": [{"id": "c", "model": model, "expect": "proved", "verdict": verdict}]}

    merged = merge(claim("a", "undecided"), claim("b", "bounded"), claim("a", "proved"))
    assert [(c["model"], c["verdict"]) for c in merged["claims"]] == [("a", "proved"), ("b", "bounded")]


def test_merging_keeps_runs_and_limits_and_repeats_none() -> None:
    first = empty(rightside="0.1.0") | {"runs": [{"command": "prove"}], "limits": ["one"]}
    second = empty(z3="5") | {"runs": [{"command": "inject"}], "limits": ["one", "two"]}
    merged = merge(first, second)
    assert merged["runs"] == [{"command": "prove"}, {"command": "inject"}]
    assert (merged["limits"], merged["tool"]) == (["one", "two"], {"rightside": "0.1.0", "z3": "5"})


def broken(place: str, value: Any) -> str:
    document = {
        "schema": "rightside/1",
        "claims": [{"id": "P3", "model": "m", "expect": "proved", "verdict": "proved", "strength": {"steps": 3}}],
        "figures": [{"id": "F1", "verdict": "confirmed"}],
    }
    *path, last = [int(step) if step.isdigit() else step for step in place.split(".")]
    inner: Any = document
    for step in path:
        inner = inner[step]
    inner[last] = value
    return json.dumps(document)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", r"line 1, column 1: .*; expected JSON"),
        ('{"schema": 1\n "rates"}', r"line 2, column 2: .*; expected JSON"),
        ("[]", r"top: Expected `object`, got `array`"),
        ("{}", r'schema: None; expected "rightside/1"'),
        ('{"schema": "rightside/2"}', r'schema: \'rightside/2\'; expected "rightside/1"'),
        ('{"schema": "rightside/1", "rates": NaN}', r'NaN is not JSON; expected "inf" for an infinite value'),
        ('{"schema": "rightside/1", "schema": "rightside/1"}', r"key 'schema' stands twice in one object"),
        ("[" * 100_000, r"nested too deeply"),
        (broken("claims", {}), r"claims: Expected `array`, got `object`"),
        (broken("claims.0", {}), r"claims\[0\]: Object missing required field"),
        (
            broken("claims.0.verdict", "passed"),
            r"claims\[0\]\.verdict \(P3\): .*'passed'; expected one of proved, bounded, vacuous, refuted, undecided",
        ),
        (broken("figures.0.verdict", "fine"), r"figures\[0\]\.verdict \(F1\): .*; expected one of confirmed, rounding"),
        (
            broken("claims.0.strength.steps", "3"),
            r"claims\[0\]\.strength\.steps \(P3\): Expected `int \| null`, got `str`",
        ),
        (broken("claims.0.counterexample", {}), r"claims\[0\]\.counterexample \(P3\): Object missing required field"),
        (
            broken("claims.0.counterexample", {"tick_s": "8 kHz"}),
            r"claims\[0\]\.counterexample\.tick_s \(P3\): Expected",
        ),
        (broken("figures", [{"id": "a", "verdict": "assumed"}] * 2), r"figures\[1\]: id 'a' is used twice"),
    ],
)
def test_a_wrong_document_is_refused_with_file_place_and_expectation(tmp_path: Path, text: str, message: str) -> None:
    file = tmp_path / "results.json"
    file.write_text(text)
    with pytest.raises(ResultsError, match=message) as refused:
        load(file)
    assert str(refused.value).startswith(f"{file}: ")


def test_a_missing_file_says_what_writes_it(tmp_path: Path) -> None:
    with pytest.raises(ResultsError, match=r"results\.json: no such file; `rightside verify --json .*` writes it"):
        load(tmp_path / "results.json")


def test_a_folder_and_other_bytes_are_refused(tmp_path: Path) -> None:
    with pytest.raises(ResultsError, match="cannot be read"):
        load(tmp_path)
    (tmp_path / "x").write_bytes(b"\xff")
    with pytest.raises(ResultsError, match="byte 0: not UTF-8"):
        load(tmp_path / "x")


def test_unknown_keys_are_kept(tmp_path: Path, sample: Results) -> None:
    sample["claims"][0]["colour"] = "green"
    save(sample, tmp_path / "deep" / "results.json")
    assert load(tmp_path / "deep" / "results.json") == sample


def test_an_interrupted_write_leaves_the_old_file(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    file = tmp_path / "results.json"
    save(empty(rightside="1"), file)

    def broken_replace(source: str, target: Path) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr(os, "replace", broken_replace)
    with pytest.raises(KeyboardInterrupt):
        save(empty(rightside="2"), file)
    assert load(file)["tool"] == {"rightside": "1"}
    assert [path.name for path in tmp_path.iterdir()] == ["results.json"]


def test_a_report_without_event_trees_does_not_name_them() -> None:
    document: Results = {"schema": "rightside/1", "event_trees": []}
    assert "event_trees" not in canonical(document)
    one = {"id": "leak", "sequences": [], "seconds": {"total": 1.0}}
    assert canonical(document | {"event_trees": [one]})["event_trees"] == [{"id": "leak", "sequences": []}]
    merged = merge(document | {"event_trees": [one]}, document | {"event_trees": [one | {"id": "fire"}]})
    assert [entry["id"] for entry in merged["event_trees"]] == ["fire", "leak"]
