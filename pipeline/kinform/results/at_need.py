"""The design in a results file, each part of it read when it is first asked for."""

from __future__ import annotations

import contextlib
import dataclasses
import importlib
import json
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any, cast

from kinform.design import Design
from kinform.errors import ResultsError
from kinform.model.fingerprints import Fingerprints
from kinform.results.conformity import check_group
from kinform.results.groups import assembly
from kinform.results.held import HeldFile, HeldGroup
from kinform.results.opening import not_whole, opened
from kinform.results.table import row_count

if TYPE_CHECKING:
    from kinform.behaviour import Behaviour
    from kinform.model.assembly import Assembly
    from kinform.model.contacts import Contacts
    from kinform.model.findings import CheckReport
    from kinform.model.kinematics import ConstraintMatrix, Kinematics
    from kinform.model.mass import MassReport
    from kinform.model.names import PartName
    from kinform.model.simulation import Simulation
    from kinform.model.surfaces import MeshSurfaces


NONSENSE = (
    ArithmeticError, AttributeError, LookupError, OSError, RuntimeError, TypeError, ValueError,
)  # fmt: skip
"""What h5py and the codecs raise on a group that makes no sense."""
_GROUP_OF = {"kinematics": "joints", "report": "findings"}
"""Of fields of a design that are not named as the group that holds them."""
_COUNTED = ("patches", "interferences")
STAGE_OF = {"constraints": "joints", "mobility": "joints", "behaviour": "simulation"}


class Earlier:
    """The design in a results file, each part of it read when it is first asked for: most of what an earlier run left
    is of no use to one whose input changed. Fields as of Design; raises ResultsError as `read` does, also later.
    """

    def __init__(self, path: str | Path, *, open_on: bool = False):
        """With `open_on` the file stays open, and what few ask for is read later than what it belongs to."""
        self._path, self._open_on = path, open_on
        self._open = contextlib.ExitStack()
        self.file: HeldFile = self._open.enter_context(opened(path))

    def __enter__(self) -> Earlier:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def close(self) -> None:
        """Let go of the file; what was not asked for can no longer be read."""
        self._open.close()

    @property
    def recorded(self) -> bool:
        """As of Design."""
        return self.file.recorded

    def _read(self, name: str) -> Any:
        """What a group holds; None where it is not there."""
        if name not in self.file:
            return None
        try:
            check_group(self.file, name)
            return codec(name).read(self.file.group(name))
        except NONSENSE as error:
            raise self._damaged(error) from error

    def _damaged(self, error: BaseException) -> ResultsError:
        return not_whole(self._path, f"the results file is damaged ({error})")

    @cached_property
    def assembly(self) -> Assembly:
        """As written; KeyError is damage, for every results file has one."""
        try:
            check_group(self.file, "assembly")
            return assembly.read(self.file.group("assembly"))
        except NONSENSE as error:
            raise self._damaged(error) from error

    @cached_property
    def _surfaces(self) -> tuple[dict[str, MeshSurfaces], dict[str, str]]:
        return self._read("surfaces") or ({}, {})

    @property
    def surfaces(self) -> dict[str, MeshSurfaces]:
        """By mesh digest."""
        return self._surfaces[0]

    @cached_property
    def _contacts(self) -> tuple[Contacts | None, dict[tuple[PartName, PartName], str]]:
        return self._read("contacts") or (None, {})

    @property
    def contacts(self) -> Contacts | None:
        """As of Design; so are those below."""
        return self._contacts[0]

    @cached_property
    def kinematics(self) -> Kinematics | None:
        from kinform.model.kinematics import Kinematics

        joints, mobility, matrix = self._read("joints"), self._read("mobility"), self._matrix()
        if joints is None:
            return None
        if matrix is None or mobility is None:
            raise self._damaged(KeyError("constraints or mobility"))
        return Kinematics(**joints, matrix=matrix, mobility=mobility)

    def _matrix(self) -> ConstraintMatrix | None:
        if not self._open_on or "constraints" not in self.file:
            return cast("ConstraintMatrix | None", self._read("constraints"))
        from kinform.results.groups.constraints import LaterMatrix

        return LaterMatrix(lambda: cast("ConstraintMatrix", self._read("constraints")))

    @cached_property
    def mass(self) -> MassReport | None:
        return cast("MassReport | None", self._read("mass"))

    @cached_property
    def behaviour(self) -> Behaviour | None:
        return cast("Behaviour | None", self._read("behaviour"))

    @cached_property
    def simulation(self) -> Simulation | None:
        return cast("Simulation | None", self._read("simulation"))

    @cached_property
    def report(self) -> CheckReport | None:
        return of_origin(cast("CheckReport | None", self._read("findings")), self.recorded)

    @cached_property
    def fingerprints(self) -> Fingerprints:
        from kinform.results.groups import joints

        file = self.file
        try:
            return Fingerprints(
                stages={
                    name: mark for name, mark in marks_of(file, "fingerprint").items() if name not in STAGE_OF and mark
                },
                meshes=self._surfaces[1],
                pairs=self._contacts[1],
                files=assembly.read_contents(file.group("assembly")),
                lineage=marks_of(file, "lineage"),
                inputs={name: _inputs(text) for name, text in marks_of(file, "inputs").items()},
                decisions=joints.read_decisions(file.group("joints")) if "joints" in file else {},
                recorded=file.recorded,
            )
        except NONSENSE as error:
            raise self._damaged(error) from error

    def has(self, field: str) -> bool:
        """As of Design; what is not looked at is not read."""
        return _GROUP_OF.get(field, field) in self.file

    @property
    def contact_counts(self) -> tuple[int, int] | None:
        """As of Design, without reading the contacts."""
        if not self.has("contacts"):
            return None
        try:
            patches, overlaps = (row_count(self.file.group("contacts"), name) for name in _COUNTED)
        except NONSENSE as error:
            raise self._damaged(error) from error
        return patches, overlaps

    ranged = Design.ranged

    @property
    def design(self) -> Design:
        """All of it."""
        return Design(**{field.name: getattr(self, field.name) for field in dataclasses.fields(Design)})


def codec(group: str) -> Any:
    """The module that writes and reads a group."""
    return importlib.import_module(f"kinform.results.groups.{group}")


def of_origin(report: CheckReport | None, recorded: bool) -> CheckReport | None:
    """The report, which says so where it was not `recorded`, as of Design."""
    return report if recorded or report is None else dataclasses.replace(report, origin="unknown")


def marks_of(file: HeldGroup, attribute: str) -> dict[str, str]:
    """An attribute of all groups that have it."""
    return {name: str(group.attrs[attribute]) for name, group in file.groups().items() if attribute in group.attrs}


def _inputs(text: str) -> dict[str, str]:
    """What a group was made of, by its names in words. Raises ValueError where it is something else."""
    inputs = json.loads(text)
    if not isinstance(inputs, dict) or not all(isinstance(mark, str) for mark in inputs.values()):
        raise ValueError("the inputs of a group make no sense")
    return inputs
