"""Where fixtures and shared data are, and what is known of them."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parent.parent
FIXTURES = ROOT / "fixtures"
SHARED = ROOT.parent / "shared"


def manifests() -> list[Path]:
    """The manifest of every fixture: it has the name of its folder."""
    return sorted(p for p in FIXTURES.glob("*/*/*.toml") if p.stem == p.parent.name)


def truth_of(manifest: Path):
    """What is to be found in a fixture; None for broken twins."""
    path = manifest.parent / "truth.json"
    return json.loads(path.read_text()) if path.exists() else None


def shared(name: str) -> Path:
    """A file of the shared data; skips the test where it is missing."""
    path = SHARED / name
    if not path.exists():
        pytest.skip(f"{name}: the real arms are not part of the repository, and not beside it")
    return path
