"""Writes the documentation of the rules: `python -m kinform.consistency [FILE]`."""

from __future__ import annotations

import sys
from pathlib import Path

from kinform.consistency import rules_markdown

if __name__ == "__main__":
    if len(sys.argv) > 1:
        Path(sys.argv[1]).write_text(rules_markdown(), encoding="utf-8")
    else:
        sys.stdout.write(rules_markdown())
