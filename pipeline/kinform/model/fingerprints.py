"""What each result was computed from, as hashes: the licence to reuse it."""

from __future__ import annotations

from dataclasses import dataclass, field

from kinform.model.names import PartName

__all__ = ["Fingerprints"]


@dataclass(frozen=True)
class Fingerprints:
    """SHA-256 (hex) of the inputs, the settings and the version of the code behind each result.

    A result without a fingerprint is never reused. Nothing here depends on the time of a file.
    """

    stages: dict[str, str] = field(default_factory=dict)
    """By stage: assembly, surfaces, contacts, joints, mass, simulation, findings."""
    meshes: dict[str, str] = field(default_factory=dict)
    """Of the surfaces of each mesh, by mesh digest."""
    pairs: dict[tuple[PartName, PartName], str] = field(default_factory=dict)
    """Of the contacts of each candidate pair, by part names."""
