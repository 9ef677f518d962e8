"""What a run takes over from earlier results, and what it computes anew, each in one sentence."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Protocol

from kinform.model.assembly import Assembly
from kinform.model.contacts import Contacts
from kinform.model.fingerprints import Fingerprints
from kinform.model.mass import MassReport
from kinform.model.surfaces import MeshSurfaces
from kinform.reuse.fingerprints import few


class EarlierResults(Protocol):
    """A design, whole or read as it is asked for (`kinform.results.Earlier`); further fields as of Design."""

    @property
    def assembly(self) -> Assembly: ...

    @property
    def surfaces(self) -> dict[str, MeshSurfaces]: ...

    @property
    def contacts(self) -> Contacts | None: ...

    @property
    def mass(self) -> MassReport | None: ...

    @property
    def fingerprints(self) -> Fingerprints: ...

    @property
    def recorded(self) -> bool: ...


NONE = "no earlier results"
UNKNOWN = "earlier results of unknown origin"
"""Why nothing is reused, where an account begins with it."""
UNTOUCHED = "nothing changed that matters"
TRUSTED = "results of unknown origin, as --trust-results says"
"""Why everything is reused."""


@dataclass
class Ledger:
    """Earlier results of the same output, if any, and the account of what became of them."""

    previous: EarlierResults | None = None
    absent: str = NONE
    """Why there are no earlier results."""
    reused: list[str] = field(default_factory=list)
    """Sentences, in the order of the stages."""
    recomputed: list[str] = field(default_factory=list)
    """Sentences with the reason, in the order of the stages."""
    _computed: list[str] = field(default_factory=list)

    @property
    def fingerprints(self) -> Fingerprints:
        """Those of the earlier results; empty ones where there are none."""
        return Fingerprints() if self.previous is None else self.previous.fingerprints

    @property
    def recorded(self) -> bool:
        """As of Design: whether what is taken over makes a design that is."""
        return self.previous is None or self.previous.recorded

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
            return f"everything is reused: {UNTOUCHED if self.recorded else TRUSTED}"
        return f"{self._cause(files)} → {', '.join(self._computed)}"

    def _cause(self, files: Mapping[str, str]) -> str:
        if self.previous is None:
            return self.absent
        before = self.fingerprints.files
        if not before or not files:
            return "earlier results do not say which files they were made of"
        changed = sorted(name for name in files if name in before and files[name] != before[name])
        new, gone = sorted(set(files) - set(before)), sorted(set(before) - set(files))
        causes = [
            f"{few(names)} {what}"
            for names, what in ((changed, "changed"), (new, "added"), (gone, "left out"))
            if names
        ]  # fmt: skip
        return ", ".join(causes) or "other settings, or another version of kinform"
