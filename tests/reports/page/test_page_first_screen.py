"""The first screen of the page in a real browser: verdict and findings beside the view, which follows the clicks."""

from __future__ import annotations

import numpy as np
import pytest
import trimesh
from support.places import FIXTURES
from support.view import drawn, layer, press

from kinform.reports.page import page_html

STATE = "window.kinformViewer.state"
FRONT = f"{STATE}.scene.parts.findIndex((part) => part.name === 'front')"


def put(browser, control, value, event="input"):
    """Give a control a value, as a user does."""
    browser.run(
        f"(() => {{ const e = document.getElementById({control!r}); e.value = '{value}'; "
        f"e.dispatchEvent(new Event({event!r})); }})()"
    )
    browser.settle()


def page(folder, name, text):
    """The text as a file."""
    path = folder / f"{name}.html"
    path.write_text(text, encoding="utf-8")
    return path


@pytest.fixture(scope="module")
def overlaps(derive_design, page_of, tmp_path_factory):
    """The page of a seeker whose gimbal reaches into the housing."""
    design = derive_design(FIXTURES / "broken" / "seeker_gimbal_overlaps" / "seeker_gimbal_overlaps.toml")
    return page(tmp_path_factory.mktemp("first"), "overlaps", page_of(design))


@pytest.fixture(scope="module")
def crossing(derive_design, tmp_path_factory):
    """Two pairs of boxes that reach into each other, and a thin plate that hides a smaller one just behind it."""
    folder = tmp_path_factory.mktemp("crossing")
    boxes = {
        "a1": ([20, 20, 20], [0, 100, 0]), "a2": ([20, 20, 20], [15, 100, 0]),
        "b1": ([20, 20, 20], [0, 200, 0]), "b2": ([20, 20, 20], [15, 203, 4]),
        "front": ([100, 2, 100], [0, 0, 0]), "behind": ([60, 1, 60], [0, 1.8, 0]),
    }  # fmt: skip
    text = 'schema = 1\n[assembly]\nname = "crossing"\nunits = "mm"\n'
    for name, (extents, place) in boxes.items():
        trimesh.creation.box(extents=extents).export(folder / f"{name}.stl")
        text += f'[[part]]\nname = "{name}"\nmesh = "{name}.stl"\nposition = {place}\n'
    (folder / "crossing.toml").write_text(text)
    design = derive_design(folder / "crossing.toml")
    return page(folder, "crossing", page_html(design)), design


def box(browser, selector):
    """Left, top, right, bottom of an element in the window (px)."""
    return browser.run(
        f"(() => {{ const b = document.querySelector({selector!r}).getBoundingClientRect(); "
        "return [b.left, b.top, b.right, b.bottom]; })()"
    )


def test_verdict_worst_finding_and_the_view_share_the_first_screen(browser, overlaps):
    browser.resize(1440, 900)
    browser.open(overlaps)
    left, top, right, bottom = box(browser, "#view")
    assert (top, right, bottom) == (0, 1440, 900)
    assert left < 720
    for selector in ("#verdict", ".finding.error h3"):
        _, high, end, low = box(browser, selector)
        assert 0 <= high < low <= 900
        assert end <= left
    browser.run("document.querySelectorAll('details').forEach((d) => { d.open = true; })")
    browser.run("scrollTo({top: 700, behavior: 'instant'})")
    browser.settle()
    assert browser.run("scrollY") == 700
    assert box(browser, "#view")[1::2] == [0, 900]
    browser.resize(1280, 900)


@pytest.mark.slow
def test_a_narrow_window_has_the_view_second_and_the_findings_third(browser, overlaps):
    browser.resize(390, 844)
    browser.open(overlaps)
    tops = [box(browser, selector)[1] for selector in ("#verdict", "#stage", "#findings")]
    assert tops == sorted(tops)
    assert box(browser, "#stage")[3] <= 844
    browser.run("document.querySelector('#findings button[data-finding]').scrollIntoView({behavior: 'instant'})")
    browser.run("document.querySelector('#findings button[data-finding]').click()")
    browser.until("document.getElementById('stage').getBoundingClientRect().top >= 0")
    browser.resize(1280, 900)


