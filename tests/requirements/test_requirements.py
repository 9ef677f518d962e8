"""The registry of kinds: what is in its folder has a table, a record, a judge, and a rule that reports it."""

from __future__ import annotations

import subprocess
import sys
from dataclasses import fields
from typing import get_args

import pytest
from support.places import ROOT

from kinform.consistency import RULES
from kinform.consistency.requirements import RequirementRule
from kinform.form import schema
from kinform.requirements import KINDS, all_kinds, kind_of
from kinform.requirements.quantity import quantities

ADDED = {"rows"}
"""Fields of records that the reader adds."""


def test_every_kind_of_requirement_has_just_one_rule():
    assert sorted(rule.kind for rule in RULES if isinstance(rule, RequirementRule)) == sorted(KINDS)


def test_every_kind_is_in_the_schema_of_manifests():
    variants = schema()["$defs"]["FunctionTable"]["properties"]["require"]["items"]["discriminator"]["mapping"]
    assert variants.keys() == KINDS


def test_kinds_have_places_of_their_own_in_lists():
    assert len({kind.position for kind in all_kinds()}) == len(KINDS)


@pytest.mark.parametrize("name", sorted(KINDS))
def test_a_kind_is_named_alike_in_folder_table_and_registry(name):
    kind = kind_of(name)
    assert kind.name == name
    assert get_args(kind.table.model_fields["kind"].annotation) == (name,)


@pytest.mark.parametrize("name", sorted(KINDS))
def test_a_record_has_a_field_for_every_key_that_its_judge_may_need(name):
    kind = kind_of(name)
    keys = kind.table.model_fields.keys() - {"name", "kind", "when_run", "path"}
    assert {field.name for field in fields(kind.record)} - ADDED == keys


@pytest.mark.parametrize("name", sorted(KINDS))
def test_what_a_key_measures_is_stated_where_it_is_a_number(name):
    table = kind_of(name).table
    numbers = {key for key, field in table.model_fields.items() if "float" in str(field.annotation)}
    assert numbers - quantities(table).keys() <= {"minimum"}
    if name != "efficiency":
        assert numbers <= quantities(table).keys()


def test_a_kind_that_is_unknown_is_an_error_of_the_caller():
    with pytest.raises(KeyError):
        kind_of("levitate")


def test_rules_load_no_kind_before_a_requirement_of_it_is_judged():
    script = "import sys, kinform.consistency as c; c.RULES; c.check; print([m for m in sys.modules if '.kinds.' in m])"
    told = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=True, cwd=ROOT)
    assert told.stdout.strip() == "[]"


def test_the_readme_names_every_kind():
    text = (ROOT / "README.md").read_text(encoding="utf-8")
    assert [name for name in sorted(KINDS) if f"`{name}`" not in text] == []
