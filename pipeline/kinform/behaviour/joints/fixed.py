"""Fixed: no freedom; the two bodies move as one."""

from kinform.behaviour.joints.kind import JointGeometry, JointKind


def _chain(geometry: JointGeometry) -> tuple[()]:
    return ()


FIXED = JointKind("fixed", (), 0, _chain, ())
