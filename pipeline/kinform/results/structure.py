"""What a results file may consist of, looked through before anything of it is read: groups, and datasets and attributes
of numbers and texts whose bytes are all there.

A digest says that a file is as somebody wrote it, not that kinform did. HDF5 can do much that kinform never does:
links to other files, data that other files hold, references to objects, filters, sizes that are declared and not there.
What of it would read other files, or take more memory than the file has bytes, is refused by name.
"""

from __future__ import annotations

from collections.abc import Iterator
from io import BufferedReader
from typing import Any

import h5py
import numpy as np
from h5py import h5a, h5d, h5g, h5l, h5o, h5s, h5t

from kinform.frozen import dataclass

MOST_OBJECTS = 10_000
"""Groups, datasets and attributes of a file: kinform writes some two hundred, whatever the design, and some for each
kind of thing that is in it. More would take long to look through, and are not of kinform."""
DEPTH = 6
"""Groups in groups: kinform writes three, and a group that contains itself has no end."""
READ_AT_ONCE = 1 << 16
"""Bytes of a table that are looked through at once: memory that is used again is cheaper than
new memory. Chosen, not measured."""


_SIMPLE = frozenset((h5t.INTEGER, h5t.FLOAT, h5t.ENUM, h5t.STRING))
_TEXT = np.dtype([("length", "<u4"), ("heap", "<u8"), ("index", "<u4")])
"""How a dataset holds a text of any length: where in the file its characters are."""
_GROWTH = _TEXT.itemsize - np.dtype(np.uintp).itemsize
"""Bytes that it takes more in a file than in memory, where it is a pointer."""


class ForeignError(ValueError):
    """The file holds something that kinform never writes; the message says what, and where."""


@dataclass(frozen=True)
class _Item:
    """What one number, text or row takes in a file."""

    size: int
    texts: tuple[int, ...]
    """Where in it texts of any length are."""


def check_structure(file: h5py.File, stream: BufferedReader, size: int) -> None:
    """Raise ForeignError where an open file of `size` bytes holds what no results file does. Errors of HDF5 as h5py
    raises them."""
    counted = 0
    for place, thing in _objects(file.id, "", DEPTH, set()):
        attributes = h5a.get_num_attrs(thing)
        counted += 1 + attributes
        if counted > MOST_OBJECTS:
            raise ForeignError(f"more than {MOST_OBJECTS} groups, datasets and attributes")
        for index in range(attributes):
            attribute = h5a.open(thing, index=index)
            _check_extent(attribute, _item(attribute.get_type(), place), place, size)
        if isinstance(thing, h5d.DatasetID):
            _check_dataset(thing, place, stream, size)


def _objects(group: Any, place: str, depth: int, seen: set[Any]) -> Iterator[tuple[str, Any]]:
    """A group, and all below it, with their places; each link is looked at before it is followed."""
    address = h5o.get_info(group).addr
    if address in seen or depth == 0:
        raise ForeignError(f"{place or '/'} once more inside of itself, or under another name")
    seen.add(address)
    yield place or "/", group
    for name in _names(group):
        inner = f"{place}/{_shown(name)}"
        if group.links.get_info(name).type != h5l.TYPE_HARD:
            raise ForeignError(f"{inner}, a link instead of data")
        item = h5o.open(group, name)
        if isinstance(item, h5g.GroupID):
            yield from _objects(item, inner, depth - 1, seen)
        elif isinstance(item, h5d.DatasetID):
            address = h5o.get_info(item).addr
            if address in seen:
                raise ForeignError(f"{inner}, a dataset that has another name too")
            seen.add(address)
            yield inner, item
        else:
            raise ForeignError(f"{inner}, which is neither a group nor a dataset")


def _names(group: Any) -> list[bytes]:
    count = group.get_num_objs()
    if count > MOST_OBJECTS:
        raise ForeignError(f"more than {MOST_OBJECTS} groups, datasets and attributes")
    return list(group)


def _shown(name: bytes) -> str:
    return name.decode(errors="backslashreplace")


def _item(kind: Any, place: str) -> _Item:
    """What an item of a type takes in the file; of HDF5 a type tells what it takes in memory. Raises ForeignError for
    what are not numbers, texts, or rows of both: it stands for something elsewhere."""
    if kind.get_class() != h5t.COMPOUND:
        is_text = _is_text(kind, place)
        return _Item(kind.get_size() + is_text * _GROWTH, (0,) if is_text else ())
    members = range(kind.get_nmembers())
    starts = sorted(kind.get_member_offset(i) for i in members if _is_text(kind.get_member_type(i), place))
    return _Item(kind.get_size() + _GROWTH * len(starts), tuple(start + k * _GROWTH for k, start in enumerate(starts)))


def _is_text(kind: Any, place: str) -> bool:
    """Whether it is a text of any length; it may be a number too, and a text of one length."""
    code = kind.get_class()
    if code not in _SIMPLE:
        raise ForeignError(f"{place} with references to objects, or other data that are neither numbers nor texts")
    return bool(code == h5t.STRING and kind.is_variable_str())


def _check_extent(thing: Any, item: _Item, place: str, size: int) -> int:
    """Raise ForeignError where more bytes are declared than are there; else how many there are."""
    space = thing.get_space()
    kind = space.get_simple_extent_type()
    declared = 0 if kind == h5s.NULL else item.size
    for length in space.get_simple_extent_dims() if kind == h5s.SIMPLE else ():
        declared *= int(length)
    stored = thing.get_storage_size()
    if declared > size or declared != stored:
        raise ForeignError(f"{place}, declared with {declared} bytes, of which {stored} are there")
    return declared


def _check_dataset(dataset: h5d.DatasetID, place: str, stream: BufferedReader, size: int) -> None:
    made = dataset.get_create_plist()
    layout = made.get_layout()
    if layout == h5d.VIRTUAL or made.get_external_count():
        raise ForeignError(f"{place}, whose data are in another file")
    if layout != h5d.CONTIGUOUS or made.get_nfilters():
        raise ForeignError(f"{place}, whose data are in pieces or packed")
    item = _item(dataset.get_type(), place)
    declared = _check_extent(dataset, item, place, size)
    if not declared:
        return
    offset = dataset.get_offset()
    if offset is None or offset + declared > size:
        raise ForeignError(f"{place}, whose data are beyond the end of the file")
    if item.texts:
        stream.seek(offset)
        _check_texts(stream, declared // item.size, item, place, size)


def _check_texts(stream: BufferedReader, rows: int, item: _Item, place: str, size: int) -> None:
    """Raise ForeignError where texts of any length are longer, together, than the file, or not in it."""
    lengths = [0] * len(item.texts)
    at_once = max(READ_AT_ONCE // item.size, 1)
    for first in range(0, rows, at_once):
        count = min(at_once, rows - first)
        data = np.frombuffer(stream.read(count * item.size), np.uint8).reshape(count, item.size)
        for k, start in enumerate(item.texts):
            texts = np.ascontiguousarray(data[:, start : start + _TEXT.itemsize]).view(_TEXT)
            lengths[k] += int(texts["length"].sum(dtype=np.uint64))
            if lengths[k] > size or int(texts["heap"].max()) > size:
                raise ForeignError(f"{place} with texts that are longer than the file, or beyond its end")
