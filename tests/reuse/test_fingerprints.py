"""A fingerprint changes with every part of its inputs, and covers all code and all input of its stage."""

from __future__ import annotations

import ast
import dataclasses
import functools
from pathlib import Path
from typing import Any, get_type_hints

import numpy as np
import pytest
from hypothesis import HealthCheck, Phase, given, settings
from hypothesis import strategies as st
from support.designs import NAMED, by_type, designs, difference

import kinform
from kinform.design import Design
from kinform.model.assembly import Assembly
from kinform.model.function import Function
from kinform.reuse import dependence, fingerprints
from kinform.reuse.digest import digest

PACKAGE = Path(kinform.__file__).parent
SETTINGS = settings(
    max_examples=2,
    deadline=None,
    phases=[Phase.generate],
    suppress_health_check=[HealthCheck.too_slow, HealthCheck.data_too_large, HealthCheck.large_base_example],
)


@SETTINGS
@given(one=designs(), data=st.data())
def test_equal_content_has_one_digest_and_other_content_another(one: Design, data: st.DataObject) -> None:
    """Also where only what one stage found is other."""
    hints = get_type_hints(Design, localns=NAMED)
    stage = data.draw(st.sampled_from([field.name for field in dataclasses.fields(Design)]))
    two = dataclasses.replace(one, **{stage: data.draw(by_type(hints[stage]))})
    assert digest(one) == digest(dataclasses.replace(one))
    assert (digest(one) == digest(two)) == (difference(one, two) is None)


@pytest.mark.parametrize(
    ("one", "two"),
    [
        (("ab", "c"), ("a", "bc")),
        ((1.0,), (np.nextafter(1.0, 2.0),)),
        ((0.0,), (-0.0,)),
        ((None,), (0,)),
        ((1,), (1.0,)),
        (("1",), (1,)),
        (((), ()), ((),)),
        ((np.zeros((2, 3)),), (np.zeros((3, 2)),)),
        ((np.zeros(2),), (np.zeros(2, dtype=np.int64),)),
        (({"a": 1, "b": 2},), ({"a": 2, "b": 1},)),
        ((Function(mobility=1),), (Function(mobility_line=1),)),
    ],
)
def test_values_that_differ_have_other_digests(one: tuple[Any, ...], two: tuple[Any, ...]) -> None:
    assert digest(*one) != digest(*two)


def test_the_order_of_a_dict_and_the_memory_layout_of_an_array_do_not_matter() -> None:
    assert digest({"a": 1, "b": 2}) == digest({"b": 2, "a": 1})
    array = np.arange(6.0).reshape(2, 3)
    assert digest(array) == digest(np.asfortranarray(array)) == digest(array.astype(">f8"))


def test_a_value_without_content_is_refused() -> None:
    with pytest.raises(TypeError):
        digest(object())


@functools.cache
def _imports(package: str) -> set[str]:
    """Packages of kinform that the code of a package imports."""
    found = set()
    for path in (*(PACKAGE / package).rglob("*.py"), *PACKAGE.glob(f"{package}.py")):
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if isinstance(node, ast.ImportFrom) and node.module and node.module.startswith("kinform."):
                found.add(node.module.split(".")[1])
            elif isinstance(node, ast.ImportFrom) and node.module == "kinform":
                found |= {alias.name for alias in node.names}
    return found - {package, "frozen", "model", "design", "errors"}


@pytest.mark.parametrize("stage", ["surfaces", "contacts", "joints", "mass", "simulation", "findings"])
def test_the_version_of_all_code_that_a_stage_imports_is_in_its_fingerprint(stage: str) -> None:
    counted = set(dependence.CODE[stage])
    for package in counted:
        # tables of the manifest and elements of files decide what is read: the assembly shows it, and its fingerprint
        shown = {"requirements": {"form"}, "consistency": {"formats"}}.get(package, set())
        assert _imports(package) - shown <= counted


@SETTINGS
@given(design=designs())
def test_a_fingerprint_covers_every_field_of_the_assembly(design: Design) -> None:
    fields = {field.name.replace("_", " ") for field in dataclasses.fields(Assembly)}
    for stage in dependence.STAGES:
        assert fields <= set(fingerprints.of_stage(stage, design, {}))


@SETTINGS
@given(design=designs())
def test_what_a_stage_sees_has_no_files_and_lines_except_for_the_findings(design: Design) -> None:
    for stage in (dependence.CONTACTS, dependence.JOINTS, dependence.MASS, dependence.SIMULATION):
        view = stage.view(design.assembly)
        function, request = view.function, view.simulation
        placed = [*function.joints, *function.couplings, *function.drives, *function.loads]
        assert all(item.file == "" and item.line is None for item in placed)
        assert request is None or (request.file is None and request.line is None)
        assert not any(item.source.line for item in (view, *view.parts, *view.groups, *view.assumptions))
        assert [part.name for part in view.parts] == [part.name for part in design.assembly.parts]
    assert dependence.FINDINGS.view(design.assembly) is design.assembly
