"""Counts of what was executed: each run adds a line to a file, from which the table of README.md is printed."""

from __future__ import annotations

import json
from pathlib import Path

FILE = "counts.jsonl"
"""Beside the folders of the targets."""


def add(
    folder: Path, target: str, driver: str, *, executions: int, refused: int | None, seconds: float, findings: int
) -> None:
    """Add a run; `seconds` are of the processor."""
    line = {"target": target, "driver": driver, "executions": executions, "refused": refused,
            "seconds": round(seconds, 1), "findings": findings}  # fmt: skip
    folder.mkdir(parents=True, exist_ok=True)
    with (folder / FILE).open("a", encoding="utf-8") as file:
        file.write(json.dumps(line) + "\n")


def table(folder: Path) -> str:
    """Sums of all runs as a table of Markdown, targets in the order in which they were first run."""
    sums: dict[str, list[float]] = {}
    if (folder / FILE).exists():
        for line in (folder / FILE).read_text(encoding="utf-8").splitlines():
            run = json.loads(line)
            total = sums.setdefault(run["target"], [0, 0, 0.0, 0, 0])
            total[0] += run["executions"]
            total[2] += run["seconds"]
            total[4] += run["findings"]
            if run["refused"] is not None:
                total[1] += run["executions"] - run["refused"]
                total[3] += run["executions"]
    out = [
        "| target | executions | read without a refusal | a second of processor | findings |",
        "|---|---|---|---|---|",
    ]
    for target, (executions, read, seconds, known, findings) in sums.items():
        share = f"{100.0 * read / known:.0f} %" if known else "not counted"
        rate = f"{executions / seconds:,.0f}" if seconds else "–"
        out.append(f"| {target} | {executions:,} | {share} | {rate} | {findings} |")
    return "\n".join(out)
