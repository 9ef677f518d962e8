"""Proofs of findings, replayed by other means than those that found them.

A finding carries a `Witness` of one of three classes, each of which one module replays: `geometric` by booleans of
manifold3d on the meshes of the results, `textual` by reading the file again, `computed` by a second method for each
equation of a closed list. Results are not believed: names, numbers and sizes are checked before they are used.
"""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from kinform.design import Design
from kinform.foundation.boundary import Boundary
from kinform.frozen import dataclass
from kinform.model.findings import CheckReport, Finding
from kinform.replays.outcome import NotReplayed, Outcome

if TYPE_CHECKING:
    from kinform.replays.geometric import Sides

__all__ = ["Outcome", "Replayed", "exit_code", "replay", "replay_all"]


@dataclass(frozen=True)
class Replayed:
    """A finding, and what the second method says of its witness."""

    finding: Finding
    outcome: Outcome


def replay_all(report: CheckReport, design: Design, folder: Path, boundary: Boundary) -> tuple[Replayed, ...]:
    """Every finding that has a witness, or should: accepted ones too. Files are named relative to a folder."""
    from kinform.replays.files import Files
    from kinform.replays.geometric import Sides

    sides = Sides(design, Files(folder, boundary))
    findings = [*report.singles, *(item.finding for item in report.ignored)]
    return tuple(
        Replayed(finding, replay(finding, sides))
        for finding in findings
        if finding.witness is not None or finding.severity == "error"
    )


def replay(finding: Finding, sides: Sides) -> Outcome:
    """What the second method says of the witness of one finding."""
    from kinform.replays import computed, geometric, textual

    witness = finding.witness
    try:
        if witness is None:
            raise NotReplayed("the finding has no witness")
        if witness.kind == "textual":
            return textual.replay(witness, sides.files)
        if witness.kind == "computed":
            return computed.replay(witness, sides)
        return geometric.replay(witness, sides)
    except NotReplayed as why:
        return Outcome("not replayed", str(why))
    except (ArithmeticError, LookupError, ValueError) as error:  # of numbers that no finder gives
        return Outcome("not replayed", f"its numbers make no sense: {error}")


def exit_code(replayed: tuple[Replayed, ...]) -> int:
    """1 where a witness does not hold, else 0."""
    return 1 if any(item.outcome.state == "does not hold" for item in replayed) else 0
