"""Runs that tests share."""

from __future__ import annotations

from pathlib import Path

import pytest


@pytest.fixture(scope="session")
def derive_design():
    """A manifest to a design with findings, each computed once a session."""
    from kinform import stages

    known = {}

    def derive(manifest: Path):
        if manifest not in known:
            design = stages.joints(stages.contacts(stages.import_(manifest)))
            known[manifest] = stages.check(stages.simulate(stages.mass(design)))
        return known[manifest]

    return derive
