"""Where fixtures and shared data are, and what is true of them."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
FIXTURES = ROOT / "fixtures"
SHARED = ROOT.parent / "shared"


def manifests() -> list[Path]:
    """The manifest of every fixture: it has the name of its folder."""
    return sorted(p for p in FIXTURES.glob("*/*/*.toml") if p.stem == p.parent.name)


def stories() -> list[Path]:
    """The manifests of the seeker's story, its sub-assemblies apart."""
    found = sorted((FIXTURES / "seeker").rglob("*.toml"))
    return [p for p in found if not any(p.parent.parent == other.parent for other in found)]


def truth_of(manifest: Path):
    """What is to be found in a fixture; None for broken twins."""
    path = manifest.parent / "truth.json"
    return json.loads(path.read_text()) if path.exists() else None


def mobility_of(found, truth):
    """What was found and what is expected of a mobility, key by key.

    Loops through a higher pair, and axes blurred by rounding, leave the finite count unknown (None): then it is not
    compared, and `effective`
    follows from the instantaneous count, as the results contract says.
    """
    expected = dict(truth)
    if found.finite is None and "finite" in expected:
        assert found.finite_reason
        del expected["finite"]
        expected["effective"] = expected["instantaneous"] - expected.get("idle", 0)
    return {key: getattr(found, key) for key in expected}, expected


def rate_ratio(kinematics, first, second):
    """Rate of one joint over that of another, both (bodies, as the truth has them), in the only motion there is.

    Values are of the second body relative to the first about the joint's axis.
    """
    index = {body.name: k for k, body in enumerate(kinematics.bodies)}
    (motion,) = kinematics.mobility.freedoms

    def rate(pair):
        joint = next(j for j in kinematics.joints if j.bodies == tuple(pair))
        relative = motion[index[pair[1]]] - motion[index[pair[0]]]
        return joint.axis @ (relative[3:] if joint.type == "prismatic" else relative[:3])

    return rate(first) / rate(second)


def shared(name: str) -> Path:
    """A file of the shared data; skips the test where it is missing."""
    path = SHARED / name
    if not path.exists():
        pytest.skip(f"{name}: the real arms are not part of the repository, and not beside it")
    return path
