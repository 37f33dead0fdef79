"""SVG elements as text."""

from __future__ import annotations

from html import escape


def element(name: str, *content: str, **attributes: object) -> str:
    """One element. Content is markup, attributes are escaped; `class_` means class, `stroke_width` stroke-width."""
    given = "".join(f' {key.rstrip("_").replace("_", "-")}="{_value(value)}"' for key, value in attributes.items())
    return f"<{name}{given}>{''.join(content)}</{name}>" if content else f"<{name}{given}/>"


def text(words: object, x: float, y: float, **attributes: object) -> str:
    """Words, escaped, at a point."""
    return element("text", escape(str(words)), x=x, y=y, **attributes)


def _value(value: object) -> str:
    """Numbers to a tenth of a pixel: enough for the eye, and the same on every machine."""
    return f"{value:.1f}".removesuffix(".0") if isinstance(value, float) else escape(str(value))
