"""Compiled units of the kernel, kept in this user's own cache folder (`kinform/kernel`).

numba's own cache unpickles whatever lies in a folder that the environment, a file or the place of the source names.
Here a file is unpickled only where `foundation.user_folders` finds that this user wrote it and that it is whole. What
is missing, damaged, of another version or cannot be kept is compiled: none of this is an error.
"""

from __future__ import annotations

import hashlib
import pickle
import sys
from typing import Any

from kinform.foundation.user_folders import cache_folder, private_folder

_FOLDER = "kernel"


def has(name: str) -> bool:
    """Whether a unit of this name is there, for some processor and some version of numba."""
    with private_folder(cache_folder(), _FOLDER) as folder:
        return folder is not None and any(one.startswith(_prefix(name)) for one in folder.names())


def _prefix(name: str) -> str:
    return f"{name}.{sys.implementation.cache_tag}-"


class UnitCache:
    """Where numba's `CFunc` looks for one unit, and puts it."""

    def __init__(self, name: str):
        self._name = name

    def load_overload(self, signature: Any, target: Any) -> Any:
        """The result of compiling, as it was kept; None where there is none to be trusted."""
        from numba.core import compiler

        result: Any = compiler.CompileResult
        target.refresh()
        with private_folder(cache_folder(), _FOLDER) as folder:
            kept = None if folder is None else folder.read(self._file(signature, target))
        if kept is None:
            return None
        try:
            return result._rebuild(target, *pickle.loads(kept))
        except Exception:  # numba's own, with other dependencies than when it was kept
            return None

    def save_overload(self, signature: Any, compiled: Any) -> None:
        """Keep the result of compiling, where there is a place for it."""
        from numba.core import serialize

        numbas: Any = serialize
        if compiled.library.has_dynamic_globals or any(not loop.can_cache for loop in compiled.lifted):
            return
        with private_folder(cache_folder(), _FOLDER, make=True) as folder:
            if folder is not None:
                folder.write(self._file(signature, compiled.target_context), numbas.dumps(compiled._reduce()))

    def _file(self, signature: Any, target: Any) -> str:
        """By name, Python, numba, LLVM, signature, and the processor that it is compiled for."""
        import llvmlite
        import numba

        versions = numba.__version__, llvmlite.__version__, str(signature), target.codegen().magic_tuple()
        return f"{_prefix(self._name)}{hashlib.sha256(repr(versions).encode()).hexdigest()[:16]}"
