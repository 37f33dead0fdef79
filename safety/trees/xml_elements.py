"""XML as plain elements that know their line. Document type declarations, and with them all entities, are refused."""

from __future__ import annotations

from dataclasses import dataclass, field
from xml.parsers import expat

from safety.trees.tree import TreeError


@dataclass
class Element:
    """One XML element; `text` is its character data without that of its children."""

    tag: str
    attributes: dict[str, str]
    place: str  # "file:line"
    children: list[Element] = field(default_factory=list)
    text: str = ""

    def get(self, attribute: str) -> str:
        """The value of a required attribute. Raises TreeError."""
        if attribute not in self.attributes:
            raise self.error(f'<{self.tag}> has no attribute "{attribute}"; add it')
        return self.attributes[attribute]

    def child(self, tag: str) -> Element | None:
        """The first child with `tag`, if there is one."""
        return next((child for child in self.children if child.tag == tag), None)

    def error(self, message: str) -> TreeError:
        """An error at this element's place."""
        return TreeError(message, place=self.place)


def parse(text: bytes, file: str) -> Element:
    """The root element of an XML document.

    Raises TreeError with file and line when it is malformed or declares a document type.
    """
    parser = expat.ParserCreate()
    root = Element("", {}, file)
    path = [root]

    def start(tag: str, attributes: dict[str, str]) -> None:
        element = Element(tag, attributes, f"{file}:{parser.CurrentLineNumber}")
        path[-1].children.append(element)
        path.append(element)

    def end(_: str) -> None:
        path.pop()

    def characters(data: str) -> None:
        path[-1].text += data

    def doctype(*_: object) -> None:
        raise TreeError(
            "a document type (<!DOCTYPE>) is not accepted, as it could define entities; remove it",
            place=f"{file}:{parser.CurrentLineNumber}",
        )

    parser.StartElementHandler = start
    parser.EndElementHandler = end
    parser.CharacterDataHandler = characters
    parser.StartDoctypeDeclHandler = doctype
    try:
        parser.Parse(text, True)
    except expat.ExpatError as error:
        raise TreeError(
            f"{file}:{error.lineno}: not well-formed XML ({expat.ErrorString(error.code)}); correct it there"
        ) from None
    return root.children[0]
