"""`docs/results.md` names every dataset of results files, and none that is not there."""

from __future__ import annotations

import re
from pathlib import Path

import h5py
import pytest

from kinform import results

ROOT = Path(__file__).parents[2]
PAGE = ROOT / "docs" / "results.md"
MANIFESTS = ("seekers/seeker_2dof/seeker_2dof.toml", "broken/seeker_gimbal_overlaps/seeker_gimbal_overlaps.toml")


@pytest.fixture(scope="module")
def datasets(derive_design, tmp_path_factory) -> set[str]:
    """Paths of all datasets, but for the offsets that lists of arrays have beside them."""
    paths: set[str] = set()
    for manifest in MANIFESTS:
        target = tmp_path_factory.mktemp("results") / "r.h5"
        results.write(derive_design(ROOT / "fixtures" / manifest), target)
        with h5py.File(target) as file:
            file.visititems(lambda name, item: paths.add(name) if isinstance(item, h5py.Dataset) else None)
    return {path for path in paths if path.removesuffix("_offset") == path or path.removesuffix("_offset") not in paths}


def named() -> dict[str, list[str]]:
    """What the page puts in backquotes, by the groups that the heading above it names."""
    out: dict[str, list[str]] = {}
    for section in PAGE.read_text(encoding="utf-8").split("\n### ")[1:]:
        heading, body = section.split("\n", 1)
        groups = re.findall(r"`/(\w+)`", heading)
        for group in groups:
            out[group] = re.findall(r"`([\w/]+)`", body)
    return out


def test_every_dataset_is_named(datasets: set[str]):
    pages = named()
    missing = []
    for path in sorted(datasets):
        group, name = path.split("/", 1)
        if not {path, name} & set(pages.get(group, ())):
            missing.append(path)
    assert missing == []


def test_every_dataset_that_is_named_with_its_group_is_there(datasets: set[str]):
    whole = {name for names in named().values() for name in names if "/" in name.lstrip("/")}
    paths = datasets | {path.split("/", 1)[1] for path in datasets}
    optional = {"joints/meshings", "simulation/request", "simulation/initial", "simulation/sensors"}
    assert sorted(whole - paths - optional) == []
