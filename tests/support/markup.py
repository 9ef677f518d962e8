"""Reads a page as a browser would, as far as tests ask: elements, attributes, and what stands in each script."""

from __future__ import annotations

import base64
import json
import zlib
from dataclasses import dataclass, field
from html.parser import HTMLParser

NASTY = '<script>document.title="hacked"<script><img src=x onerror="document.title=1"> &amp; [m6] {{ 7*7 }} `x` |'
"""The name of a part; names have no stroke, reasons may."""


@dataclass
class Read(HTMLParser):
    """Elements in order as (name, attributes), and the text of the scripts by their id or type."""

    elements: list[tuple[str, dict[str, str | None]]] = field(default_factory=list)
    scripts: dict[str, str] = field(default_factory=dict)
    texts: list[str] = field(default_factory=list)

    def __post_init__(self) -> None:
        super().__init__(convert_charrefs=True)
        self.inside: str | None = None

    def handle_starttag(self, tag, attrs):
        self.elements.append((tag, dict(attrs)))
        if tag == "script":
            self.inside = dict(attrs).get("id") or "program"
            self.scripts[self.inside] = ""

    def handle_endtag(self, tag):
        if tag == "script":
            self.inside = None

    def handle_data(self, data):
        if self.inside is None:
            self.texts.append(data)
        else:
            self.scripts[self.inside] += data

    @property
    def scene(self) -> dict:
        """The JSON of the scene."""
        return json.loads(self.scripts["scene"])

    @property
    def blob(self) -> bytes:
        """The numbers of the scene."""
        return zlib.decompress(base64.b64decode(self.scripts["blob"]))


def read(page: str) -> Read:
    """The page, taken apart."""
    parser = Read()
    parser.feed(page)
    parser.close()
    return parser
