"""Writing on cards: wrapped and cut to the width, numbers short."""

import pytest

from safety.report.tree_text import clipped, power_of_ten, text_width, wrapped

LONG = "channel_a.reference_oscillator.frequency_divider.output_stage_stuck_at_zero"
WIDTH = 132.0


@pytest.mark.parametrize("text", [LONG, "a b c " * 20, "x" * 100, "速度照査装置の誤り側故障", "a  b\nc", " ", ""])
def test_text_is_wrapped_to_the_width_and_complete(text: str) -> None:
    lines = wrapped(text, WIDTH)
    assert "".join("".join(lines).split()) == "".join(text.split())
    assert all(text_width(line) <= WIDTH for line in lines)


@pytest.mark.parametrize("text", [LONG, "a b c " * 20, "x" * 5000, "速度照査装置の誤り側故障", "short"])
@pytest.mark.parametrize("most", [1, 2, 3])
def test_text_is_cut_to_the_lines_and_says_so(text: str, most: int) -> None:
    lines = clipped(text, WIDTH, most, bold=True)
    assert len(lines) <= most and all(text_width(line, bold=True) <= WIDTH for line in lines)
    assert lines[-1].endswith("…") == (len(wrapped(text, WIDTH, bold=True)) > most)


@pytest.mark.parametrize(
    ("value", "shown"),
    [(0, "0"), (1, "1"), (0.25, "0.25"), (1.2e-7, "1.2×10⁻⁷"), (1e-10, "1×10⁻¹⁰"), (0.0099999, "1×10⁻²")],
)
def test_numbers_are_short(value: float, shown: str) -> None:
    assert power_of_ten(value) == shown
