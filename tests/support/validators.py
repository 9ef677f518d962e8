"""Programs that judge what kinform writes, where `make validators` puts them; a test without its judge is skipped."""

from __future__ import annotations

import importlib
import os
import re
import shutil
import subprocess
import sys
import sysconfig
from functools import cache
from pathlib import Path
from types import ModuleType

import pytest


def package(module: str) -> ModuleType:
    """A package of Python, by the name of its module."""
    try:
        return importlib.import_module(module)
    except ImportError as error:
        pytest.skip(f"{module.partition('.')[0]} is not installed ({error}): make validators")


def program(name: str) -> str:
    """A program beside this Python, or on the path."""
    places = os.pathsep.join((sysconfig.get_path("scripts"), os.environ.get("PATH", os.defpath)))
    found = shutil.which(name, path=places)
    if found is None:
        pytest.skip(f"{name} is not installed")
    return found


def ghdl() -> str:
    """GHDL 6; older ones know too little of VHDL-AMS."""
    path, version = _ghdl()
    if not re.match(r"GHDL ([6-9]|\d\d)\.", version):
        pytest.skip(f"needs GHDL 6, and this is {version}: make validators")
    return path


@cache
def _ghdl() -> tuple[str, str]:
    path = program("ghdl")
    ran = subprocess.run([path, "--version"], capture_output=True, text=True, check=False)
    return path, ran.stdout.partition("\n")[0] or ran.stderr.strip()


def npm(name: str) -> Path:
    """The folder of a package of npm: in the virtual environment, or where NODE_PATH says."""
    places = [Path(sys.prefix) / "npm" / "node_modules", *map(Path, filter(None, _node_path()))]
    for place in places:
        if (place / name).is_dir():
            return place / name
    pytest.skip(f"{name} of npm is not installed: make validators")


def _node_path() -> list[str]:
    return os.environ.get("NODE_PATH", "").split(os.pathsep)
