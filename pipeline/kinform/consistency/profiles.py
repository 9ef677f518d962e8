"""Severities by profile: what is an error of a design is not always one of a robot description.

The meshes of descriptions are for looking at: they are open, they overlap at bearings, pins and screws are in none of
them. So what only says that a mesh is for looking at, or that nothing holds a joint, is a note; what two statements
of a description contradict stays what it is. KF412 tells for itself which of the two it is. `[check] profile`
chooses; descriptions are `description` without it. `[check.severity]` has the last word.
"""

from __future__ import annotations

from collections.abc import Mapping

from kinform.model.checks import Profile
from kinform.model.findings import SEVERITIES, Severity

DESCRIPTION: Mapping[str, Severity] = {
    "KF101": "note",
    "KF102": "warning",
    "KF103": "note",
    "KF104": "note",
    "KF105": "note",
    "KF106": "note",
    "KF107": "note",
    "KF201": "warning",
    "KF202": "note",
    "KF203": "note",
    "KF204": "warning",
    "KF205": "note",
    "KF206": "note",
    "KF209": "note",
    "KF303": "note",
    "KF401": "note",
    "KF406": "note",
    "KF407": "note",
    "KF408": "note",
    "KF414": "note",
    "KF416": "note",
    "KF901": "note",
    "KF903": "note",
    "KF904": "note",
}
"""Severity of each rule's findings at most, where the profile is `description`."""

SETTLED = frozenset({"KF203", "KF204", "KF303", "KF402", "KF403", "KF404", "KF406", "KF901", "KF903", "KF904"})
"""Rules whose doubts, in a description, are notes and leave nothing undecided: meshes that are for looking at do not
say more."""


def at_most(code: str, severity: Severity, profile: Profile) -> Severity:
    """The severity of a finding of a rule under a profile."""
    limit = DESCRIPTION.get(code) if profile == "description" else None
    return severity if limit is None or SEVERITIES.index(severity) <= SEVERITIES.index(limit) else limit
