"""XML as plain elements that know their line. Document type declarations, and with them all entities, are refused."""

from __future__ import annotations

from xml.parsers import expat

from safety.trees.as_written import TreeError

DEEPEST = 200  # elements inside each other; far beyond any formula that people write
NAMES = {"name", "event-tree", "functional-event"}  # attributes that hold names
MOST_TAGS = 8_000_000  # start and end tags of one file, so that no file takes all memory


class Element:
    """One XML element; `text` is the character data of a <label>."""

    __slots__ = ("attributes", "children", "file", "line", "tag", "text")

    def __init__(self, tag: str, attributes: dict[str, str], file: str, line: int) -> None:
        self.tag, self.attributes, self.file, self.line = tag, attributes, file, line
        self.children: list[Element] = []
        self.text = ""

    @property
    def place(self) -> str:
        """Where it starts, as "file:line"."""
        return f"{self.file}:{self.line}"

    def get(self, attribute: str) -> str:
        """The value of a required attribute. Raises TreeError."""
        if attribute not in self.attributes:
            raise self.error(f'<{self.tag}> has no attribute "{attribute}"; add it')
        return self.attributes[attribute]

    def child(self, tag: str) -> Element | None:
        """The first child with `tag`, if there is one."""
        return next((child for child in self.children if child.tag == tag), None)

    def made(self, tag: str, *children: Element) -> Element:
        """An element of another kind at this one's place."""
        element = Element(tag, {}, self.file, self.line)
        element.children.extend(children)
        return element

    def error(self, message: str) -> TreeError:
        """An error at this element's place."""
        return TreeError(message, place=self.place)


def parse(text: bytes, file: str) -> Element:
    """The root element of an XML document.

    Raises TreeError with file and line when it is malformed, nested too deeply, or declares a document type.
    """
    if text.count(b"<") > MOST_TAGS:
        raise TreeError(f"{file}: more than {MOST_TAGS} tags; split the file into several")
    parser = expat.ParserCreate()
    document = Element("", {}, file, 1)
    path = [document]
    push, pop = path.append, path.pop

    def start(tag: str, attributes: dict[str, str]) -> None:
        element = Element(tag, attributes, file, parser.CurrentLineNumber)
        path[-1].children.append(element)
        push(element)
        if tag == "label":  # elsewhere text has no meaning, and white space would cost a call for each line
            parser.CharacterDataHandler = characters
        elif len(path) > DEEPEST:
            raise element.error(f"<{tag}> is nested too deeply; give inner formulas names of their own")

    def end(tag: str) -> None:
        pop()
        if tag == "label":
            parser.CharacterDataHandler = None

    def characters(data: str) -> None:
        path[-1].text += data

    def doctype(name: str, system_id: str | None, public_id: str | None, has_subset: bool) -> None:
        if system_id or public_id or has_subset:
            raise TreeError(
                f"the document type <!DOCTYPE {name} ...> is not accepted, as it could define entities; write no more "
                f"than <!DOCTYPE {name}>",
                place=f"{file}:{parser.CurrentLineNumber}",
            )

    parser.StartElementHandler = start
    parser.EndElementHandler = end
    parser.StartDoctypeDeclHandler = doctype
    try:
        parser.Parse(text, True)
    except TreeError:
        raise
    except (LookupError, ValueError) as error:  # an encoding that Python does not know, or that takes several bytes
        raise TreeError(f"{file}:1: cannot be decoded ({error}); convert it to UTF-8") from None
    except expat.ExpatError as error:
        raise TreeError(
            f"{file}:{error.lineno}: not well-formed XML ({expat.ErrorString(error.code)}); correct it there"
        ) from None
    if b"_x" in text:
        _decode(document)
    return document.children[0]


def _decode(element: Element) -> None:
    """Give names that are written by the rule of `mef_names` back their letters."""
    from safety.trees.formats.mef_names import decoded

    for name in NAMES & element.attributes.keys():
        element.attributes[name] = decoded(element.attributes[name])
    for child in element.children:
        _decode(child)
