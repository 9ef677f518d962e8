"""What a person meets first: default output, folders in place of manifests, wrong names, help, suggested commands."""

from __future__ import annotations

import json
import re
import shlex
import shutil

import pytest
from support.command_line import ran_here
from support.places import FIXTURES

from kinform.consistency import RULES
from kinform_cli.app import COMMANDS, _command
from kinform_cli.options import FindingsFormat, printed
from kinform_cli.text import Lengths, wrapped

BLOCK = FIXTURES / "pairs/planar_block"


@pytest.fixture(scope="module")
def ran(tmp_path_factory):
    """A folder, with a blank in its name, that holds a design and its results."""
    folder = tmp_path_factory.mktemp("first") / "my arm"
    shutil.copytree(BLOCK, folder)
    assert ran_here("run", "planar_block.toml", "-o", "r.h5", "-q", cwd=folder).returncode == 0
    return folder


def test_by_default_the_verdict_is_the_first_line_and_v_prints_all(ran):
    brief = ran_here("check", "r.h5", cwd=ran)
    assert brief.stdout.startswith("planar_block: consistent\n")
    assert max(map(len, brief.stdout.splitlines())) <= 80
    full = ran_here("check", "r.h5", "-v", cwd=ran)
    assert full.stdout == ran_here("check", "r.h5", "-f", "full", cwd=ran).stdout != brief.stdout
    assert "KF122" in full.stdout


def test_several_formats_go_to_files_and_one_to_stdout(ran):
    asked = ("-f", "json", "-f", "sarif=s.sarif", "-f", "junit=j.xml")
    done = ran_here("check", "r.h5", *asked, cwd=ran)
    assert done.returncode == 0
    assert json.loads(done.stdout)["verdict"]
    assert json.loads((ran / "s.sarif").read_text())["version"] == "2.1.0"
    assert (ran / "j.xml").read_text() == ran_here("check", "r.h5", "-f", "junit", cwd=ran).stdout


@pytest.mark.parametrize(
    ("asked", "told"),
    [
        (("-f", "sarf"), "sarif"),
        (("-f", "json="), "--format"),
        (("-f", "json", "-f", "md"), "--format"),
        (("-v", "-f", "md"), "--format"),
        (("-f", "json=a", "-f", "md=a"), "--format"),
        (("-f", "json=r.h5",), "r.h5"),
        (("-f", "json=nowhere/a b/a.json",), "mkdir -p 'nowhere/a b'\n"),
        (("-f", "json=r.h5/a/a.json",), "r.h5"),
        (("-o", "r.h5/a/b.h5"), "r.h5"),
    ],
)  # fmt: skip
def test_formats_that_cannot_be_are_refused_before_the_work(asked, told, ran):
    before = (ran / "r.h5").read_bytes()
    done = ran_here("check", "r.h5", *asked, cwd=ran)
    assert done.returncode == 2 and done.stdout == ""
    assert told in done.stderr
    assert (ran / "r.h5").read_bytes() == before


def test_every_format_has_its_word():
    for format in FindingsFormat:
        assert printed([format.value]).format is format


def test_a_folder_stands_for_the_manifest_in_it(ran, tmp_path):
    assert ran_here(".", "-q", cwd=ran).stdout == ran_here("run", "planar_block.toml", "-q", cwd=ran).stdout
    empty = ran_here(".", cwd=tmp_path)
    assert empty.returncode == 2 and "error:" in empty.stderr
    for name in ("a.toml", "b.toml"):
        shutil.copy(ran / "planar_block.toml", tmp_path / name)
    (tmp_path / "other.toml").write_text("[tool]\nname = 1\n")
    several = ran_here("run", tmp_path, cwd=ran)
    assert several.returncode == 2 and "a.toml, b.toml" in several.stderr and "other" not in several.stderr


def test_suggested_commands_are_read_by_a_shell_as_they_are(ran):
    done = ran_here("run", "planar_block.toml", "-o", "the results.h5", cwd=ran)
    line = next(line for line in done.stderr.splitlines() if line.startswith("next: "))
    words = shlex.split(line.removeprefix("next: ").split("   (")[0])
    assert words == ["kinform", "report", "the results.h5", "-o", "the results.html"]
    assert ran_here(*words[1:], cwd=ran).returncode == 0


