"""Pages that tests share, and the browser that opens them."""

from __future__ import annotations

import shutil

import pytest
from support.browser import Browser, program
from support.markup import NASTY
from support.places import FIXTURES

from kinform import stages
from kinform.reports.page import page_html, pictures


@pytest.fixture(scope="session")
def nasty(tmp_path_factory):
    """A shaft in a block, with names and a reason that are attacks, and findings that repeat them."""
    folder = tmp_path_factory.mktemp("nasty")
    source = FIXTURES / "pairs" / "revolute_collars"
    for mesh in source.glob("*.stl"):
        shutil.copy(mesh, folder)
    text = (source / "revolute_collars.toml").read_text()
    for old, new in (("shaft", NASTY), ("main", '<b>joint<b>" onclick="x'), ("revolute_collars", "<h1>x<h1>")):
        text = text.replace(f'name = "{old}"', f"name = '''{new}'''")
    text = text.replace('["block", "shaft"]', f"['block', '''{NASTY}''']")
    text = text.replace('type = "revolute"', 'type = "prismatic"')
    text += "\n[[assume]]\nbetween = ['block', '''" + NASTY + "''']\ntype = 'revolute'\n"
    text += "axis = [0.883022222, -0.321393805, 0.342020143]\npoint = [-60, 15, 200]\n"
    text += "reason = '</script><i>because</i> --> ]]>'\n"
    manifest = folder / "nasty.toml"
    manifest.write_text(text)
    design = stages.joints(stages.contacts(stages.import_(manifest)))
    return stages.check(stages.simulate(stages.mass(design)))


@pytest.fixture(scope="session")
def colliding(derive_design, tmp_path_factory):
    """The seeker whose gimbal runs into its housing during the scan."""
    folder = tmp_path_factory.mktemp("colliding") / "seeker"
    shutil.copytree(FIXTURES / "seeker" / "4_gimbal" / "gimbal_hits_housing", folder)
    manifest = folder / "seeker.toml"
    text = manifest.read_text()
    assert "amplitude = 30," in text
    manifest.write_text(text.replace("amplitude = 30,", "amplitude = 34,"))
    return derive_design(manifest)


@pytest.fixture(scope="session")
def page_of():
    """The page of a design, made once with pictures of a size."""
    known = {}

    def made(design):
        key = id(design), pictures.OVERVIEW_WIDTH
        if key not in known:
            known[key] = design, page_html(design)
        return known[key][1]

    return made


@pytest.fixture(scope="session")
def browser():
    """A browser for all tests."""
    if program() is None:
        pytest.skip("no Chromium: the page is not opened in a browser")
    opened = Browser()
    yield opened
    opened.close()
