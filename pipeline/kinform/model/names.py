"""Names as types, so that a part is not passed where a body is meant."""

from __future__ import annotations

from typing import NewType

__all__ = ["BodyName", "JointName", "PartName"]

PartName = NewType("PartName", str)
BodyName = NewType("BodyName", str)
JointName = NewType("JointName", str)
