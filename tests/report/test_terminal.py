"""The end of `verify`: the unexpected first, traces as tables, counts, exit code; plain where no terminal is."""

import io
from typing import Any

import pytest

from safety.report.terminal import WIDTH, changed_cells, show, summary

Results = dict[str, Any]


class Terminal(io.StringIO):
    def isatty(self) -> bool:
        return True


def claim(sample: Results, name: str) -> Results:
    return next(claim for claim in sample["claims"] if claim["id"] == name)


def test_the_unexpected_comes_first_and_the_exit_code_last(sample: Results) -> None:
    lines = [line.text for line in summary(sample)]
    assert lines[0] == "x REFUTED OR TARGET MISSED thr_wrong_release"
    assert lines[-1] == "exit 1: refuted or target missed"
    assert "10 claims: 1 bounded, 5 proved, 2 refuted (2 as they must be), 1 undecided, 1 vacuous" in lines


def test_the_changed_cells_of_a_counterexample(sample: Results) -> None:
    assert [line.text for line in changed_cells(claim(sample, "isolates_no_healthy_channel"))] == [
        "    faults  none",
        "    tick           0       2      3      4      5      6      7     !8",
        "    speed         60  *63.25  63.25  63.25  63.25  63.25  63.25  63.25",
        "    a.demand     any      *1      1      1      1      1      1      1",
        "    window.left    0      *5     *4     *3     *2     *1     *0      0",
        "    a.isolated     0       0      0      0      0      0      0     *1",
        "    * changed   ! violates isolates_no_healthy_channel   (1 earlier change after tick 0 not shown)",
        "    next    rightside replay proofs/ts7.py::isolates_no_healthy_channel",
    ]


def test_an_unexpected_counterexample_is_in_the_summary(sample: Results) -> None:
    refuted = claim(sample, "brakes_even_with_two") | {"expect": "proved"}
    text = "\n".join(line.text for line in summary({"claims": [refuted]}))
    assert "a.output byzantine; b.output byzantine" in text
    assert "! violates brakes_even_with_two" in text


def test_a_file_gets_plain_text(sample: Results) -> None:
    stream = io.StringIO()
    show(sample, stream)
    assert "\x1b" not in stream.getvalue()
    assert stream.getvalue().splitlines() == [line.text for line in summary(sample)]


def test_a_terminal_gets_colour(sample: Results, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("TERM", "xterm-256color")
    monkeypatch.delenv("NO_COLOR", raising=False)
    stream = Terminal()
    show(sample, stream)
    assert "\x1b[" in stream.getvalue()


def test_an_old_code_page_does_not_stop_it(sample: Results) -> None:
    raw = io.BytesIO()
    stream = io.TextIOWrapper(raw, encoding="cp932", write_through=True)
    show(sample | {"claims": [claim(sample, "key_restarts") | {"statement": "⌊x⌋ ✓ 速度 [red]"}]}, stream)
    assert "速度 [red]" in raw.getvalue().decode("cp932")


def test_control_characters_do_not_reach_the_terminal(sample: Results) -> None:
    hostile = claim(sample, "key_restarts") | {"id": "\x1b[2J\x07", "statement": "a\r\nb"}
    assert not any(letter < " " or letter == "\x7f" for line in summary({"claims": [hostile]}) for letter in line.text)


def test_lines_fit(sample: Results) -> None:
    long = claim(sample, "brakes_even_with_two") | {"expect": "proved", "statement": "x" * 500, "id": "y" * 300}
    assert max(len(line.text) for line in summary({"claims": [long]})) <= WIDTH


def test_many_unexpected_results_are_counted(sample: Results) -> None:
    many = [claim(sample, "key_restarts") | {"id": f"c{n}"} for n in range(25)]
    assert any("and 5 more results that are not as asked" in line.text for line in summary({"claims": many}))


def test_nothing_selected_is_said() -> None:
    assert [line.text for line in summary({})] == ["exit 5: nothing selected"]