@pytest.mark.parametrize(
    ("arguments", "told"),
    [
        (("chek", "r.h5"), "check"),
        (("catalog", "fnd"), "find"),
        (("show", "r.h5", "joints", "--joint", "block~tabel"), '"block~table"'),
        (("query", "r.h5", "blok", "table", "--slide", "x"), '"block"'),
        (("explain", "KF2011"), "KF201"),
        (("explain", "joint-wrong-typ"), "KF402 joint-wrong-type"),
    ],
)
def test_a_wrong_name_is_answered_with_the_one_that_was_meant(arguments, told, ran):
    done = ran_here(*arguments, cwd=ran)
    assert done.returncode == 2
    assert told in done.stderr


def test_the_beginning_of_a_code_lists_its_rules(ran):
    listed = ran_here("explain", "kf4", cwd=ran).stdout.split("\n")
    assert [line.split()[0] for line in listed if line] == [r.code for r in RULES if r.code.startswith("KF4")]


def test_what_is_explained_fits_the_terminal_and_loses_no_word(ran):
    for rule in RULES[::8]:
        text = ran_here("explain", rule.code, cwd=ran).stdout
        assert max(map(len, text.splitlines())) <= 80
        assert rule.documentation.split() == text.split("\n", 1)[1].split()


def test_lines_that_are_too_long_are_broken_and_lists_stay_lists():
    text = "one two three\nfour five\n\n- six seven\n- eight\n"
    assert wrapped(text, 80) == text
    assert wrapped(text, 10) == "one two\nthree four\nfive\n\n- six\nseven\n- eight\n"


def every_command():
    for name in COMMANDS:
        command = _command(name)
        yield (name,), command
        for below in getattr(command, "commands", {}):
            yield (name, below), command.commands[below]


@pytest.mark.parametrize(("words", "command"), list(every_command()), ids=lambda value: " ".join(value)
                         if isinstance(value, tuple) else "")  # fmt: skip
def test_help_shows_brackets_as_they_are_written(words, command, ran):
    shown = "".join(re.sub(r"[│\s]", "", ran_here(*words, "--help", cwd=ran, COLUMNS="200").stdout))
    for item in (command, *command.params):
        for bracket in re.findall(r"\[+[a-z]+\]+", getattr(item, "help", None) or ""):
            assert bracket in shown
    assert "\\[" not in shown


@pytest.mark.parametrize("group", ["catalog"])
def test_a_group_alone_shows_its_help_and_has_done_nothing(group, ran):
    done = ran_here(group, cwd=ran)
    assert done.returncode == 2 and done.stderr == ""
    assert "Usage: kinform catalog" in done.stdout and "rebuild" in done.stdout


@pytest.mark.parametrize("name", ["out.html", "out.json", "out.stl", "out.toml"])
def test_results_are_not_written_under_the_name_of_another_kind(name, ran):
    done = ran_here("run", "planar_block.toml", "-o", name, cwd=ran)
    assert done.returncode == 2 and "out.h5" in done.stderr
    assert not (ran / name).exists()


@pytest.mark.parametrize("name", ["x.pdf", "x.png", "x.h5"])
def test_a_page_is_not_written_under_the_name_of_another_kind(name, ran):
    done = ran_here("report", "r.h5", "-o", name, cwd=ran)
    assert done.returncode == 2 and "x.html" in done.stderr
    assert not (ran / name).exists()


def test_meshes_without_a_unit_are_answered_with_the_option(ran):
    done = ran_here("init", "block.stl", cwd=ran)
    assert done.returncode == 2 and done.stdout == "" and "--units mm" in done.stderr


def test_a_manifest_that_was_begun_names_its_schema_for_editors(ran):
    done = ran_here("init", "block.stl", "table.stl", "--units", "mm", "-o", "new begun.toml", cwd=ran)
    assert (ran / "new begun.toml").read_text().startswith("#:schema ./kinform.schema.json\nschema = 1\n")
    assert "kinform schema > kinform.schema.json" in done.stderr
    (ran / "new begun.toml").unlink()


@pytest.mark.parametrize(("units", "small"), [("m", "mm"), ("cm", "mm"), ("mm", "mm"), ("um", "um"), ("in", "in")])
def test_small_lengths_are_in_a_unit_that_a_person_reads(units, small, derive_design):
    from dataclasses import replace

    design = derive_design(BLOCK / "planar_block.toml")
    lengths = Lengths.of(replace(design.assembly, units=units))
    assert (lengths.unit, lengths.small) == (small, small)
    if small == "mm":
        assert (lengths.length(2.5e-4), lengths.area(2.002e-5)) == ("0.25", "20.02")
