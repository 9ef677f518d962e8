"""What each result was computed from, as hashes: the licence to reuse it."""

from __future__ import annotations

from dataclasses import field

from kinform.frozen import dataclass
from kinform.model.names import PartName


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
    files: dict[str, str] = field(default_factory=dict)
    """SHA-256 (hex) of the content of every file read, by its name relative to the manifest; empty: not known."""
    lineage: dict[str, str] = field(default_factory=dict)
    """By stage as above, without surfaces: hash of the files, and of the settings and versions of the code of this
    stage and all before it. Where it is what a run would give, nothing needs to be looked at; empty: not known."""
    inputs: dict[str, dict[str, str]] = field(default_factory=dict)
    """By stage, of joints, mass, simulation and findings: hash of each input, by its name in words. What `stages` was
    made of, to say what changed."""
    decisions: dict[str, tuple[str, str]] = field(default_factory=dict)
    """What single pairs, bodies and loops come out as, packed, and a seal on it, by the hash of all that decides it."""
    recorded: bool = True
    """Whether this user's kinform computed all results, or wrote the files that they were read from; no part of results
    files, and of no fingerprint."""
