"""What a worker does for one sample: the design with other values, as far as it differs, and what is measured of it."""

from __future__ import annotations

import subprocess
import tempfile
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from kinform import method
from kinform.design import Design
from kinform.errors import InputError, Problem
from kinform.form.keys import looked_up
from kinform.form.sources import Reading
from kinform.reports.values.topics import TOPICS, summary


def sample(
    design: str,
    base: str | None,
    changes: Sequence[tuple[tuple[str, ...], Any]],
    measured: Sequence[tuple[str, ...]],
    commands: Sequence[tuple[str, Sequence[str], str]] = (),
    allow_outside: bool = False,
) -> tuple[float | None, ...]:
    """The values at these paths of the design with these changes; None where a value is not known.

    `base` are results of the design as it stands: what a change leaves as it was is taken from there. `commands` make
    meshes: the part, the words (with {file} for the mesh), the suffix. Raises InputError.
    """
    with tempfile.TemporaryDirectory(prefix="kinform-study-") as folder:
        made = [_made(part, words, Path(folder) / f"mesh{k}{end}") for k, (part, words, end) in enumerate(commands)]
        reading = Reading(changes=(*changes, *made))
        outside = allow_outside or bool(made)
        outcome = method.run(design, base=base, reading=reading, allow_outside=outside)
        return measure(outcome.design, measured)


def nominal(
    design: str, output: str, measured: Sequence[tuple[str, ...]], allow_outside: bool = False
) -> tuple[tuple[float | None, ...], dict[str, str]]:
    """The values at these paths of the design as it stands, whose results are written; and the hashes of its files."""
    done = method.run(design, output, allow_outside=allow_outside).design
    try:
        return measure(done, measured), dict(done.fingerprints.files)
    except KeyError as error:
        raise InputError([Problem(f"[[measure]]: {error.args[0]}", design)]) from None


def measure(design: Design, measured: Sequence[tuple[str, ...]]) -> tuple[float | None, ...]:
    """The numbers at these paths of what `kinform show --format json` prints, the first step being the topic;
    `exit_code` alone is that of the gate, `requirements.NAME` is 1 where it is met, and 0 where not, and `margins.NAME`
    is how far it is from its limit."""
    shown: dict[str, Any] = {}
    out: list[float | None] = []
    for steps in measured:
        topic = steps[0]
        if topic not in shown:
            shown[topic] = _topic(design, topic)
        value = looked_up(shown[topic], steps[1:])
        out.append(float(value) if isinstance(value, int | float) else None)
    return tuple(out)


def _topic(design: Design, topic: str) -> Any:
    if topic == "exit_code":
        from kinform.model.findings import verdict

        assert design.report is not None
        return verdict(design.report)
    if topic == "requirements":
        from kinform.catalog import entry_of

        return {wanted.name: wanted.met for wanted in entry_of(design, "", "").requirements}
    if topic == "margins":
        from kinform.consistency import margins

        return margins(design)
    if topic not in TOPICS:
        known = ", ".join([*TOPICS, "requirements", "margins", "exit_code"])
        raise InputError([Problem(f"{topic!r} is no topic: expected one of {known}")])
    return summary(design, topic)


def _made(part: str, words: Sequence[str], file: Path) -> tuple[tuple[str, ...], str]:
    """The change that gives a part the mesh that a command makes."""
    command = [word.replace("{file}", str(file)) for word in words]
    try:
        done = subprocess.run(command, stdin=subprocess.DEVNULL, capture_output=True, text=True, check=False)
    except OSError as error:
        raise InputError([Problem(f"{command[0]}: {error.strerror}", None, None, "see that it is installed")]) from None
    if done.returncode or not file.is_file():
        last = (done.stderr.strip() or done.stdout.strip() or "without words").splitlines()[-1]
        why = f"ended with {done.returncode}: {last}" if done.returncode else "wrote no mesh to {file}"
        raise InputError([Problem(f"the command for part {part!r} {why}", command[0])])
    return ("part", part, "mesh"), str(file)
