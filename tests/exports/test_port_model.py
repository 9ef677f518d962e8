"""json: the port model, its schema, and what is refused."""

from __future__ import annotations

import json

import numpy as np
import pytest
from support.export_models import ALL, known, model_of
from support.places import ROOT
from support.validators import package

from kinform.errors import InputError
from kinform.exports import export
from kinform.exports.port_model import read, schema


@pytest.mark.parametrize("name", ALL)
def test_reading_the_port_model_gives_an_equal_one(name):
    (data,) = export(known(name), "json").files.values()
    system, again = model_of(known(name)).nested, read(data)
    assert again.nodes == system.nodes
    assert [type(c) for c in again.components] == [type(c) for c in system.components]
    for ours, theirs in zip(system.components, again.components, strict=True):
        same(vars(ours), vars(theirs))


def same(a, b):
    """Equal to the bit, arrays and nested records too."""
    if isinstance(a, dict):
        assert a.keys() == b.keys()
        for key in a:
            same(a[key], b[key])
    elif isinstance(a, np.ndarray):
        np.testing.assert_array_equal(a, b)
    elif (
        hasattr(a, "__dict__") and type(a).__module__.startswith("kinform") and not callable(getattr(a, "chain", None))
    ):
        assert type(a) is type(b)
        same(vars(a), vars(b))
    else:
        assert a == b


@pytest.mark.parametrize("name", ALL)
def test_the_port_model_keeps_its_schema(name):
    jsonschema = package("jsonschema")
    (data,) = export(known(name), "json").files.values()
    jsonschema.Draft202012Validator.check_schema(schema())
    jsonschema.Draft202012Validator(schema()).validate(json.loads(data))


def test_the_published_schema_is_current():
    assert json.loads((ROOT / "docs" / "port-model.schema.json").read_text(encoding="utf-8")) == schema()


@pytest.mark.parametrize(
    "change",
    [
        lambda d: d.update(schema="kinform/port-model/9"),
        lambda d: d["components"][1].update(mass="heavy"),
        lambda d: d["components"][1].update(colour="red"),
        lambda d: d["components"].append(d["components"][0]),
        lambda d: d["nodes"][0]["ports"].pop(),
        lambda d: d["nodes"][0].update(size=3),
    ],
)
def test_a_damaged_port_model_is_refused(change):
    (data,) = export(known("gimbal"), "json").files.values()
    changed = json.loads(data)
    change(changed)
    with pytest.raises(InputError):
        read(json.dumps(changed))
