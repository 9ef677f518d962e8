"""`kinform report` from a shell's side: which files there are, what is refused, what is said."""

from __future__ import annotations

import pytest
from support.places import FIXTURES

from kinform import results, stages
from kinform_cli.main import main

OVERLAPS = FIXTURES / "broken" / "seeker_gimbal_overlaps" / "seeker_gimbal_overlaps.toml"


@pytest.fixture
def design_file(derive_design, tmp_path):
    """A results file with a finding."""
    results.write(derive_design(OVERLAPS), tmp_path / "a.h5")
    return tmp_path / "a.h5"


def test_a_page_pictures_and_a_summary_that_shows_them_are_written(design_file, capsys):
    folder = design_file.parent
    arguments = ["report", str(design_file), "-o", str(folder / "a.html"), "--png", str(folder / "made" / "png")]
    assert main(arguments) == 0
    text, said = capsys.readouterr()
    assert text == ""
    assert "a.html" in said
    found = {path.name: path.read_bytes() for path in (folder / "made" / "png").iterdir()}
    assert set(found) == {"overview.png", "finding-01-KF201.png", "summary.md"}
    assert all(data.startswith(b"\x89PNG") for name, data in found.items() if name.endswith(".png"))
    summary = found["summary.md"].decode()
    assert "](overview.png)" in summary
    assert "](finding-01-KF201.png)" in summary
    assert "inconsistent" in summary.splitlines()[0]


def test_a_file_without_findings_gives_a_page_and_a_warning(tmp_path, capsys):
    design = stages.import_(FIXTURES / "pairs" / "free_apart" / "free_apart.toml")
    results.write(design, tmp_path / "a.h5")
    assert main(["report", str(tmp_path / "a.h5"), "-o", str(tmp_path / "a.html")]) == 0
    assert "the rules have not been run" in capsys.readouterr().err
    assert "not verified" in (tmp_path / "a.html").read_text(encoding="utf-8")


@pytest.mark.parametrize(
    ("output", "more", "named"),
    [("a.h5", [], "a.html"), ("no/a.html", [], "does not exist"), ("a.html", ["--png", "a.h5"], "folder")],
)
def test_what_cannot_be_written_is_refused_before_the_work(design_file, capsys, output, more, named):
    folder = design_file.parent
    before = design_file.read_bytes()
    more = [str(folder / word) if not word.startswith("-") else word for word in more]
    assert main(["report", str(design_file), "-o", str(folder / output), *more]) == 2
    assert named in capsys.readouterr().err
    assert design_file.read_bytes() == before
    assert not (folder / "a.html").exists()
