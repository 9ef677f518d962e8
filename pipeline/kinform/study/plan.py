"""What a study is: a TOML file that says what varies, how, and what is measured."""

from __future__ import annotations

import hashlib
from dataclasses import replace
from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import BaseModel, ConfigDict, Field, ValidationError, model_validator

from kinform.errors import InputError, Problem
from kinform.form.keys import steps_of
from kinform.form.stated import stated_value, toml_of
from kinform.foundation.boundary import OUTSIDE, OUTSIDE_REMEDY, Boundary
from kinform.frozen import dataclass
from kinform.study import fits

SAMPLES_MOST = 1_000_000
"""Samples of a study; its table is held in memory. A choice."""
SIGMAS = 3.0
"""Standard deviations from the middle of a tolerance to its limits, where it is met by a normal distribution: a process
whose capability is 1, so that 0.27 % lie outside. What drawings are commonly read as."""


Method = Literal["grid", "one-at-a-time", "latin-hypercube", "sobol", "monte-carlo"]
Distribution = Literal["uniform", "normal", "triangular"]


class _Table(BaseModel):
    model_config = ConfigDict(extra="forbid", allow_inf_nan=False, frozen=True)


class Study(_Table):
    """`[study]`."""

    design: str
    """The manifest or description, relative to this file."""
    method: Method = "monte-carlo"
    samples: Annotated[int, Field(ge=1, le=SAMPLES_MOST)] | None = None
    seed: Annotated[int, Field(ge=0)] = 0
    indices: bool = False
    """With sobol: also first-order indices, by d + 2 times as many samples."""


class Vary(_Table):
    """`[[vary]]`: one number of the manifest, in its units, or a text such as the file of a mesh."""

    name: str
    value: str | None = None
    """Its path; None: it is only for commands."""
    values: list[float | int | str] | None = None
    between: tuple[float, float] | None = None
    steps: Annotated[int, Field(ge=2)] | None = None
    """Of a grid."""
    distribution: Distribution | None = None
    mean: float | None = None
    deviation: Annotated[float, Field(gt=0)] | None = None
    tolerance: str | None = None
    """±0.1, +0.2/-0.1, H7, or H7/g6."""
    nominal: float | None = None
    diameter: Annotated[float, Field(gt=0)] | None = None
    """mm, of a tolerance class; else the nominal value."""
    unit: str = ""
    """What its values are in, as tables and pictures are to say; the manifest decides what they mean."""

    @model_validator(mode="after")
    def _one_way(self) -> Vary:
        ways = [self.values is not None, self.between is not None, self.tolerance is not None, self.mean is not None]
        if sum(ways) != 1:
            raise ValueError("say how it varies by one of values, between, tolerance, or mean with deviation")
        if (self.mean is None) != (self.deviation is None):
            raise ValueError("mean and deviation go together")
        if self.mean is not None and self.distribution not in (None, "normal"):
            raise ValueError("mean and deviation are of a normal distribution; give between for others")
        if self.between is not None and not self.between[0] < self.between[1]:
            raise ValueError("between is a lesser and a greater value")
        if self.values is not None and len(self.values) < 1:
            raise ValueError("values has none")
        if self.value is not None:
            steps_of(self.value)
        return self


class Measure(_Table):
    """`[[measure]]`: a value of `kinform show --format json`, and between which limits it is good."""

    name: str
    value: str
    least: float | None = None
    most: float | None = None

    @model_validator(mode="after")
    def _path(self) -> Measure:
        steps_of(self.value)
        return self


class Make(_Table):
    """`[[make]]`: a mesh that a command makes of what varies."""

    part: str
    command: list[str]
    """Its words; {name} stands for a value, {file} for the mesh to be written."""
    suffix: Literal[".stl", ".obj", ".ply", ".off"] = ".stl"


class Tables(_Table):
    """The whole file."""

    schema_: Annotated[Literal[1], Field(alias="schema")]
    study: Study
    vary: Annotated[list[Vary], Field(min_length=1)]
    measure: Annotated[list[Measure], Field(min_length=1)]
    make: list[Make] = []


@dataclass(frozen=True)
class Axis:
    """How one value varies: over these values, or by a distribution."""

    name: str
    steps: tuple[str, ...] | None
    values: tuple[Any, ...] | None = None
    distribution: Distribution = "uniform"
    low: float = 0.0
    high: float = 0.0
    """Limits; of a normal distribution mean ± deviation times `SIGMAS`."""
    count: int | None = None
    """Steps of a grid."""
    unit: str = ""
    """As stated."""


@dataclass(frozen=True)
class Plan:
    """A study, ready to be drawn."""

    path: Path
    design: Path
    study: Study
    axes: tuple[Axis, ...]
    measures: tuple[Measure, ...]
    makes: tuple[Make, ...]
    digest: str
    """SHA-256 of the file's text."""


