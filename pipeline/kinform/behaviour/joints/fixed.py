"""Fixed: no freedom; the two bodies move as one."""

from kinform.behaviour.joints._base import JointKind

FIXED = JointKind("fixed", (), 0, lambda geometry: (), ())
