"""What a worker does for one sample: the design with other values, as far as it differs, and what is measured of it."""

from __future__ import annotations

import os
import subprocess
import sys
import tempfile
from collections.abc import Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import Any

from kinform import consistency, method
from kinform.design import Design
from kinform.errors import InputError, Problem
from kinform.form.keys import looked_up
from kinform.form.sources import Reading
from kinform.foundation import interpreters
from kinform.foundation.parent_death import exit_with_parent
from kinform.reports.values.topics import TOPICS, summary

UNITS = {
    "mass": "kg",
    "volume": "m³",
    "area": "m²",
    "centre_of_mass": "m",
    "point": "m",
    "inertia": "kg·m²",
    "principal_moments": "kg·m²",
    "duration": "s",
}
"""What values of these names are in, where nothing beside them says it."""


_BESIDES = ("margins", "requirements", "sensors", "exit_code")
"""What can be measured besides the topics of `kinform show`."""


def sample(
    design: str,
    base: str | None,
    changes: Sequence[tuple[tuple[str, ...], Any]],
    measured: Sequence[tuple[str, ...]],
    commands: Sequence[tuple[str, Sequence[str], str]] = (),
    allow_outside: bool = False,
    allow_xacro: bool = False,
    folder: str | None = None,
) -> tuple[float | None, ...]:
    """The values at these paths of the design with these changes; None where a value is not known.

    `base` are results of the design as it stands: what a change leaves as it was is taken from there. `commands` make
    meshes: the part, the words (with {file} for the mesh), the suffix; they run in `folder`, that of the study. Raises
    InputError.
    """
    with tempfile.TemporaryDirectory(prefix="kinform-study-") as place:
        made = [
            _made(part, words, Path(place) / f"mesh{k}{end}", folder) for k, (part, words, end) in enumerate(commands)
        ]
        reading = Reading(changes=(*changes, *made), allow_xacro=allow_xacro)
        outside = allow_outside or bool(made)
        outcome = method.run(design, base=base, reading=reading, allow_outside=outside)
        try:
            return measure(outcome.design, measured)
        except KeyError as error:
            raise InputError([Problem(f"[[measure]]: {error.args[0]}", design)]) from None


def nominal(
    design: str,
    output: str,
    measured: Sequence[tuple[str, ...]],
    allow_outside: bool = False,
    allow_xacro: bool = False,
) -> tuple[tuple[float | None, ...], tuple[str, ...], dict[str, str]]:
    """The values at these paths of the design as it stands, whose results are written, and their units; and the hashes
    of its files."""
    done = method.run(design, output, allow_outside=allow_outside, reading=Reading(allow_xacro=allow_xacro)).design
    try:
        _refuse_what_is_no_number(done, measured)
        return measure(done, measured), units(done, measured), dict(done.fingerprints.files)
    except KeyError as error:
        raise InputError([Problem(f"[[measure]]: {error.args[0]}", design)]) from None


def measure(design: Design, measured: Sequence[tuple[str, ...]]) -> tuple[float | None, ...]:
    """The numbers at these paths of what `kinform show --format json` prints, the first step being the topic;
    `exit_code` alone is that of the gate, `requirements.NAME` is 1 where it is met, and 0 where not, `margins.NAME` how
    far, and `sensors.NAME.QUANTITY.COMPONENT` what a sensor reads."""
    shown = {topic: _topic(design, topic) for topic in sorted({steps[0] for steps in measured})}
    values = (looked_up(shown[steps[0]], _to_value(steps)) for steps in measured)
    return tuple(float(value) if isinstance(value, int | float) else None for value in values)


def _refuse_what_is_no_number(design: Design, measured: Sequence[tuple[str, ...]]) -> None:
    """Raises KeyError for a path at which there is a text, a list or a table."""
    for steps in measured:
        value = looked_up(_topic(design, steps[0]), _to_value(steps))
        path = ".".join(steps)
        if isinstance(value, Mapping):
            raise KeyError(f"{path!r} is a table, no number: it has {', '.join(map(str, value)) or 'nothing'}")
        if isinstance(value, Sequence):
            what = (
                f"the text {value!r}" if isinstance(value, str) else f"a list of {len(value)} ({path}.count, {path}.0)"
            )
            raise KeyError(f"{path!r} is {what}, no number")


