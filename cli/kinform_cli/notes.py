"""What kinform took on its own account, in a line."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from kinform.design import Design

__all__ = ["ground_note"]


def ground_note(design: Design) -> str | None:
    """Which body was taken as the ground, where the manifest does not say."""
    if design.assembly.ground is not None:
        return None
    assert design.kinematics is not None
    chosen = [body.name for body in design.kinematics.bodies if body.ground]
    return f"note: no ground is stated: {', '.join(chosen)} is taken, as the heaviest (else the largest) body"
