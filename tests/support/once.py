"""What several workers of a session need is computed by one of them and pickled for the others.

Not by a results file: those are among what is tested.
"""

from __future__ import annotations

import dataclasses
import fcntl
import hashlib
import pickle
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np


def common(tmp_path_factory: Any) -> Path:
    """The folder of this session that all its workers have in common. A worker is known by its own folder in it, not
    by its environment: a session that a test begins inherits that, and above its folder are those of other sessions."""
    folder = tmp_path_factory.getbasetemp()
    return folder.parent if folder.name.startswith("popen-") else folder


def once(folder: Path, name: str, make: Callable[[], Any]) -> Any:
    """The value of that name in the folder, or else of `make`; who comes while it is being made waits."""
    path = folder / (hashlib.sha256(name.encode()).hexdigest()[:16] + ".pickle")
    with path.with_suffix(".lock").open("w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        if not path.exists():
            begun = path.with_suffix(".part")
            with begun.open("wb") as file:
                _Pickler(file).dump(make())
            begun.replace(path)
        return pickle.loads(path.read_bytes())


class _Pickler(pickle.Pickler):
    """Arrays that cannot be written stay so. Of records the fields count: what is kept beside them may know other
    objects by their places in memory."""

    def reducer_override(self, value: Any) -> Any:
        if type(value) is np.ndarray and not value.flags.writeable:
            return _fixed, (value.copy(),)
        if dataclasses.is_dataclass(value) and not isinstance(value, type):
            names = [field.name for field in dataclasses.fields(value)]
            return _record, (type(value), {name: getattr(value, name) for name in names})
        return NotImplemented


def _fixed(array: np.ndarray) -> np.ndarray:
    array.flags.writeable = False
    return array


def _record(kind: type, fields: dict[str, Any]) -> Any:
    made = object.__new__(kind)
    for name, value in fields.items():
        object.__setattr__(made, name, value)
    return made
