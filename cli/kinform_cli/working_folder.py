"""No module is found in the working folder, which may be a stranger's repository.

This module needs nothing but what Python has loaded when it starts: what else was imported first could be found there.
"""

import os
import sys


def forget(*, first: bool = False) -> None:
    """Remove entries of PYTHONPATH that are empty or relative from Python's path, and with `first` the entry that
    `python -m` puts before all others. Absolute entries of PYTHONPATH stay."""
    if first and sys.path and not sys.flags.safe_path:
        del sys.path[0]
    named = os.environ.get("PYTHONPATH", "").split(os.pathsep)
    stay = {os.path.abspath(one) for one in named if os.path.isabs(one)}
    go = {os.path.abspath(one) for one in named if not os.path.isabs(one)} if named != [""] else set()
    sys.path[:] = [one for one in sys.path if one and (one in stay or one not in go)]
    if sys.pycache_prefix is not None and not os.path.isabs(sys.pycache_prefix):
        sys.pycache_prefix = None
