"""Every kind of requirement has a rule, and a judge of its doubts."""

from __future__ import annotations

from support.requirements import CODES

from kinform.consistency import RULES
from kinform.consistency.requirements import RequirementRule


def test_every_kind_of_requirement_has_a_rule_of_its_own():
    from typing import get_args

    from kinform.form.manifest.requirements import Require

    union = get_args(Require)[0]
    kinds = {get_args(kind.model_fields["kind"].annotation)[0] for kind in get_args(union)}
    assert kinds == set(CODES) == {rule.kind for rule in RULES if isinstance(rule, RequirementRule)}
    assert set(CODES.values()) <= {rule.code for rule in RULES}
