"""Names as types, so that a part is not passed where a body is meant."""

from __future__ import annotations

from typing import NewType

PartName = NewType("PartName", str)
BodyName = NewType("BodyName", str)
JointName = NewType("JointName", str)
