"""The page in a real browser: it draws, answers to pointer and keys, moves, prints, and is accessible."""

from __future__ import annotations

import base64
import shutil
import tomllib

import numpy as np
import pytest
from support.browser import Browser, program
from support.diagonal import first_rows
from support.places import FIXTURES
from support.validators import npm
from support.view import drawn, inside, layer, press

pytestmark = pytest.mark.usefixtures("small_pictures")


@pytest.fixture(scope="module")
def seeker(derive_design, page_of, tmp_path_factory):
    """The page of the two-axis seeker, as a file."""
    path = tmp_path_factory.mktemp("page") / "seeker.html"
    design = derive_design(FIXTURES / "seekers" / "seeker_2dof" / "seeker_2dof.toml")
    path.write_text(page_of(design), encoding="utf-8")
    return path


@pytest.fixture(scope="module")
def overlaps(derive_design, page_of, tmp_path_factory):
    """The page of a seeker whose gimbal reaches into the housing."""
    path = tmp_path_factory.mktemp("page") / "overlaps.html"
    design = derive_design(FIXTURES / "broken" / "seeker_gimbal_overlaps" / "seeker_gimbal_overlaps.toml")
    path.write_text(page_of(design), encoding="utf-8")
    return path


@pytest.fixture(scope="module")
def collisions(colliding, page_of, tmp_path_factory):
    """The page of a seeker whose gimbal runs into the housing."""
    path = tmp_path_factory.mktemp("page") / "collisions.html"
    path.write_text(page_of(colliding), encoding="utf-8")
    return path


@pytest.fixture
def shown(browser, seeker):
    """The seeker, freshly opened."""
    browser.said.clear()
    browser.open(seeker)
    browser.settle()
    yield browser
    assert browser.said == []
    assert browser.run("document.body.dataset.fault") is None


def chosen(browser):
    """What the page says is chosen."""
    return browser.run("document.getElementById('chosen').textContent")


