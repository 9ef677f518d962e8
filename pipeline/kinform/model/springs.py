"""Springs, gas springs and bushings between points of two parts, as the designer states them. SI, world frame."""

from __future__ import annotations

from typing import Annotated, Final, Literal

from kinform.frozen import dataclass
from kinform.model.arrays import Array
from kinform.model.quantities import MATRIX, Place, columns

SpringKind = Literal["spring", "gas_spring", "bushing"]
SPRING: Final = "spring"
GAS_SPRING: Final = "gas_spring"
BUSHING: Final = "bushing"


@dataclass(frozen=True, eq=False)
class StatedSpring:
    """`[[function.spring]]`, `[[function.gas_spring]]` or `[[function.bushing]]`."""

    kind: SpringKind
    name: str
    between: Annotated[tuple[str, str], columns("between_a", "between_b")]
    """Parts or groups."""
    point: Place
    """(3,) m, on the first, at the pose of the meshes."""
    other: Place
    """(3,) m, on the second."""
    parameters: dict[str, float]
    """SI. spring: stiffness, damping, rest. gas_spring: force, extended, column, exponent, damping. bushing:
    stiffness_x … torsion_damping_z, of the axes."""
    axes: Annotated[Array, "1", MATRIX] | None
    """(3, 3) of a bushing: its axes as columns."""
    file: str
    line: int | None
