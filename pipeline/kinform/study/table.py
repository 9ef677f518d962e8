"""A study as one table: HDF5, CSV, and values for JSON. The same study gives the same bytes."""

from __future__ import annotations

import dataclasses
import json
import math
from pathlib import Path
from typing import Any

import h5py
import numpy as np

from kinform.errors import InputError, Problem
from kinform.exports.names import XML, free_name, identifiers
from kinform.foundation.escapes import csv_cell
from kinform.results import replace_file
from kinform.study.session import Outcome
from kinform.study.statistics import statistics, whole_yield

SCHEMA = "kinform/study/1"


def write(outcome: Outcome, path: Path) -> None:
    """Write the table as HDF5, in one step: a dataset a column, and what follows from it as JSON in an attribute."""
    file = h5py.File("study", "w", driver="core", backing_store=False, libver=("earliest", "v108"), track_order=False)
    with file:
        file.attrs["schema"] = SCHEMA
        file.attrs["study"] = outcome.plan.path.read_text(encoding="utf-8")
        file.attrs["summary"] = json.dumps(values(outcome), ensure_ascii=True)
        for group, names, rows in (
            ("varied", [a.name for a in outcome.plan.axes], outcome.samples),
            ("measured", [m.name for m in outcome.plan.measures], outcome.measured),
        ):
            made = file.create_group(group)
            places = identifiers(names, XML)
            for k, name in enumerate(names):
                place = places[name].replace("/", "_").strip(".") or "_"
                _column(made, free_name(place, made), [row[k] for row in rows])
        _column(file, "failure", list(outcome.failures))
        file.flush()
        image = file.id.get_file_image()
    replace_file(path, image)


def check_output(path: Path) -> None:
    """Raise InputError where something else than a study stands in its place."""
    if not path.exists() or path.stat().st_size == 0:
        return
    try:
        with h5py.File(path, "r") as file:
            ours = str(file.attrs.get("schema", "")).startswith("kinform/study/")
    except OSError:
        ours = False
    if not ours:
        problem = Problem("is no study of kinform, and is not overwritten", str(path), None, "name another with -o")
        raise InputError([problem])


def _column(group: Any, name: str, column: list[Any]) -> None:
    if all(value is None or isinstance(value, int | float) for value in column):
        data: Any = np.array([math.nan if value is None else value for value in column], dtype="<f8")
        group.create_dataset(name, data=data, track_times=False)
    else:
        group.create_dataset(name, data=[str(v) for v in column], dtype=h5py.string_dtype("utf-8"), track_times=False)


def as_csv(outcome: Outcome) -> str:
    """The table as CSV: a row a sample; what is not known is empty."""
    names = [*(a.name for a in outcome.plan.axes), *(m.name for m in outcome.plan.measures)]
    lines = [["sample", *map(csv_cell, names), "failure"]]
    for k, (given, found, why) in enumerate(zip(outcome.samples, outcome.measured, outcome.failures, strict=True)):
        lines.append([str(k), *map(_cell, (*given, *found)), csv_cell(why)])
    return "".join(",".join(line) + "\n" for line in lines)


def _cell(value: Any) -> str:
    return "" if value is None else csv_cell(value) if isinstance(value, str) else repr(value)


def values(outcome: Outcome) -> dict[str, Any]:
    """What follows from the samples, as JSON has it."""
    whole = whole_yield(outcome)
    study = outcome.plan.study
    return {
        "schema": SCHEMA, "design": study.design, "method": study.method, "samples": len(outcome.samples),
        "failed": sum(bool(why) for why in outcome.failures),
        "yield": None if whole is None else {"good": whole[0], "of": whole[1], "share": whole[2][0],
                                             "low": whole[2][1], "high": whole[2][2]},
        "measures": [dataclasses.asdict(one) for one in statistics(outcome)],
    }  # fmt: skip