def test_the_viewer_starts_and_draws_parts_in_several_colours(shown):
    assert shown.run("document.body.dataset.viewer") == "ready"
    image = drawn(shown)
    back = image[2, 2]
    covered = (np.abs(image - back).sum(axis=2) > 30).mean()
    assert 0.1 < covered < 0.9
    assert len(np.unique(image.reshape(-1, 3) // 32, axis=0)) > 12


def test_a_click_chooses_the_part_that_is_there(shown):
    layer(shown, "joints", False)
    names = shown.run("[...document.querySelectorAll('[data-hides]')].map((box) => box.getAttribute('aria-label'))")
    others = [k for k, name in enumerate(names) if name != "Show pitch_motor/stator"]
    for k in others:
        shown.run(f"document.querySelectorAll('[data-hides]')[{k}].click()")
    press(shown, "#fit")
    shown.click(*inside(shown, "#stage"))
    assert chosen(shown) == "Part pitch_motor/stator, of body outer"
    assert (
        shown.run(
            "document.querySelector('#panel-parts [data-chosen] , #panel-parts button[aria-current]').textContent"
        )
        is not None
    )
    shown.click(*inside(shown, "#stage", 0.02, 0.02))
    assert chosen(shown) == "Nothing is chosen"
    press(shown, "#show-all")
    assert shown.run("[...document.querySelectorAll('[data-hides]')].every((box) => box.checked)")


@pytest.mark.slow
def test_the_pointer_names_what_it_is_over_turns_and_zooms(shown):
    before = drawn(shown)
    x, y = inside(shown, "#stage")
    shown.mouse("mouseMoved", x, y)
    shown.settle()
    assert not shown.run("document.getElementById('tip').hidden")
    assert shown.run("document.getElementById('tip').textContent")
    shown.drag(x - 100, y - 60, x + 60, y - 40)
    turned = drawn(shown)
    assert np.abs(turned - before).mean() > 2
    shown.click(*inside(shown, "#stage", 0.02, 0.02))
    shown.mouse("mouseWheel", x, y, deltaX=0, deltaY=-240)
    assert np.abs(drawn(shown) - turned).mean() > 2


@pytest.mark.slow
def test_keys_turn_choose_explode_and_let_go(shown):
    shown.run("document.getElementById('stage').focus()")
    before = drawn(shown)
    shown.key("ArrowLeft")
    turned = drawn(shown)
    assert np.abs(turned - before).mean() > 0.5
    shown.key("p")
    assert "camera" in chosen(shown)
    shown.key("j")
    assert all(name in chosen(shown) for name in ("yaw, yaw_motor/spin, base~outer", "revolute"))
    shown.key("Escape")
    assert chosen(shown) == "Nothing is chosen"
    shown.key("e")
    assert shown.run("document.getElementById('explode').value") == "60"
    assert np.abs(drawn(shown) - turned).mean() > 2


@pytest.mark.slow
def test_the_slider_moves_the_assembly_and_the_cursors_of_the_curves(shown):
    layer(shown, "joints", False)
    assert shown.run("document.getElementById('motion').selectedOptions[0].textContent") == "Simulated motion (dynamic)"
    before = drawn(shown)
    shown.run(
        "(() => { const time = document.getElementById('time'); time.value = 250; "
        "time.dispatchEvent(new Event('input')); })()"
    )
    assert np.abs(drawn(shown) - before).mean() > 0.3
    assert shown.run("document.getElementById('clock').textContent") == "0.50 s"
    at = shown.run("document.querySelector('svg[data-from] .cursor').getAttribute('transform')")
    left, right = (
        float(shown.run(f"document.querySelector('svg[data-from]').dataset.{end}")) for end in ("left", "right")
    )
    assert float(at.split("(")[1].split()[0]) == pytest.approx(left + 0.25 * (right - left), abs=0.1)
    shown.run(
        "(() => { const time = document.getElementById('time'); time.value = 0; "
        "time.dispatchEvent(new Event('input')); })()"
    )
    assert np.abs(drawn(shown) - before).max() <= 2


@pytest.mark.slow
def test_play_runs_and_stops_and_freedoms_go_to_and_fro(shown):
    press(shown, "#play")
    shown.until("Number(document.getElementById('time').value) > 20")
    press(shown, "#play")
    assert shown.run("document.getElementById('play').getAttribute('aria-pressed')") == "false"
    at = shown.run("document.getElementById('time').value")
    shown.settle()
    assert shown.run("document.getElementById('time').value") == at
    options = shown.run("[...document.getElementById('motion').options].map((option) => option.textContent)")
    assert options[2:] == ["Freedom: yaw (turn)", "Freedom: pitch (turn)"]
    shown.run(
        "(() => { const m = document.getElementById('motion'); m.value = '1'; "
        "m.dispatchEvent(new Event('change')); })()"
    )
    shown.until("Number(document.getElementById('time').value) > 900")
    shown.until("Number(document.getElementById('time').value) < 100")
    press(shown, "#play")


@pytest.mark.slow
def test_the_graph_and_the_view_are_linked_both_ways(shown):
    press(shown, "#graph .link")
    assert chosen(shown).startswith("Joint ")
    focus = drawn(shown)
    press(shown, "#graph .node")
    assert chosen(shown).startswith("Body ")
    assert np.abs(drawn(shown) - focus).mean() > 0.5
    press(shown, "#joint-1 > summary")
    press(shown, "#joint-1 [data-joint='1']")
    assert shown.run("document.querySelector('#graph [data-chosen]') !== null")
    assert shown.run("[...document.querySelectorAll('#graph .link[data-chosen]')].map((g) => g.dataset.joint)") == ["1"]


@pytest.mark.slow
def test_contact_patches_are_coloured_by_their_fit(shown):
    layer(shown, "joints", False)
    layer(shown, "xray", True)
    before = drawn(shown)
    assert shown.run("document.getElementById('fits').hidden")
    layer(shown, "contacts", True)
    assert not shown.run("document.getElementById('fits').hidden")
    after = drawn(shown).astype(int)
    assert np.abs(after - before).mean() > 0.05
    blue = (after[..., 2] - after[..., 0] > 60) & (np.abs(after - before).sum(axis=2) > 40)
    assert blue.sum() > 10


def test_an_overlap_is_red_and_its_finding_leads_to_it(browser, overlaps):
    browser.said.clear()
    browser.open(overlaps)

    def red():
        image = drawn(browser).astype(int)
        return (
            (image[..., 0] > 90) & (image[..., 0] > 1.8 * image[..., 1]) & (image[..., 0] > 1.8 * image[..., 2])
        ).sum()

    layer(browser, "joints", False)
    layer(browser, "overlaps", False)
    press(browser, "button[data-finding]")
    assert chosen(browser) == "Finding KF201: housing, outer_gimbal"
    without = red()
    layer(browser, "overlaps", True)
    assert red() > without + 20
    assert browser.said == []


def reds(browser):
    """Pixels of the canvas that are as red as what collides."""
    image = drawn(browser).astype(int)
    r, g, b = (image[..., k] for k in range(3))
    return ((r > 1.35 * g) & (r > 1.35 * b)).sum()


@pytest.mark.slow
def test_collisions_are_marked_on_the_slider_and_in_the_view(browser, collisions, colliding):
    (found,) = colliding.simulation.collisions
    browser.said.clear()
    browser.open(collisions)
    layer(browser, "joints", False)
    before = reds(browser)
    (tick,) = browser.run("[...document.querySelectorAll('#marks .collision')].map((m) => [m.title, m.style.left])")
    assert "housing" in tick[0] and "outer_gimbal" in tick[0]
    assert float(tick[1].rstrip("%")) == pytest.approx(100 * found.time / 2.0, abs=0.01)
    assert browser.run("document.getElementById('spots').children.length") == 0
    press(browser, "#mark-list .collision")
    assert browser.run("document.getElementById('clock').textContent") == f"{found.time:.2f} s"
    spots = browser.run("document.getElementById('spots').textContent")
    assert "housing" in spots and "outer_gimbal" in spots
    assert reds(browser) > before + 200
    browser.run("document.getElementById('time').focus()")
    browser.key("Home")
    browser.settle()
    assert browser.run("document.getElementById('clock').textContent") == "0.00 s"
    assert reds(browser) == before
    assert browser.run("document.querySelectorAll('.plot line.event').length") > 0
    browser.run("document.querySelector('#mark-list .collision').focus()")
    browser.key(" ")
    assert browser.run("document.getElementById('clock').textContent") == f"{found.time:.2f} s"
    assert browser.said == []


@pytest.mark.slow
def test_a_finding_of_parts_that_meet_is_shown_where_they_do(browser, collisions, colliding):
    browser.open(collisions)
    codes = [finding.code for finding in colliding.report.findings]

    def show(code):
        browser.run(f"document.querySelector('button[data-finding=\"{codes.index(code)}\"]').click()")
        browser.settle()

    show("KF412")
    clock = browser.run("document.getElementById('clock').textContent")
    lower = np.degrees(colliding.simulation.ranges[0].lower.value)
    assert clock == f"{lower:.1f}°"
    spots = browser.run("document.getElementById('spots').textContent")
    assert "housing" in spots and "outer_gimbal" in spots
    show("KF505")
    assert browser.run("document.getElementById('motion').selectedOptions[0].textContent").startswith(
        "Simulated motion"
    )
    show("KF207")
    assert browser.run("document.getElementById('spots').children.length") == 0


def test_names_that_are_programs_do_nothing(browser, nasty, page_of, tmp_path):
    path = tmp_path / "nasty.html"
    path.write_text(page_of(nasty), encoding="utf-8")
    browser.said.clear()
    browser.open(path)
    browser.run("document.querySelectorAll('details').forEach((d) => { d.open = true; })")
    for selector in ("[data-part='0']", "[data-part='1']", "[data-joint='0']", "#graph .node", "#graph .link"):
        browser.run(f"document.querySelector({selector!r}).dispatchEvent(new MouseEvent('click', {{bubbles: true}}))")
    browser.settle()
    assert browser.run("document.title").startswith("<h1>x<h1>: ")
    assert browser.run("document.querySelectorAll('img[src=x], i, b, script:not([id]):not(:last-of-type)').length") == 0
    assert browser.run("document.body.dataset.viewer") == "ready"
    assert browser.said == []


@pytest.mark.slow
def test_the_page_prints_dark_on_white_without_its_controls(shown):
    dark = [{"name": "prefers-color-scheme", "value": "dark"}]
    shown.ask("Emulation.setEmulatedMedia", media="print", features=dark)
    shown.settle()
    hidden = (
        "['.tools', '.motion', '#theme'].every((s) => getComputedStyle(document.querySelector(s)).display === 'none')"
    )
    assert shown.run(hidden)
    assert shown.run("getComputedStyle(document.body).backgroundColor") == "rgb(255, 255, 255)"
    assert drawn(shown)[2, 2].tolist() == [255, 255, 255]
    data = base64.b64decode(shown.ask("Page.printToPDF", printBackground=True)["data"])
    shown.ask("Emulation.setEmulatedMedia", media="", features=[])
    assert data.startswith(b"%PDF")
    assert len(data) > 20_000


def test_without_webgl_the_picture_stays_and_the_page_says_why(browser, seeker):
    browser.said.clear()
    script = browser.ask(
        "Page.addScriptToEvaluateOnNewDocument", source="HTMLCanvasElement.prototype.getContext = () => null;"
    )
    browser.open(seeker)
    browser.ask("Page.removeScriptToEvaluateOnNewDocument", **script)
    assert browser.run("document.body.dataset.viewer") == "none"
    assert browser.run("document.getElementById('viewer-fault').textContent").strip()
    assert browser.run(
        "(() => { const image = document.querySelector('.stand-in'); "
        "return image.naturalWidth > 0 && getComputedStyle(image).display !== 'none'; })()"
    )
    assert browser.said == []


@pytest.mark.slow
@pytest.mark.parametrize("which", ["overlaps", "collisions"])
@pytest.mark.parametrize("dark", [False, True], ids=["light", "dark"])
def test_the_page_is_accessible(browser, request, which, dark):
    program = (npm("axe-core") / "axe.min.js").read_text(encoding="utf-8")
    browser.dark(dark)
    browser.open(request.getfixturevalue(which))
    for mark in ("#mark-list button", "#graph .link"):
        browser.run(f"document.querySelector({mark!r})?.dispatchEvent(new MouseEvent('click', {{bubbles: true}}))")
    browser.run("document.querySelectorAll('details').forEach((d) => { d.open = true; })")
    for width, height in ((1440, 900), (390, 844)):
        browser.resize(width, height)
        browser.run("document.querySelector('button[data-finding]').click()")
        browser.run(program + "; 1")
        found = browser.run(
            "axe.run().then((r) => r.violations.filter((v) => ['serious', 'critical'].includes(v.impact))"
            ".map((v) => [v.id, v.nodes.map((n) => n.html.slice(0, 160))]))"
        )
        assert found == []
        assert browser.run("document.documentElement.scrollWidth") == width
    browser.resize(1280, 900)
    browser.dark(False)


@pytest.mark.slow
@pytest.mark.parametrize(("width", "height"), first_rows(1, [(390, 844), (1440, 900)]))
def test_proposed_joints_move_what_they_would_and_their_toml_is_copied(derive_design, page_of, tmp_path, width, height):
    """A collared shaft without function: its slider turns it, to the angle that is said; its table can be read back."""
    source = FIXTURES / "pairs" / "revolute_collars"
    for mesh in source.glob("*.stl"):
        shutil.copy(mesh, tmp_path)
    text = (source / "revolute_collars.toml").read_text()
    (tmp_path / "bare.toml").write_text(text[: text.index("[function]")])
    (tmp_path / "bare.html").write_text(page_of(derive_design(tmp_path / "bare.toml")), encoding="utf-8")
    if program() is None:
        pytest.skip("no Chromium here")
    page = Browser(width, height)
    try:
        page.open(tmp_path / "bare.html")
        page.settle()
        assert page.run("document.querySelectorAll('.proposed').length") == 1
        assert page.run("document.documentElement.scrollWidth") == width
        page.run(
            "(() => { const s = document.querySelector('[data-proposes]'); s.value = '1000';"
            " s.dispatchEvent(new Event('input', { bubbles: true })); })()"
        )
        page.settle()
        assert page.run("document.querySelector('.proposed output').textContent") == "28.0°"
        state = "window.kinformViewer.state"
        turned = page.run(f"{state}.shown.map((pose) => Math.max(...pose.map((x, k) => Math.abs(x - (k % 5 === 0)))))")
        assert sorted(angle > 0.1 for angle in turned) == [False, True]
        assert page.run(f"{state}.scene.joints.map((_, k) => {state}.jointHidden(k))") == [False]  # what it moves
        page.run(f"{state}.motion.moving = []")
        assert page.run(f"{state}.scene.joints.map((_, k) => {state}.jointHidden(k))") == [True]
        table = tomllib.loads(page.run("document.querySelector('[data-toml=all]').textContent"))["function"]
        assert table["complete"] is True
        (joint,) = table["joint"]
        assert joint["type"] == "revolute"
        assert abs(np.dot(joint["axis"], [0.883022222, -0.321393805, 0.342020143])) > 0.9999
        page.run("navigator.clipboard.writeText = (text) => { window.copied = text; return Promise.resolve(); }")
        page.run("document.querySelector('button[data-copies=all]').click()")
        page.settle()
        assert tomllib.loads(page.run("window.copied"))["function"] == table
        assert "Copied" in page.run("document.getElementById('copied').textContent")
        assert page.said == []
    finally:
        page.close()
