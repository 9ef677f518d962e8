"""What the documentation shows is what the program prints."""

from __future__ import annotations

import importlib.util
import re
import shutil

import numpy as np
import pytest
from support.places import ROOT
from support.png import pixels

from kinform.consistency import rules_markdown
from kinform.reports.page.raster import png


@pytest.fixture(scope="module")
def generate():
    """The module that writes what the documentation shows."""
    spec = importlib.util.spec_from_file_location("docs_generate", ROOT / "docs" / "generate.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


@pytest.mark.slow
def test_the_demo_in_the_readme_is_what_the_demo_prints(generate, tmp_path):
    if shutil.which("make") is None:
        pytest.skip("needs make")
    text = (ROOT / "README.md").read_text(encoding="utf-8")
    assert "<!-- demo -->" in text
    assert generate.readme(text, tmp_path) == text, "write it again: make docs"


def test_the_first_steps_of_the_seekers_story_run_as_printed(generate, tmp_path):
    """Up to the function that is stated without meshes; the rest of the story is a slow test."""
    text = (ROOT / "docs" / "seeker.md").read_text(encoding="utf-8")
    chapters = re.split(r"^(?=## )", text, flags=re.MULTILINE)
    begun = "".join(chapters[:3])
    assert generate.story(begun, tmp_path)[0] == begun, "write it again: make docs"


@pytest.mark.slow
def test_every_step_of_the_seekers_story_runs_as_printed(generate, tmp_path):
    text = (ROOT / "docs" / "seeker.md").read_text(encoding="utf-8")
    made, pictures = generate.story(text, tmp_path)
    assert made == text, "write it again: make docs"
    assert pictures
    for name, content in pictures.items():
        kept = (ROOT / "docs" / "images" / name).read_bytes()
        assert kept == content or _alike(name, kept, content), f"{name} shows something else: make docs"
    assert sorted(p.name for p in (ROOT / "docs" / "images").iterdir()) == sorted(pictures)


def _alike(name, kept, made):
    """Whether two pictures differ no more than rounding on another processor makes them differ."""
    if not name.endswith(".png"):
        return False
    a, b = (pixels(data).astype(int) for data in (kept, made))
    return a.shape == b.shape and (np.abs(a - b).max(axis=2) > 24).mean() < 0.002


def test_pictures_that_show_something_else_are_told_apart():
    image = np.zeros((40, 60, 4), np.uint8)
    other = image.copy()
    other[10:14, 10:14] = 255
    assert _alike("a.png", png(image), png(image + np.uint8(3)))
    assert not _alike("a.png", png(image), png(other))
    assert not _alike("a.svg", b"<svg/>", b"<svg></svg>")


def test_every_moment_of_the_story_has_a_picture():
    text = (ROOT / "docs" / "seeker.md").read_text(encoding="utf-8")
    chapters = re.split(r"^## ", text, flags=re.MULTILINE)[1:]
    assert len(chapters) == 5
    shown = [re.findall(r"!\[[^\]]+\]\(images/(\S+)\)", chapter) for chapter in chapters]
    assert all(shown) and len(shown[3]) == 4
    assert sum((ROOT / "docs" / "images" / name).stat().st_size for names in shown for name in names) < 400_000


def test_the_story_goes_through_every_folder(generate):
    text = (ROOT / "docs" / "seeker.md").read_text(encoding="utf-8")
    home = ROOT / "fixtures" / "seeker"
    told = set(re.findall(r"<!-- in (\S+) -->", text))
    moments = {p.name for p in home.iterdir()} - {"4_gimbal"} | {
        f"4_gimbal/{p.name}" for p in (home / "4_gimbal").iterdir()
    }
    assert moments <= told
    assert len({m.split("/")[0] for m in moments}) == 5


def test_a_step_that_prints_something_else_is_seen(generate, tmp_path):
    text = "<!-- in 2_function -->\n```console\n$ kinform explain KF000\nnothing\n$ echo $((1 + 1)); false\n```\n"
    made, _ = generate.story(text, tmp_path)
    assert "nothing" not in made
    assert "$ echo $((1 + 1)); false\n2\n[exit code 1]\n```\n" in made
    assert "KF000" in made and "[exit code 2]\n$ echo" in made


def test_the_page_of_rules_is_current():
    assert (ROOT / "docs" / "rules.md").read_text(encoding="utf-8") == rules_markdown()


def test_every_folder_named_in_the_architecture_is_there():
    text = (ROOT / "docs" / "architecture.md").read_text()
    for folder in re.findall(r"^\| `(\w+)/` \|", text, re.MULTILINE):
        assert any((ROOT / place / folder).is_dir() for place in ("pipeline/kinform", "cli"))


def test_every_constant_that_a_page_names_is_there():
    named = {
        name.rstrip("_")
        for page in sorted((ROOT / "docs").glob("*.md"))
        for name in re.findall(r"`([A-Z][A-Z0-9]*_[A-Z0-9_]*)\*?`", page.read_text(encoding="utf-8"))
    }
    code = "\n".join(
        path.read_text(encoding="utf-8") for root in ("pipeline", "cli") for path in sorted((ROOT / root).rglob("*.py"))
    )
    assert [
        name
        for name in sorted(named)
        if re.search(rf"\b{name}", code) is None and re.fullmatch(r"[RX]_[A-Z]+", name) is None
    ] == []


@pytest.mark.slow
def test_the_gallery_shows_the_mechanisms_as_they_are_judged(generate, derive_design):
    text, pictures = generate.gallery({path.stem: derive_design(path) for path in generate.mechanisms()})
    assert (ROOT / "docs" / "gallery.md").read_text(encoding="utf-8") == text, "write it again: make docs"
    assert len(pictures) >= 20
    for name, content in pictures.items():
        kept = (ROOT / "docs" / "gallery" / name).read_bytes()
        assert kept == content or _alike(name, kept, content), f"{name} shows something else: make docs"
    assert {path.name for path in (ROOT / "docs" / "gallery").iterdir()} == set(pictures)


def test_the_readme_opens_with_a_picture_and_three_commands():
    head = (ROOT / "README.md").read_text(encoding="utf-8").partition("\n## ")[0]
    (picture,) = re.findall(r"!\[[^\]]+\]\(([^)]+)\)", head)
    data = (ROOT / picture).read_bytes()
    assert data.startswith(b"\x89PNG")
    assert len(data) < 300_000
    commands = [line for line in head.splitlines() if line.startswith("kinform ")]
    assert [line.split()[1:3] for line in commands] == [
        ["run", "robot.urdf"],
        ["run", "arm.step"],
        ["report", "robot.urdf"],
    ]