@pytest.mark.slow
def test_a_finding_is_seen_as_in_its_picture_with_its_own_marks_alone(browser, crossing):
    path, design = crossing
    found = [k for k, f in enumerate(design.report.findings) if f.code == "KF201"]
    assert {frozenset(f.subject) for f in design.report.singles if f.code == "KF201"} == {
        frozenset(("a1", "a2")),
        frozenset(("b1", "b2")),
    }
    assert [set(design.report.findings[k].subject) for k in found] == [{"a1", "a2"}]  # the same shapes: one cause
    browser.open(path)
    browser.run(f"{STATE}.camera.orbit(1, 0.2)")
    for k in found:
        press(browser, f"button[data-finding='{k}']")
        own = set(design.report.findings[k].subject)
        shown = browser.run(f"{STATE}.scene.overlaps.filter((o) => !{STATE}.overlapHidden(o)).map((o) => o.parts)")
        assert [set(parts) for parts in shown] == [own]
        assert browser.run(f"[{STATE}.camera.turn, {STATE}.camera.rise]") == [-0.95, 0.42]
        plain = browser.run(f"{STATE}.scene.parts.filter((p, n) => {STATE}.look(n) === 'plain').map((p) => p.name)")
        assert set(plain) == own
        assert browser.run(f"{STATE}.spots.length") == 1


def test_edges_do_not_shine_through_what_is_before_them(browser, crossing):
    path, _ = crossing
    browser.open(path)
    layer(browser, "joints", False)
    layer(browser, "overlaps", False)
    browser.run(f"{STATE}.camera.from('front'); {STATE}.fit([{FRONT}]); {STATE}.camera.zoom(1.3)")
    browser.run("window.kinformViewer.redraw()")
    with_edges = drawn(browser).astype(int)
    layer(browser, "edges", False)
    without = drawn(browser).astype(int)
    rows, columns = np.nonzero(np.abs(with_edges - without).sum(axis=2) > 12)
    # the outline of the plate is drawn; nothing is between it and the middle
    assert len(rows) > 50
    middle = (abs(rows - 50) < 0.8 * abs(rows - 50).max()) & (abs(columns - 80) < 0.8 * abs(columns - 80).max())
    assert not middle.any()


@pytest.mark.slow
def test_all_stays_in_the_picture_while_it_moves_and_comes_apart(browser, derive_design, page_of, tmp_path):
    design = derive_design(FIXTURES / "mechanisms" / "four_bar" / "four_bar.toml")
    browser.open(page(tmp_path, "four_bar", page_of(design)))
    count = browser.run("document.getElementById('motion').options.length - 1")
    assert count >= 1
    for motion in range(count):
        browser.run(f"window.kinformViewer.pickMotion({motion}, false)")
        for share in (0, 0.5, 1):
            put(browser, "explode", 100 * share)
            for time in (0, 200, 500, 800, 1000):
                put(browser, "time", time)
                assert browser.run(f"{STATE}.camera.sees({STATE}.extent([]))"), (motion, share, time)


