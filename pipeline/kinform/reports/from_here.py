"""Findings whose files are named as seen from the present folder: as the host of a repository reads them."""

from __future__ import annotations

import os
from dataclasses import replace
from pathlib import Path

from kinform.design import Design
from kinform.model.findings import Finding


def seen_from_here(design: Design, folder: Path) -> Design:
    """The design with every file of its findings, which are relative to `folder`, named from the present folder."""
    report, assembly = design.report, design.assembly
    assert report is not None

    def place(file: str) -> str:
        return Path(os.path.relpath(folder / file)).as_posix()

    def from_here(finding: Finding) -> Finding:
        return finding if finding.file is None else replace(finding, file=place(finding.file))

    if assembly.source.file:
        assembly = replace(assembly, source=replace(assembly.source, file=place(assembly.source.file)))
    told, members = (tuple(map(from_here, found)) for found in (report.findings, report.members))
    report = replace(report, findings=told, members=members)
    return replace(design, assembly=assembly, report=report)
