"""Fills the templates: how numbers, vectors and other people's text are written in each language."""

from __future__ import annotations

import math
from collections.abc import Iterable
from functools import cache
from typing import Any

import jinja2

from kinform.exports.names import comment
from kinform.foundation import escapes


def number(value: float) -> str:
    """The shortest decimal that reads back as the same double, with a point, as all languages want it."""
    value = float(value) + 0.0
    if not math.isfinite(value):
        raise ValueError("a number that is not finite cannot be written")
    text = repr(value)
    if "e" in text and "." not in text:
        text = text.replace("e", ".0e")
    return text


def vector(values: Iterable[float], separator: str = " ") -> str:
    """Numbers in a row."""
    return separator.join(number(value) for value in values)


def _attribute(text: object) -> str:
    """A quoted value of an XML attribute."""
    return f'"{escapes.xml(str(text))}"'


def _content(text: object) -> str:
    """The text of an XML element."""
    return escapes.xml(str(text))


def _quoted(text: object) -> str:
    """A string in Modelica."""
    return escapes.quoted(str(text))


@cache
def _environment(package: str) -> jinja2.Environment:
    environment = jinja2.Environment(
        loader=jinja2.PackageLoader(package, "."),
        undefined=jinja2.StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
        keep_trailing_newline=True,
        autoescape=False,
    )
    environment.filters |= {
        "number": number,
        "vector": vector,
        "xml": _attribute,
        "xml_content": _content,
        "quoted": _quoted,
        "comment": comment,
    }
    return environment


def render(package: str, template: str, /, **values: Any) -> bytes:
    """A template that lies in the folder of a package, filled in, as UTF-8; VHDL as ASCII, because its characters are
    those of Latin-1 at most.

    A name that the template misses raises.
    """
    text = _environment(package).get_template(template).render(**values)
    return text.encode("ascii", "backslashreplace") if template.endswith(".vhd.j2") else text.encode("utf-8")