def read_plan(path: Path, *, allow_outside: bool = False) -> Plan:
    """The study in a file. Raises InputError with every problem."""
    boundary = Boundary(path, allow_outside=allow_outside)
    text, raw = toml_of(path, "a study", boundary)
    try:
        tables = Tables.model_validate(raw)
    except ValidationError as error:
        raise InputError([_problem(one, path) for one in error.errors()]) from None
    design = path.parent / tables.study.design
    problems: list[Problem] = []
    if not boundary.allows(design):
        raise InputError([Problem(f"design: {tables.study.design} {OUTSIDE}", str(path), None, OUTSIDE_REMEDY)])
    if not boundary.is_file(design):
        problems.append(Problem(f"design: there is no file {tables.study.design}", str(path)))
    problems += _doubles(tables, path)
    axes = []
    for one in tables.vary:
        try:
            axes.append(replace(_axis(one, design, boundary), unit=one.unit))
        except (ValueError, KeyError) as error:
            problems.append(Problem(f"[[vary]] {one.name!r}: {error.args[0]}", str(path)))
    problems += [Problem(text, str(path)) for text in _wrong_together(tables, axes)]
    if problems:
        raise InputError(problems)
    digest = hashlib.sha256(text.encode()).hexdigest()
    return Plan(path, design, tables.study, tuple(axes), tuple(tables.measure), tuple(tables.make), digest)


def _axis(one: Vary, design: Path, boundary: Boundary) -> Axis:
    steps = None if one.value is None else steps_of(one.value)
    if one.values is not None:
        return Axis(one.name, steps, tuple(one.values))
    if one.between is not None:
        kind = one.distribution or "uniform"
        return Axis(one.name, steps, None, kind, *one.between, one.steps)
    if one.mean is not None and one.deviation is not None:
        width = SIGMAS * one.deviation
        return Axis(one.name, steps, None, "normal", one.mean - width, one.mean + width, one.steps)
    middle = one.nominal
    if middle is None and steps is not None and boundary.is_file(design):
        try:
            middle = stated_value(design, steps, boundary)
        except KeyError as error:
            raise ValueError(
                f"its nominal value is not known ({error.args[0]}): correct value, or state nominal"
            ) from None
    if not isinstance(middle, int | float) or isinstance(middle, bool):
        raise ValueError("its nominal value is not known: state nominal")
    low, high = _deviations(str(one.tolerance), one.diameter or abs(float(middle)))
    return Axis(one.name, steps, None, one.distribution or "normal", middle + low, middle + high, one.steps)


def _deviations(text: str, size: float) -> tuple[float, float]:
    """Lower and upper deviation of ±0.1, +0.2/-0.1, or a class of ISO 286 (mm)."""
    import re

    number = r"(\d+(?:\.\d+)?)"
    if match := re.fullmatch(rf"(?:±|\+/-|\+-)\s*{number}", text.strip()):
        return -float(match[1]), float(match[1])
    if match := re.fullmatch(rf"([+-]?{number})\s*/\s*([+-]?{number})", text.strip()):
        ends = sorted((float(match[1]), float(match[3])))
        return ends[0], ends[1]
    return fits.limits(text.strip(), size)


def _doubles(tables: Tables, path: Path) -> list[Problem]:
    out = []
    for what, names in (("vary", [v.name for v in tables.vary]), ("measure", [m.name for m in tables.measure])):
        out += [
            Problem(f"two [[{what}]] are named {n!r}", str(path))
            for n in sorted({n for n in names if names.count(n) > 1})
        ]
    shared = {v.name for v in tables.vary} & {m.name for m in tables.measure}
    return out + [Problem(f"{n!r} varies and is measured: rename one", str(path)) for n in sorted(shared)]


def _wrong_together(tables: Tables, axes: list[Axis]) -> list[str]:
    """What does not go together."""
    study, out = tables.study, []
    if study.method == "grid":
        out += [f"[[vary]] {a.name!r}: a grid needs values, or steps" for a in axes if a.values is None and not a.count]
    elif study.method != "one-at-a-time" and study.samples is None:
        out.append(f"[study]: {study.method} needs samples")
    if study.method == "sobol" and study.samples and study.samples & (study.samples - 1):
        below = 1 << (study.samples.bit_length() - 1)
        out.append(f"[study]: samples of sobol are a power of two: {below} or {2 * below}")
    if study.indices and study.method != "sobol":
        out.append('[study]: indices are of Sobol\' samples: method = "sobol"')
    used = {name for make in tables.make for word in make.command for name in _fields(word)}
    known = {v.name for v in tables.vary} | {"file"}
    out += [f"[[make]]: nothing that varies is named {name!r}" for name in sorted(used - known)]
    out += [
        f"[[vary]] {v.name!r} has no effect: give its path as value, or use it in a command"
        for v in tables.vary
        if v.value is None and v.name not in used
    ]
    return out


def _fields(word: str) -> list[str]:
    import re

    return re.findall(r"\{([^{}]+)\}", word)


def _problem(error: Any, path: Path) -> Problem:
    place = ".".join(str(step) for step in error["loc"] if step != "schema_")
    return Problem(f"{place}: {error['msg'].removeprefix('Value error, ')}" if place else error["msg"], str(path))
