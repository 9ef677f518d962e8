"""What a run takes over from earlier results, and what it computes anew, each in one sentence."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path

from kinform.model.design import Design

__all__ = ["Ledger"]


@dataclass
class Ledger:
    """Earlier results of the same output, if any, and the account of what became of them."""

    previous: Design | None = None
    reused: list[str] = field(default_factory=list)
    """Sentences, in the order of the stages."""
    recomputed: list[str] = field(default_factory=list)
    """Sentences with the reason, in the order of the stages."""

    @classmethod
    def of(cls, output: str | Path | None) -> Ledger:
        """The ledger of a run that writes to `output`: checked now, before any work is done.

        Raises ResultsError when `output` cannot be written or holds something else than results.
        """
        if output is None:
            return cls()
        from kinform import results

        results.check_output(output)
        path = Path(output)
        return cls(results.read(path) if path.exists() and path.stat().st_size > 0 else None)

    def keep(self, what: str) -> None:
        """Note that `what` is taken over."""
        self.reused.append(what)

    def compute(self, what: str, why: str) -> None:
        """Note that `what` is computed, and why."""
        self.recomputed.append(f"{what}: {why}")
