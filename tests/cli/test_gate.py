"""The exit code of the gate is the same in every format, whoever reads it."""

from __future__ import annotations

import dataclasses
import os
import pty
import subprocess
import sys
from pathlib import Path

import pytest
from support.command_line import environment
from support.diagonal import some
from support.places import FIXTURES

from kinform import results
from kinform.model.findings import CheckReport, Finding, RuleOutcome
from kinform_cli import gate, options
from kinform_cli.main import main

FORMATS = [format.value for format in options.FindingsFormat]
MANIFEST = FIXTURES / "pairs" / "free_apart" / "free_apart.toml"


@pytest.fixture(scope="module")
def red(derive_design, tmp_path_factory):
    """Results of a design with errors: their file, in its folder."""
    file = tmp_path_factory.mktemp("red") / "red.h5"
    results.write(derive_design(FIXTURES / "broken" / "four_bar_missing_pin" / "four_bar_missing_pin.toml"), file)
    return file


def test_reports_and_the_command_know_the_same_formats():
    from kinform.reports import FORMATS as known

    assert sorted(FORMATS) == sorted(known)


REPORTS = {
    0: CheckReport((), (RuleOutcome("KF101", "a", "passed"),)),
    1: CheckReport((Finding("KF101", "a", "error", ("x",), "bad"),), (RuleOutcome("KF101", "a", "failed"),)),
    2: CheckReport((), (RuleOutcome("KF101", "a", "inconclusive", "no"),)),
}


@pytest.mark.parametrize("format", FORMATS)
@pytest.mark.parametrize("code", REPORTS)
def test_each_verdict_has_its_code_in_each_format(code, format, derive_design, capsys):
    design = dataclasses.replace(derive_design(MANIFEST), report=REPORTS[code])
    assert gate.Gate(options.Printed(options.FindingsFormat(format)), options.Severity.error).judge(design) == code
    assert capsys.readouterr().out.strip()


@pytest.mark.parametrize("format", some(3, FORMATS))
def test_no_color_and_a_pipe_change_no_code_and_no_byte(format, red, capsys, monkeypatch):
    assert main(["check", str(red), "-f", format, "-q"]) == 1
    plain = capsys.readouterr().out
    monkeypatch.setenv("NO_COLOR", "1")
    assert main(["check", str(red), "-f", format, "-q"]) == 1
    assert capsys.readouterr().out == plain
    assert "\x1b" not in plain


@pytest.mark.parametrize("format", [pytest.param(f, marks=[] if f == "json" else pytest.mark.sweep) for f in FORMATS])
def test_a_reader_that_leaves_early_changes_no_code(format, red):
    command = [sys.executable, "-m", "kinform_cli", "check", str(red), "-f", format]
    running = subprocess.Popen(command, env=environment(), stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    running.stdout.close()
    errors = running.stderr.read()
    assert running.wait(timeout=60) == 1
    assert "Traceback" not in errors


@pytest.mark.parametrize("format", ["full", "sarif"])
def test_a_terminal_changes_no_code(format, red):
    leader, follower = pty.openpty()
    command = [sys.executable, "-m", "kinform_cli", "check", str(red), "-f", format, "-q"]
    running = subprocess.Popen(command, env=environment(), stdout=follower, stderr=follower)
    os.close(follower)
    said = b""
    try:
        while chunk := os.read(leader, 65536):
            said += chunk
    except OSError:  # the other end is closed
        pass
    os.close(leader)
    assert running.wait(timeout=60) == 1
    assert (b"\x1b[" in said) == (format == "full")


def test_a_full_disk_under_stdout_is_not_verified(red):
    if not Path("/dev/full").exists():
        pytest.skip("needs /dev/full")
    command = [sys.executable, "-m", "kinform_cli", "check", str(red), "-f", "junit"]
    with open("/dev/full", "w") as full:
        ran = subprocess.run(command, env=environment(), stdout=full, stderr=subprocess.PIPE, text=True, check=False)
    assert ran.returncode == 2


def test_files_are_named_from_the_root_of_the_repository_where_its_host_reads_them(red, capsys):
    assert main(["check", str(red), "-f", "github", "--manifest-folder", "designs/arms"]) == 1
    lines = capsys.readouterr().out.splitlines()
    assert all("file=designs/arms/four_bar_missing_pin.toml," in line for line in lines if line.startswith("::error"))
    assert main(["check", str(red), "-f", "concise", "--manifest-folder", "designs/arms"]) == 1
    assert "designs" not in capsys.readouterr().out
