"""Values of the command line that need no validation: texts, names of files, and words of a list.

typer (0.29) converts each value by an adapter of pydantic: to import pydantic and to make the adapters takes 0.07 s,
half of all that a command takes to start. What is as plain as this is taken as it is; typer converts whatever else, and
words what is wrong. Older typers have no adapters, and of newer ones it is not known what they have inside: they are
left as they are.
"""

from __future__ import annotations

import os
from enum import Enum
from pathlib import Path
from typing import Any, get_args, get_origin

import typer

_KNOWN = "0.29."
"""Versions of typer whose adapters are as this expects them."""
_UNLESS = ("exists", "resolve_path", "writable", "parser")
"""What an option says that asks more of its value."""


class _Converted:
    """What converts the values of one parameter: in place of typer's."""

    def __init__(self, parameter: Any):
        self._descriptor = parameter.type_descriptor
        self._typers: Any = None

    def coerce(self, value: Any, param: Any, ctx: Any) -> Any:
        """The value as the command takes it. Raises typer's errors."""
        if value is None:
            return () if param.multiple or param.nargs == -1 else None
        plain = _plain(value, self._descriptor)
        if plain is not None:
            return plain
        if self._typers is None:
            from typer._coercion import build_runtime_param

            self._typers = build_runtime_param(self._descriptor)
        return self._typers.coerce(value, param=param, ctx=ctx)


def take_as_is(parameter: Any) -> None:
    """Let a parameter of typer take what is plain as it is."""
    if not typer.__version__.startswith(_KNOWN):
        return
    if getattr(parameter, "_runtime_param", parameter) is None and hasattr(parameter, "type_descriptor"):
        parameter._runtime_param = _Converted(parameter)


def _plain(value: Any, descriptor: Any) -> Any:
    """The value as the command takes it; None where that is for typer to say."""
    kind = descriptor.annotation
    if any(getattr(descriptor.parameter_info, name, None) for name in _UNLESS):
        return None
    if get_origin(kind) is list and isinstance(value, list | tuple):
        converted = [_one(item, get_args(kind)[0]) for item in value]
        return None if any(item is None for item in converted) else converted
    return _one(value, kind)


def _one(value: Any, kind: Any) -> Any:
    if not isinstance(value, str) or not isinstance(kind, type):
        return None
    if kind is str or isinstance(value, kind):
        return value
    if kind is Path:
        return None if not value or (os.path.exists(value) and not os.access(value, os.R_OK)) else Path(value)
    if issubclass(kind, Enum):
        return next((word for word in kind if word.value == value), None)
    return None
