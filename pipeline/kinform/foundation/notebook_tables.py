"""Tables of records for notebooks: as HTML, and as a pandas data frame."""

from __future__ import annotations

import importlib
from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np

from kinform.foundation.escapes import html


class Tabled:
    """Base class of what a notebook shows as a table."""

    columns: Sequence[str] = ()

    def rows(self) -> list[list[Any]]:
        """A value a column; SI and radians."""
        raise NotImplementedError

    def to_frame(self) -> Any:
        """The rows as a pandas DataFrame; ImportError without pandas."""
        try:
            pandas: Any = importlib.import_module("pandas")
        except ImportError:
            raise ImportError("to_frame needs pandas: pip install pandas") from None
        return pandas.DataFrame(self.rows(), columns=list(self.columns))

    def _repr_html_(self) -> str:
        head = "".join(f"<th>{html(name)}</th>" for name in self.columns)
        body = "".join(
            "<tr>" + "".join(f"<td>{html(_shown(value))}</td>" for value in row) + "</tr>" for row in self.rows()
        )
        return f"<table><thead><tr>{head}</tr></thead><tbody>{body}</tbody></table>"


def rows_of(items: Iterable[Any], columns: Sequence[str]) -> list[list[Any]]:
    """The attributes of each item; arrays as tuples, names joined."""
    return [[_plain(getattr(item, name)) for name in columns] for item in items]


def _plain(value: Any) -> Any:
    if isinstance(value, np.ndarray):
        return tuple(float(x) for x in value.ravel())
    if isinstance(value, tuple):
        return ", ".join(map(str, value))
    return value


def _shown(value: Any) -> str:
    if value is None:
        return ""
    if isinstance(value, tuple):
        return ", ".join(f"{x:.6g}" for x in value)
    return f"{value:.6g}" if isinstance(value, float) else str(value)
