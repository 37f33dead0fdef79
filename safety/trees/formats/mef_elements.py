"""What the elements of Open-PSA MEF have in common: labels, attributes, and values that are not expressions."""

from __future__ import annotations

from collections.abc import Sequence

from safety.trees.formats.xml_elements import Element

ANNOTATIONS = ("label", "attributes")
NUMBERS = ("float", "int")
TRUTHS = {"true": True, "1": True, "false": False, "0": False}
Attributes = tuple[tuple[str, str], ...]


def content(element: Element) -> tuple[str, Attributes, list[Element]]:
    """Label on one line, attributes, and what else a definition holds."""
    children = element.children
    if len(children) == 1 and children[0].tag not in ANNOTATIONS:
        return "", (), children
    return description(element), attributes(element), [child for child in children if child.tag not in ANNOTATIONS]


def parts(element: Element, known: Sequence[str], required: int) -> dict[str, Element]:
    """What a definition holds, by tag, each of the tags in `known` once at most and the first `required` of them once.

    Raises TreeError.
    """
    found: dict[str, Element] = {}
    for child in content(element)[2]:
        if child.tag not in known:
            raise child.error(f"<{child.tag}> is not known in <{element.tag}>, expected {', '.join(known)}; remove it")
        if child.tag in found:
            raise child.error(f"<{child.tag}> stands in <{element.tag}> twice; remove one")
        found[child.tag] = child
    for tag in known[:required]:
        if tag not in found:
            raise element.error(f'<{element.tag}> "{element.attributes.get("name", "")}" has no <{tag}>; add it')
    return found


def only(element: Element, what: str) -> Element:
    """The one child of a definition besides its annotations."""
    _, _, children = content(element)
    if len(children) != 1:
        name = element.attributes.get("name", "")
        raise element.error(f'<{element.tag}> "{name}" holds {len(children)} elements, expected {what}; correct it')
    return children[0]


def description(element: Element) -> str:
    """The label, on one line."""
    label = element.child("label")
    return " ".join(label.text.split()) if label else ""


def attributes(element: Element) -> Attributes:
    """The names and texts in <attributes>."""
    group = element.child("attributes")
    return tuple((one.get("name"), one.get("value")) for one in group.children) if group else ()


def truth(element: Element) -> bool:
    """The value of <constant> or <bool>."""
    value = element.get("value").strip()
    if value not in TRUTHS:
        raise element.error(f'the constant is "{value}", expected true or false; correct it')
    return TRUTHS[value]


def whole(element: Element, attribute: str) -> int:
    """The value of an attribute that is a whole number, 0 or more."""
    value = element.get(attribute)
    if not value.strip().isdecimal() or len(value) > 9:
        raise element.error(f'{attribute}="{value}" of <{element.tag}> is not a whole number; correct it')
    return int(value)
