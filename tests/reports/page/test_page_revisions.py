"""The page of two revisions: before and after in one view, the cause beside it."""

from __future__ import annotations

import re

import pytest
from generators.solids import box
from support.manifests import manifest
from support.markup import read
from support.validators import npm
from support.view import drawn

from kinform import results
from kinform_cli.main import main

pytestmark = pytest.mark.usefixtures("small_pictures")

STATE = "window.kinformViewer.state"


@pytest.fixture(scope="module")
def revisions(derive_design, tmp_path_factory):
    """Results of a block beside a post, before and after: the block moved, the post is longer, a cap is new, a peg is
    gone; and the page."""
    folder = tmp_path_factory.mktemp("revisions")
    post, block = box(-5, 5, -5, 5, 0, 60), box(20, 60, -20, 20, 0, 60)
    sides = {
        "before": {"post": post, "block": block, "peg": box(-30, -20, -5, 5, 0, 20)},
        "after": {
            "post": box(-5, 5, -5, 5, 0, 66),
            "block": box(40, 80, -20, 20, 0, 60),
            "cap": box(-5, 5, 20, 30, 0, 9),
        },
    }
    for name, parts in sides.items():
        (folder / name).mkdir()
        results.write(derive_design(manifest(folder / name, parts, "")), folder / f"{name}.h5")
    files = [str(folder / f"{name}.h5") for name in sides]
    assert main(["diff", *files, "--report", str(folder / "d.html")]) == 1
    return folder / "d.html"


def test_the_page_names_what_was_done_first_and_colours_it(revisions):
    text = revisions.read_text(encoding="utf-8")
    titles = [" ".join(t.split()) for t in re.findall(r"<h3>(?:<button[^>]*>)?([^<]+)", text)]
    assert titles[0].split()[0] == "block" and "20" in titles[0].split()
    assert any(title.split()[0] == "post" and "+10" in title.split() for title in titles)
    assert {"cap", "peg"} <= {title.split()[0] for title in titles}
    scene = read(text).scene
    whens = {part["name"]: part["when"] for part in scene["parts"]}
    assert whens == {"post": "after", "post (before)": "before", "block": "", "cap": "after", "peg": "before"}
    assert len({body["colour"] for body in scene["bodies"]}) == 5


@pytest.mark.slow
def test_the_slider_goes_from_before_to_after(browser, revisions):
    browser.said.clear()
    browser.open(revisions)
    shown = f"{STATE}.scene.parts.filter((p, k) => {STATE}.look(k) !== 'hidden').map((p) => p.name)"
    at = f"{STATE}.models[{STATE}.scene.parts.findIndex((p) => p.name === 'block')][12]"

    def go(share):
        browser.run(f"window.kinformViewer.go({share})")
        image = drawn(browser)
        assert browser.run(f"{STATE}.camera.sees({STATE}.extent([]))")
        return set(browser.run(shown)), browser.run(at), image

    old, start, first = go(0)
    assert old == {"post (before)", "block", "peg"}
    assert start == pytest.approx(-0.02, abs=1e-6)
    assert go(0.5)[1] == pytest.approx(-0.01, abs=1e-6)
    new, end, last = go(1)
    assert new == {"post", "block", "cap"}
    assert end == pytest.approx(0.0, abs=1e-6)
    assert abs(first.astype(int) - last).mean() > 1
    assert browser.said == []


@pytest.mark.slow
def test_the_page_of_revisions_is_accessible(browser, revisions):
    program = (npm("axe-core") / "axe.min.js").read_text(encoding="utf-8")
    browser.open(revisions)
    browser.run(program + "; 1")
    found = browser.run(
        "axe.run().then((r) => r.violations.filter((v) => ['serious', 'critical'].includes(v.impact)).map((v) => v.id))"
    )
    assert found == []
