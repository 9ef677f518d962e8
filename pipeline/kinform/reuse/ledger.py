"""What a run takes over from earlier results, and what it computes anew, each in one sentence."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING

from kinform.design import Design

if TYPE_CHECKING:
    from kinform.results import Earlier

__all__ = ["Ledger"]


@dataclass
class Ledger:
    """Earlier results of the same output, if any, and the account of what became of them."""

    previous: Design | Earlier | None = None
    reused: list[str] = field(default_factory=list)
    """Sentences, in the order of the stages."""
    recomputed: list[str] = field(default_factory=list)
    """Sentences with the reason, in the order of the stages."""
    _computed: list[str] = field(default_factory=list)

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
        return cls(results.Earlier(path) if path.exists() and path.stat().st_size > 0 else None)

    def close(self) -> None:
        """Let go of the earlier file: it is about to be replaced."""
        if self.previous is not None and not isinstance(self.previous, Design):
            self.previous.close()

    def keep(self, what: str) -> None:
        """Note that `what` is taken over."""
        self.reused.append(what)

    def compute(self, what: str, why: str) -> None:
        """Note that `what` is computed, and why."""
        self.recomputed.append(f"{what}: {why}")
        self._computed.append(what)

    def account(self, files: Mapping[str, str]) -> str:
        """What changed and what followed: "camera.stl changed → contacts of 2 pairs of parts, joints"; `files` are the
        contents that were read now, by name."""
        if not self._computed:
            return "everything is reused: nothing changed that matters"
        return f"{self._cause(files)} → {', '.join(self._computed)}"

    def _cause(self, files: Mapping[str, str]) -> str:
        from kinform.reuse.fingerprints import listed

        if self.previous is None:
            return "no earlier results"
        before = self.previous.fingerprints.files
        if not before or not files:
            return "earlier results do not say which files they were made of"
        changed = sorted(name for name in files if name in before and files[name] != before[name])
        causes = [f"{listed(changed)} changed"] if changed else []
        new, gone = sorted(set(files) - set(before)), sorted(set(before) - set(files))
        causes += [f"{listed(new)} added"] if new else []
        causes += [f"{listed(gone)} left out"] if gone else []
        return ", ".join(causes) or "other settings, or another version of kinform"
