"""What proves a finding, in words."""

from __future__ import annotations

import numpy as np

from kinform.foundation.words import angle, length, number, quoted, volume
from kinform.model.findings import Finding, Witness


def proof(finding: Finding, units: str) -> str | None:
    """Its witness in a line, lengths in units of the assembly; None without one."""
    witness = finding.witness
    if witness is None:
        return None
    if witness.kind == "textual":
        return _textual(witness)
    if witness.kind == "computed":
        return f"{witness.equation}: {number(witness.residual or 0.0, 4)}, beyond {number(witness.limit or 0.0, 4)}"
    return _geometric(witness, units)


def _textual(witness: Witness) -> str:
    where = f"{witness.source_file}:{witness.source_line}"
    said = [f"states {', '.join(witness.states)}"] if witness.states else []
    said += [f"lacks {', '.join(witness.lacks)}"] if witness.lacks else []
    said += [f"names {witness.missing}, which is not there"] if witness.missing else []
    return f"{where} {' and '.join(said) or 'contradicts it'}"


def _geometric(witness: Witness, units: str) -> str:
    if witness.parts_back is not None and witness.step is not None and witness.depth is not None:
        turns = bool(np.any((witness.twist or (0.0,))[:3]))
        steps = (angle(size, 3) if turns else length(size, units, 3) for size in witness.step)
        depths = (length(depth, units, 3) for depth in witness.depth)
        told = (f"{step} ({depth} deep)" for step, depth in zip(steps, depths, strict=True))
        return f"steps that drive parts into each other: {', '.join(told)}"
    first, second = quoted((witness.first or ())[:3]), quoted((witness.second or ())[:3])
    if witness.twist is not None and witness.step is not None:
        return f"nothing is in the way of {second} for {length(witness.step[1], units, 3)}"
    gap = witness.gap or 0.0
    moved = " where the second is moved" if witness.moved is not None else ""
    if gap >= 0.0:
        return f"{first} and {second} are {length(gap, units, 3)} apart{moved}"
    shared = "" if witness.volume is None else f", {volume(witness.volume, units)} shared"
    return f"{first} and {second} are {length(-gap, units, 3)} deep in each other{moved}{shared}"
