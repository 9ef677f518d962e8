"""`kinform explain` knows the words in which results are told."""

from __future__ import annotations

import pytest

from kinform.consistency import UnknownRuleError, explain
from kinform.consistency.comparisons.answers import ANSWERS
from kinform.consistency.glossary import GLOSSARY
from kinform.model.findings import OUTCOMES
from kinform.model.kinematics import JOINT_TYPES, STATUSES

FITS = ("clearance", "touch", "transition", "interference")


@pytest.mark.parametrize("word", [*STATUSES, *ANSWERS, *JOINT_TYPES, *FITS, *OUTCOMES[2:], "idle", "redundant"])
def test_every_word_of_results_is_explained(word):
    head, _, text = explain(word).partition("\n\n")
    assert head == f"{word} ({GLOSSARY[word][0]})"
    assert len(text) > 30


def test_words_are_found_however_they_are_written_and_proposed_where_they_are_not():
    assert explain("Not_Held") == explain("not-held").replace("not-held", "not_held")
    with pytest.raises(UnknownRuleError) as caught:
        explain("blokced")
    assert caught.value.near[0] == "blocked"


def test_no_word_hides_a_rule():
    from kinform.consistency import RULES

    assert not {rule.name for rule in RULES} & {word.replace(" ", "-") for word in GLOSSARY}
