import pytest

from safety.commands import CommandError
from safety.commands.options import typed
from safety.commands.selection import expression


@pytest.mark.parametrize(
    ("text", "chosen"),
    [
        ("", "ring.a ring.b voting.a"),
        ("ring", "ring.a ring.b"),
        ("RING", "ring.a ring.b"),
        ("not ring", "voting.a"),
        ("ring and .a", "ring.a"),
        ("ring and not .a", "ring.b"),
        ("ring or voting", "ring.a ring.b voting.a"),
        ("ring and .b or voting", "ring.b voting.a"),
        ("(ring or voting) and .a", "ring.a voting.a"),
        ("not (ring and .a)", "ring.b voting.a"),
        ("not not ring", "ring.a ring.b"),
        ("nothing", ""),
    ],
)
def test_words_select_as_in_pytest(text: str, chosen: str) -> None:
    assert [name for name in ("ring.a", "ring.b", "voting.a") if expression(text)(name)] == chosen.split()


@pytest.mark.parametrize("text", ["and", "a and", "a b", "(a", "a)", "not", "a or or b", "()"])
def test_an_unreadable_expression_is_refused_with_its_text(text: str) -> None:
    with pytest.raises(CommandError, match="-k"):
        expression(text)


@pytest.mark.parametrize(
    ("text", "value"), [("true", True), ("False", False), ("12", 12), ("-3", -3), ("0x1f", 31), ("4/2", 2), ("6/2", 3)]
)
def test_a_setting_has_the_type_it_is_written_in(text: str, value: object) -> None:
    assert typed(text) == value
    assert isinstance(typed(text), bool) == isinstance(value, bool)