def units(design: Design, measured: Sequence[tuple[str, ...]]) -> tuple[str, ...]:
    """In what these values are, "" where nothing says it."""
    shown = {topic: _topic(design, topic) for topic in sorted({steps[0] for steps in measured})}
    return tuple(_unit(shown[steps[0]], _to_value(steps)) for steps in measured)


def _to_value(steps: tuple[str, ...]) -> tuple[str, ...]:
    """The steps below the topic; a margin is the value of its entry."""
    return (*steps[1:], "value") if steps[0] == "margins" and len(steps) == 2 else steps[1:]


def _unit(values: Any, steps: tuple[str, ...]) -> str:
    """What the nearest entry on the way that states a unit says, else what the name of the value means."""
    last = next((step for step in reversed(steps) if step not in ("count", "min", "max", "sum", "mean")
                 and not step.lstrip("-").isdigit()), "")  # fmt: skip
    if steps and steps[-1] == "count":
        return ""
    for end in range(len(steps) - 1, -1, -1):
        entry = looked_up(values, steps[:end])
        unit = entry.get("unit") if isinstance(entry, Mapping) else None
        if isinstance(unit, str):
            return f"{unit}/s" if last == "fastest" else "" if unit == "1" else unit
    return UNITS.get(last, "")


def _topic(design: Design, topic: str) -> Any:
    if topic == "exit_code":
        assert design.report is not None
        return consistency.verdict(design.report)
    if topic == "requirements":
        from kinform.catalog import entry_of

        return {wanted.name: wanted.met for wanted in entry_of(design, "", "").requirements}
    if topic == "margins":
        found = consistency.margins(design)
        return {name: {"value": m and m.value, "unit": m and m.unit} for name, m in found.items()}
    if topic == "sensors":
        return _sensors(summary(design, "simulation")["sensors"])
    if topic not in TOPICS:
        raise KeyError(f"{topic!r} is no topic: expected one of {', '.join([*TOPICS, *_BESIDES])}")
    return summary(design, topic)


def _sensors(readings: Sequence[Mapping[str, Any]]) -> dict[str, Any]:
    """What sensors read by sensor, quantity, and component where it has some; null where the model leaves it open."""
    out: dict[str, Any] = {}
    for reading in readings:
        ends = {key: reading[key] if reading["known"] else None for key in ("start", "end", "lowest", "highest")}
        read = {**ends, "unit": reading["unit"]}
        quantities = out.setdefault(reading["sensor"], {})
        if reading["component"]:
            quantities.setdefault(reading["quantity"], {})[reading["component"]] = read
        else:
            quantities[reading["quantity"]] = read
    return out


def _made(part: str, words: Sequence[str], file: Path, folder: str | None) -> tuple[tuple[str, ...], str]:
    """The change that gives a part the mesh that a command makes."""
    command = [word.replace("{file}", str(file)) for word in words]
    ending = partial(exit_with_parent, os.getpid())
    try:
        done = subprocess.run(
            command, stdin=subprocess.DEVNULL, capture_output=True, text=True, errors="replace", check=False,
            cwd=folder, env=interpreters.of_user(), preexec_fn=ending if sys.platform == "linux" else None,
        )  # fmt: skip
    except OSError as error:
        raise InputError([Problem(f"{command[0]}: {error.strerror}", None, None, "see that it is installed")]) from None
    if done.returncode or not file.is_file():
        last = (done.stderr.strip() or done.stdout.strip() or "without words").splitlines()[-1]
        why = f"ended with {done.returncode}: {last}" if done.returncode else "wrote no mesh to {file}"
        raise InputError([Problem(f"the command for part {part!r} {why}", command[0])])
    return ("part", part, "mesh"), str(file)
