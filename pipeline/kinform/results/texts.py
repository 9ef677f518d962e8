"""How texts are kept in HDF5, which ends them at the first NUL: no text is the character ␀; a text that HDF5 cannot
hold (NUL, lone surrogates), or that begins with ␀, is ␀ followed by the text as JSON."""

from __future__ import annotations

import json
from typing import Any

from numpy.typing import NDArray

_NOTHING = "␀"


def stored_text(value: str | None) -> str:
    """The text as a dataset holds it."""
    if value is None:
        return _NOTHING
    if value.startswith(_NOTHING) or "\0" in value or (not value.isascii() and has_surrogates(value)):
        return _NOTHING + json.dumps(value)
    return value


def has_surrogates(value: str) -> bool:
    """Whether UTF-8 has no bytes for it."""
    return any("\ud800" <= character <= "\udfff" for character in value)


def read_texts_of(stored: NDArray[Any]) -> list[str | None]:
    """The texts that a dataset holds, which h5py gives as bytes; None: no text. ValueError where they are none."""
    if not len(stored):
        return []
    together = b"\0".join(stored.tolist()).decode()  # decoded at once, a tenth of the time: none has a NUL in it
    texts: list[str | None] = list(together.split("\0"))
    if _NOTHING in together:
        return [_text_of(text) if text and text.startswith(_NOTHING) else text for text in texts]
    return texts


def _text_of(stored: str) -> str | None:
    """The text that was stored as one that begins with ␀."""
    if stored == _NOTHING:
        return None
    text = json.loads(stored[1:])
    if not isinstance(text, str):
        raise ValueError(f"{stored!r} stands for no text")
    return text
