"""What tests and benchmarks share. The generators of the fixtures can be imported wherever this can."""

from __future__ import annotations

import sys
from pathlib import Path

_FIXTURES = str(Path(__file__).resolve().parents[2] / "fixtures")

if _FIXTURES not in sys.path:
    sys.path.append(_FIXTURES)
