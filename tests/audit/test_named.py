"""Names in print: numbers of figures, spelling of words."""

import pytest

from safety.audit import named

FIGURES = {"Fig. 12": "limiter", "Fig. 17": "receiver", "Fig. 20": "program", "Plate 3": "map", "Plate 4": "map"}


@pytest.mark.parametrize(
    ("printed", "means", "verdict", "mended"),
    [
        ("Fig. 12", "limiter", "confirmed", ""),
        ("Fig. 12", "receiver", "misprint", "Fig. 17"),  # shows another thing
        ("Fig. 18", "receiver", "misprint", "Fig. 17"),  # one sign replaced, and there is no such figure
        ("Fig. 18", "program", "inconsistent", ""),  # two signs away, and there is no such figure
        ("Plate 5", "map", "inconsistent", ""),  # two may have been meant
        ("Fig. 12", "brake", "not derivable", ""),
    ],
)
def test_a_number_of_a_figure(printed: str, means: str, verdict: str, mended: str) -> None:
    found = named.judge(printed, means, FIGURES)
    assert (found.verdict, found.mended) == (verdict, mended)


@pytest.mark.parametrize(
    ("printed", "meant", "slip"),
    [
        ("Grobal", "Global", named.REPLACED),
        ("Gobal", "Global", named.LOST),
        ("Globbal", "Global", named.ADDED),
        ("Globals", "Global", named.ADDED),
        ("Glboal", "Global", named.EXCHANGED),
        ("Globa", "Global", named.LOST),
        ("Golbla", "Global", ""),
        ("Grobel", "Global", ""),
        ("", "Global", ""),
        ("ab", "ba", named.EXCHANGED),
        ("a", "b", named.REPLACED),
    ],
)
def test_one_slip_of_the_pen(printed: str, meant: str, slip: str) -> None:
    assert named.slipped(printed, meant) == slip
