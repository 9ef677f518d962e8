"""The design as a notebook sees it: `kinform.open("r.h5")` and `kinform.run("m.toml")` give these."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator, Mapping
from html import escape
from pathlib import Path
from typing import TYPE_CHECKING, Any, Generic, Protocol, TypeVar

from kinform.design import Design
from kinform.errors import Problem, ResultsError, StageError
from kinform.foundation import escapes
from kinform.foundation.notebook_tables import Tabled, rows_of

if TYPE_CHECKING:
    from kinform.behaviour import Behaviour
    from kinform.model.assembly import Assembly as AssemblyModel
    from kinform.model.assembly import Part
    from kinform.model.contacts import Contacts
    from kinform.model.findings import CheckReport, Finding
    from kinform.model.kinematics import Body, Joint, Mobility
    from kinform.model.mass import MassProperties
    from kinform.model.simulation import Simulation


class Assembly:
    """Assemblies that a program makes, as `kinform.run` takes them: of type `kinform.model.assembly.Assembly`."""

    @staticmethod
    def from_meshes(
        meshes: Any,
        *,
        units: str | None = None,
        name: str = "assembly",
        density: float | None = None,
        deviation: float | None = None,
    ) -> AssemblyModel:
        """An assembly of {name: mesh or (mesh, pose)}, or of a scene of trimesh; see `kinform.form.from_python`.

        A mesh has vertices and faces, or is a pair of such arrays, or can be tessellated (build123d, CadQuery); a pose
        is a matrix (4, 4). `units` is the unit of all lengths. Raises InputError with every problem.
        """
        from kinform import form

        return form.from_meshes(meshes, units=units, name=name, density=density, deviation=deviation)


class _HasName(Protocol):
    @property
    def name(self) -> str: ...


Item = TypeVar("Item", bound=_HasName, covariant=True)
Result = TypeVar("Result")


class Named(Mapping[str, Item], Tabled, Generic[Item]):
    """Things by name, in a fixed order; iterating gives the names, `.values()` the things. A notebook shows a table,
    and `.to_frame()` gives it to pandas."""

    def __init__(
        self, what: str, items: tuple[Item, ...], describe: Callable[[Item], str], columns: tuple[str, ...] = ("name",)
    ):
        self._what = what
        self.columns = columns
        self._items = {item.name: item for item in items}
        self._describe = describe

    def __getitem__(self, name: str) -> Item:
        try:
            return self._items[name]
        except KeyError:
            names = ", ".join(self._items) or "none"
            raise KeyError(f"no {self._what} is named {name!r}; there are: {names}") from None

    def __iter__(self) -> Iterator[str]:
        return iter(self._items)

    def __len__(self) -> int:
        return len(self._items)

    def rows(self) -> list[list[Any]]:
        """A row a thing; SI and radians."""
        return rows_of(self._items.values(), self.columns)

    def __repr__(self) -> str:
        width = max(map(len, self._items), default=0)
        return "\n".join(
            [f"{self._what} ({len(self)}):", *(f"  {k:<{width}}  {self._describe(v)}" for k, v in self._items.items())]
        )


class Findings(tuple["Finding", ...], Tabled):
    """Findings in their order, as a tuple that a notebook shows as a table."""

    columns = ("code", "severity", "subject", "message", "found", "intended", "remedy")

    def rows(self) -> list[list[Any]]:
        """A row a finding."""
        return rows_of(self, self.columns)


class View:
    """A page in a frame of its own, which a notebook shows."""

    def __init__(self, html: str, height: int):
        self._html = html
        self._height = height

    def __repr__(self) -> str:
        return f"View({len(self._html)} characters of HTML)"

    def _repr_html_(self) -> str:
        source = escape(self._html, quote=True)
        return f'<iframe srcdoc="{source}" style="width:100%;height:{self._height}px;border:0"></iframe>'


class Plots:
    """Curves of a run over time, which a notebook shows."""

    def __init__(self, html: str, count: int):
        self._html = html
        self._count = count

    def __repr__(self) -> str:
        return f"Plots({self._count} as SVG: a notebook shows them)"

    def _repr_html_(self) -> str:
        return self._html


class Results:
    """Everything that is known of a design; what has not been computed yet raises StageError."""

    def __init__(self, design: Design | Callable[[], Design]):
        self._design = design

    @property
    def design(self) -> Design:
        """The design as the stages exchange it."""
        if not isinstance(self._design, Design):
            self._design = self._design()
        return self._design

    @property
    def assembly(self) -> AssemblyModel:
        """Form and function: parts, groups, poses, intended joints."""
        return self.design.assembly

    @property
    def contacts(self) -> Contacts:
        """Contact patches between surfaces, and interferences."""
        return _computed(self.design.contacts, "contacts", "contacts")

    @property
    def parts(self) -> Named[Part]:
        """Parts with their meshes and poses, by name."""
        columns = ("name", "material", "density", "solid", "units")
        return Named("part", self.design.assembly.parts, _describe_part, columns)

    @property
    def bodies(self) -> Named[Body]:
        """Parts that move as one, by name."""
        bodies = _computed(self.design.kinematics, "bodies", "joints").bodies
        columns = ("name", "parts", "ground")
        return Named("body", bodies, lambda body: ", ".join(body.parts) + (" (ground)" if body.ground else ""), columns)

    @property
    def joints(self) -> Named[Joint]:
        """Joints between bodies, by name: type, axis, point, freedoms, status, evidence."""
        joints = _computed(self.design.kinematics, "joints", "joints").joints
        columns = ("name", "bodies", "type", "status", "freedoms", "axis", "point")
        return Named("joint", joints, lambda joint: f"{joint.type} ({joint.status})", columns)

    @property
    def mobility(self) -> Mobility:
        """Mobility of the whole, relative to ground."""
        return _computed(self.design.kinematics, "mobility", "joints").mobility

    @property
    def mass(self) -> Named[MassProperties]:
        """Mass properties of the bodies, by name (kg, m, kg·m², world axes)."""
        return Named("body", _computed(self.design.mass, "mass", "mass").bodies, _describe_mass, _MASS)

    @property
    def part_mass(self) -> Named[MassProperties]:
        """Mass properties of the parts, by name."""
        return Named("part", _computed(self.design.mass, "mass", "mass").parts, _describe_mass, _MASS)

    @property
    def behaviour(self) -> Behaviour:
        """The port model: components with ports, joined at nodes, flat (`system`) and in systems (`nested`)."""
        return _computed(self.design.behaviour, "behaviour", "simulate")

    @property
    def simulation(self) -> Simulation:
        """Trajectories, joint values and efforts, energy over time."""
        return _computed(self.design.simulation, "simulation", "simulate")

    @property
    def motion(self) -> Simulation:
        """The simulation with the names that the function gives to joints, values and ranges in the designer's order
        and sense; joints without such a name are as in `simulation`."""
        from kinform.function import as_intended, designers_joints

        run = self.simulation
        kinematics = _computed(self.design.kinematics, "joints", "joints")
        return as_intended(run, designers_joints(self.design.assembly, kinematics))

    def plots(self) -> Plots:
        """Joint values with their limits, efforts, reactions and energy over the simulated time, to be shown in the
        cell of a notebook; they need no other package."""
        from kinform.reports.page.plots import plots_html

        _computed(self.design.simulation, "plots", "simulate")
        html = plots_html(self.design)
        return Plots(html, html.count("<svg"))

    @property
    def findings(self) -> Findings:
        """What is inconsistent, sorted by code and subject."""
        return Findings(self.report.findings)

    @property
    def verdict(self) -> str:
        """As in "consistent", "no errors found (nothing declared)" or "FAILED: 1 joint error. 2 of 3 joints match"."""
        from kinform.consistency import verdict_of

        return verdict_of(self.report).line

    @property
    def coverage(self) -> str:
        """What the check covers and leaves open, in one line."""
        from kinform.consistency import verdict_of

        return verdict_of(self.report).coverage

    def page(self) -> str:
        """The page of `kinform report`, as HTML."""
        from kinform.reports.page import page_html

        return page_html(self.design)

    def view(self, height: int = 640) -> View:
        """The page with its 3D view, as high as that (px), to be shown in the cell of a notebook."""
        return View(self.page(), height)

    def _repr_html_(self) -> str:
        """Verdict, joints, findings and curves."""
        design = self.design
        shown = [f"<p><b>{escapes.html(design.assembly.name)}</b>: {len(design.assembly.parts)} parts"]
        shown[0] += f"; {escapes.html(self.verdict)}</p>" if design.report is not None else "</p>"
        if design.report is not None and self.coverage:
            shown.append(f"<p>{escapes.html(self.coverage)}</p>")
        if design.kinematics is not None:
            shown.append(self.joints._repr_html_())
        if design.report is not None and design.report.findings:
            shown.append(self.findings._repr_html_())
        if design.simulation is not None and len(design.simulation.time) > 1:
            shown.append(self.plots()._repr_html_())
        return "".join(shown)

    @property
    def report(self) -> CheckReport:
        """Findings, and which rules ran, were skipped, or could not decide."""
        return _computed(self.design.report, "findings", "check")

    def summary(self, topic: str | None = None) -> dict[str, Any]:
        """What `kinform show --format json` prints of a topic, or of all; see `kinform.reports.summary`."""
        from kinform import reports

        return reports.summary(self.design, topic)

    def save(self, path: str | Path) -> None:
        """Write the results file, whole or not at all. Raises ResultsError."""
        from kinform import results

        results.write(self.design, path)

    def __repr__(self) -> str:
        design = self.design
        lines = [f"{design.assembly.name}: {len(design.assembly.parts)} parts"]
        if design.kinematics is not None:
            mobility = design.kinematics.mobility
            lines.append(f"{len(design.kinematics.bodies)} bodies, mobility {mobility.effective}")
            lines += [f"  {j.name}: {j.type} ({j.status})" for j in design.kinematics.joints]
        if design.simulation is not None:
            lines.append(f"simulation: {design.simulation.level} {design.simulation.status}".rstrip())
        if design.report is not None:
            lines += filter(None, (escapes.one_line(self.verdict), escapes.one_line(self.coverage)))
            lines.append(f"{len(design.report.findings)} findings, {design.report.ran} rules ran")
        return "\n".join(lines)


class Outcome(Results):
    """Results of a run, with what it took over from earlier results and what it computed, in sentences.

    Where nothing changed, the results are read from their file when they are first asked for.
    """

    def __init__(
        self,
        design: Design | Callable[[], Design],
        reused: tuple[str, ...] = (),
        recomputed: tuple[str, ...] = (),
        *,
        account: str = "",
        gist: Design | None = None,
    ):
        super().__init__(design)
        self.reused = reused
        self.recomputed = recomputed
        self.account = account
        """In a line: what changed, and what was computed for it."""
        self._gist = gist

    @property
    def gist(self) -> Design:
        """What findings are told with: perhaps without parts and joints, and then had without reading them."""
        return self.design if self._gist is None else self._gist

    @classmethod
    def unchanged(
        cls, manifest: Path, output: Path, *, allow_outside: bool = False, trust: bool = False
    ) -> Outcome | None:
        """The results in `output`, if a run of the manifest would give these very bytes, as this user's kinform
        recorded, or `trust` takes for granted; their file gets a new time."""
        from kinform import results

        gist = results.read_if_current(output, manifest, allow_outside=allow_outside, trust=trust)
        if gist is None:
            return None
        try:
            results.check_output(output)
            os.utime(output)
        except (OSError, ResultsError):  # the run will say why it cannot be written
            return None

        def read() -> Design:
            design = results.read(output)
            if design.fingerprints.lineage != gist.fingerprints.lineage or design.recorded != gist.recorded:
                raise ResultsError(Problem("was replaced after the run that found it unchanged", str(output)))
            return design

        reused = ("surfaces", "contacts", "joints", "mass", "simulation", "findings")
        account = "nothing changed: everything is reused"
        if not gist.recorded:
            from kinform.reuse.ledger import TRUSTED

            account = f"everything is reused: {TRUSTED}"
        return cls(read, reused, account=account, gist=gist)


_MASS = ("name", "mass", "centre_of_mass", "principal_moments", "reason")


def _describe_part(part: Part) -> str:
    return "stick body" if part.mesh is None else f"{len(part.mesh.faces)} facets of {part.mesh.path}"


def _describe_mass(item: MassProperties) -> str:
    return f"unknown: {item.reason}" if item.mass is None else f"{item.mass:.4g} kg"


def open_results(path: str | Path) -> Results:
    """The results file at `path`. Raises ResultsError when it is none, or of another schema."""
    from kinform import results

    return Results(results.read(path))


def _computed(result: Result | None, what: str, command: str) -> Result:
    if result is None:
        raise StageError(what, command)
    return result
