"""`kinform report` from a shell's side: which files there are, what is refused, what is said."""

from __future__ import annotations

import shutil
import webbrowser

import pytest
from support.places import FIXTURES

from kinform import method, results, stages
from kinform_cli.main import main

pytestmark = pytest.mark.usefixtures("small_pictures")

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


def test_a_file_without_findings_gives_a_page_and_a_warning(tmp_path, capsys):
    design = stages.import_(FIXTURES / "pairs" / "free_apart" / "free_apart.toml")
    results.write(design, tmp_path / "a.h5")
    assert main(["report", str(tmp_path / "a.h5"), "-o", str(tmp_path / "a.html"), "--as-it-is"]) == 0
    assert capsys.readouterr().err
    assert (tmp_path / "a.html").is_file()


@pytest.mark.parametrize(("output", "more"), [("a.h5", []), ("no/a.html", []), ("a.html", ["--png", "a.h5"])])
def test_what_cannot_be_written_is_refused_before_the_work(design_file, output, more):
    folder = design_file.parent
    before = design_file.read_bytes()
    more = [str(folder / word) if not word.startswith("-") else word for word in more]
    assert main(["report", str(design_file), "-o", str(folder / output), *more]) == 2
    assert design_file.read_bytes() == before
    assert not (folder / "a.html").exists()


@pytest.mark.slow
def test_what_a_results_file_lacks_is_computed_and_not_kept(tmp_path, capsys):
    manifest = FIXTURES / "pairs" / "revolute_collars" / "revolute_collars.toml"
    design = stages.contacts(stages.import_(manifest))
    results.write(design, tmp_path / "a.h5")
    before = (tmp_path / "a.h5").read_bytes()
    assert main(["report", str(tmp_path / "a.h5"), "-o", str(tmp_path / "a.html")]) == 0
    assert capsys.readouterr().err
    assert (tmp_path / "a.h5").read_bytes() == before
    assert main(["report", str(manifest), "-o", str(tmp_path / "b.html")]) == 0
    assert (tmp_path / "b.html").read_bytes() == (tmp_path / "a.html").read_bytes()


def test_a_page_is_made_of_a_manifest_beside_it_and_opened(tmp_path, capsys, monkeypatch):
    folder = shutil.copytree(FIXTURES / "pairs" / "revolute_collars", tmp_path / "x")
    opened = []
    monkeypatch.setattr(webbrowser, "open", lambda address: opened.append(address) or True)
    assert main(["report", str(folder), "--open"]) == 0
    page = folder / "revolute_collars.html"
    assert opened == [page.as_uri()]
    assert ">consistent<" in page.read_text(encoding="utf-8").replace("</span> ", ">").replace("</p>", "<")
    assert not list(folder.glob("*.h5"))
    # one's own page is written again, and nobody else's
    assert main(["report", str(folder)]) == 0
    page.write_text("<p>mine")
    assert main(["report", str(folder)]) == 2
    assert page.name in capsys.readouterr().err
    assert page.read_text() == "<p>mine"


def test_results_beside_the_manifest_are_taken_while_they_are_of_it(tmp_path, monkeypatch):
    folder = shutil.copytree(FIXTURES / "pairs" / "revolute_collars", tmp_path / "x")
    manifest = folder / "revolute_collars.toml"
    assert main(["run", str(manifest), "-o", str(folder / "revolute_collars.h5")]) == 0
    computed, run = [], method.run
    monkeypatch.setattr(method, "run", lambda source, *a, **k: computed.append(source.name) or run(source, *a, **k))
    assert main(["report", str(manifest)]) == 0
    assert computed == []
    manifest.write_text(manifest.read_text().replace('type = "revolute"', 'type = "prismatic"'))
    assert main(["report", str(manifest)]) == 0
    assert computed == [manifest.name]
    assert "KF402" in manifest.with_suffix(".html").read_text(encoding="utf-8")


@pytest.mark.slow
def test_notes_are_pictured_where_it_is_asked_for(derive_design, tmp_path):
    design = derive_design(FIXTURES / "mechanisms" / "four_bar" / "four_bar.toml")
    assert {finding.severity for finding in design.report.findings} == {"note"}
    results.write(design, tmp_path / "a.h5")
    for more, pictures in (([], 1), (["--notes"], 1 + len(design.report.findings))):
        folder = tmp_path / f"png{len(more)}"
        assert (
            main(["report", str(tmp_path / "a.h5"), "-o", str(tmp_path / "a.html"), "--png", str(folder), *more]) == 0
        )
        assert len(list(folder.glob("*.png"))) == pictures
        summary = (folder / "summary.md").read_text(encoding="utf-8")
        assert summary.count("](finding-") == pictures - 1
        assert "KF303" in summary
