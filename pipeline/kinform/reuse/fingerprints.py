"""From what a result was computed, as one hash a result; and in words, what changed since.

A fingerprint covers the content of a stage's inputs, the settings, and the version of the code that runs
(`dependence`): no time of a file, no path, no order of events. Equal fingerprints are the licence to reuse.
"""

from __future__ import annotations

import dataclasses
import functools
import importlib
import pkgutil
import re
import sys
from collections.abc import Mapping, Sequence

from kinform.design import Design
from kinform.foundation import words
from kinform.model.assembly import Assembly
from kinform.reuse.dependence import CODE, Stage
from kinform.reuse.digest import digest
from kinform.version import __version__

Inputs = Mapping[str, str]
"""Hash of each input, by its name in words."""


def mark(kind: str, inputs: Inputs) -> str:
    """The fingerprint of a result of this kind with these inputs, computed by the present code."""
    return digest(kind, __version__, versions_of(kind), dict(inputs))


def versions_of(kind: str) -> list[int]:
    """The versions of all code that decides results of a kind; imports none of it."""
    return [_version_of(package) for package in CODE[kind]]


def _version_of(package: str) -> int:
    module = sys.modules.get(f"kinform.{package}")
    version = getattr(module, "CODE_VERSION", None)  # not there yet while the package is being imported
    return stated_version(package) if version is None else int(version)


@functools.cache
def stated_version(package: str) -> int:
    """As the text of the package says, since importing it takes longer than a run that reuses everything."""
    for file in (f"{package}/__init__.py", f"{package}.py"):
        try:
            text = pkgutil.get_data("kinform", file) or b""
        except OSError:  # another kind of module, or compiled only
            continue
        stated = re.search(rb"^CODE_VERSION(?:: int)? = (\d+)$", text, re.MULTILINE)
        if stated is not None:
            return int(stated[1])
    return int(importlib.import_module(f"kinform.{package}").CODE_VERSION)


def of_assembly(assembly: Assembly) -> Inputs:
    """Everything that was read."""
    return {"the input": digest(dataclasses.replace(assembly, function=assembly.function.as_named))}


def of_stage(stage: Stage, design: Design, settings: Mapping[str, str | None]) -> Inputs:
    """Inputs of a whole stage; settings that are None are not stated."""
    view = stage.view(design.assembly)
    inputs = {field.name.replace("_", " "): digest(getattr(view, field.name)) for field in dataclasses.fields(view)}
    inputs |= {name: digest(result) for name, result in stage.results(design).items()}
    return inputs | {name: value for name, value in settings.items() if value is not None}


def changes(before: Inputs | None, after: Inputs) -> str:
    """In words, why a result with the inputs `before` is not one with the inputs `after`; {}: nobody noted them."""
    if before is None:
        return "not computed before"
    changed = [name for name in after if before.get(name) != after[name]] if before else []
    return f"{few(changed)} changed" if changed else "computed by another version of kinform"


def few(names: Sequence[str]) -> str:
    """The first few of some names, as a sentence lists them."""
    return words.listed(names if len(names) <= 4 else [*names[:3], f"{len(names) - 3} more"])
