"""numba, imported without what the working folder says of it.

numba reads `.numba_config.yaml` in the working folder when it is imported, and again whenever it compiles: that file
could name folders and modules from which numba loads code. Variables of the environment (`NUMBA_…`) still count.
"""

from __future__ import annotations

import os
import sys
import threading
import warnings
from typing import Any

_lock = threading.Lock()


def load_numba() -> Any:
    """The package. Where the program has imported it before, with the settings that it then read."""
    with _lock:
        if "numba" not in sys.modules:
            _first()
    import numba

    return numba


def _first() -> None:
    """Import it as though there was no reader of YAML, and have it look for no file from then on."""
    absent = "yaml" not in sys.modules
    reader = sys.modules.get("yaml")
    sys.modules["yaml"] = None  # type: ignore[assignment]
    try:
        with warnings.catch_warnings():
            warnings.filterwarnings("ignore", message="A Numba config file is found")
            from numba.core import config
    finally:
        if absent:
            del sys.modules["yaml"]
        else:
            sys.modules["yaml"] = reader  # type: ignore[assignment]
    config._config_fname = os.devnull