@pytest.mark.slow
def test_loops_stay_closed_wherever_the_slider_is(browser, derive_design, page_of, tmp_path):
    design = derive_design(FIXTURES / "mechanisms" / "four_bar" / "four_bar.toml")
    browser.open(page(tmp_path, "four_bar", page_of(design)))
    gaps = browser.run(
        f"""(() => {{
          const {{ scene, motions }} = {STATE};
          const at = (m, p) => [0, 1, 2].map((r) => m[r] * p[0] + m[4 + r] * p[1] + m[8 + r] * p[2] + m[12 + r]);
          const apart = (a, b) => Math.hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]);
          return motions.map((motion) => [0.9 * motion.start, motion.start, motion.end].map((time) => {{
            const poses = motion.at(time);
            const ends = (j) => j.bodies.map((body) => at(poses[body], j.point));
            const open = scene.joints.map((j) => apart(...ends(j)));
            const gone = scene.joints.map((j) => apart(at(poses[j.bodies[0]], j.point), j.point));
            return [Math.max(...open), Math.max(...gone)];
          }}));
        }})()"""
    )
    size = float(np.ptp([joint.point for joint in design.kinematics.joints], axis=0).max())
    assert max(open for ends in gaps for open, _ in ends) < 1e-3 * size
    assert max(gone for ends in gaps for _, gone in ends) > 0.1 * size


@pytest.mark.slow
def test_the_slider_says_what_it_moves(browser, overlaps, derive_design, page_of, tmp_path):
    labels = {}
    for name in ("seekers/seeker_2dof/seeker_2dof", "pairs/prismatic_drawer/prismatic_drawer"):
        manifest = FIXTURES / f"{name}.toml"
        browser.open(page(tmp_path, manifest.stem, page_of(derive_design(manifest))))
        for k, motion in enumerate(browser.run(f"{STATE}.motions.map((m) => m.name)")):
            browser.run(f"window.kinformViewer.pickMotion({k}, false); window.kinformViewer.go({STATE}.motion.end)")
            labels[motion] = (
                browser.run("document.getElementById('moved').textContent"),
                browser.run("document.getElementById('clock').textContent").split()[-1][-2:],
            )
    for motion, (label, unit) in labels.items():
        kind = "time" if motion.startswith("Simulated") else "angle" if motion.endswith("(turn)") else "travel"
        assert label == kind
        assert {"time": unit.endswith("s"), "angle": unit.endswith("°"), "travel": unit in ("mm", "m")}[kind], unit
    assert {label for label, _ in labels.values()} == {"time", "angle", "travel"}


@pytest.mark.slow
def test_a_cut_takes_away_the_near_side_and_what_is_behind_can_be_picked(browser, crossing):
    path, _ = crossing
    browser.open(path)
    layer(browser, "joints", False)
    layer(browser, "overlaps", False)
    browser.run(f"{STATE}.camera.from('front')")
    name = "(() => { const v = window.kinformViewer; const c = v.canvas; v.paint(); " + (
        "const p = v.renderer.pick(v.state, c.clientWidth / 2, c.clientHeight / 2); "
        "return p?.part === undefined ? null : v.state.scene.parts[p.part].name; })()"
    )
    browser.run(f"{STATE}.fit([{FRONT}])")
    assert browser.run(name) == "front"
    before = drawn(browser).astype(int)
    browser.run(
        "(() => { const c = document.getElementById('cut'); c.value = '1'; c.dispatchEvent(new Event('change')); })()"
    )
    # the cut is in the middle of the assembly: both plates are on the near side
    assert browser.run(name) not in ("front", "behind")
    assert np.abs(drawn(browser) - before).mean() > 2
    press(browser, "#cut-flip")
    assert browser.run(name) == "front"
    assert np.abs(drawn(browser) - before)[40:60, 70:90].max() < 30


@pytest.mark.slow
def test_the_triad_turns_with_the_view(browser, overlaps):
    browser.open(overlaps)
    browser.run(f"{STATE}.camera.from('front'); window.kinformViewer.redraw()")
    browser.settle()
    ends = browser.run(
        "[...document.querySelectorAll('#triad line')].map((l) => ['x2', 'y2'].map((n) => Number(l.getAttribute(n))))"
    )
    assert ends[0] == pytest.approx([21, 0], abs=0.1)
    assert ends[1] == pytest.approx([0, 0], abs=0.1)
    assert ends[2] == pytest.approx([0, -21], abs=0.1)
