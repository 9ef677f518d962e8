"""The examples of pipelines: their commands exist, their files parse, and the hook does what a gate does."""

from __future__ import annotations

import re
import shlex
import shutil
import subprocess
import sys

import pytest
import typer
from support.places import FIXTURES, ROOT
from support.validators import package

from kinform_cli.app import app
from kinform_cli.options import FindingsFormat

EVERY = sorted((ROOT / "examples" / "ci").glob("*.yml"))
MANY = ROOT / "examples" / "ci" / "many-designs.yml"
CI = [path for path in EVERY if path != MANY]
"""Pipelines of one design."""


def commands(text):
    """Every command line of kinform in a file, as words."""
    found = re.findall(r"(?:^|[\s:-])(kinform [^#\n]*)", re.sub(r"#.*", "", re.sub(r"\\\n\s*", "", text)))
    return [shlex.split(re.split(r"\|\||>>|>|&&", line)[0]) for line in found]


@pytest.mark.parametrize("path", [*EVERY, ROOT / ".pre-commit-hooks.yaml"], ids=lambda path: path.name)
def test_the_commands_in_an_example_exist_with_their_options(path):
    group = typer.main.get_command(app)
    lines = [words for words in commands(path.read_text()) if words[1:2] and words[1] in group.commands]
    assert lines
    for words in lines:
        known = {flag for parameter in group.commands[words[1]].params for flag in parameter.opts}
        given = {word for word in words[2:] if word.startswith("-")}
        assert given <= known, words
        if "--format" in given:
            assert words[words.index("--format") + 1] in set(FindingsFormat)


@pytest.mark.parametrize("path", CI, ids=lambda path: path.name)
def test_the_gate_decides_the_job_and_nothing_else_does(path):
    lines = [line.strip() for line in path.read_text().splitlines() if re.search(r"kinform (run|check|report)", line)]
    gates = [line for line in lines if "kinform run" in line]
    assert len(gates) == 1
    assert "|| true" not in gates[0]
    assert all(line.endswith("|| true") for line in lines if line not in gates)


def test_reports_are_kept_when_the_gate_is_red():
    github, gitlab = (path.read_text() for path in CI)
    for step in ("upload-artifact", "upload-sarif", "name: reports"):
        after = github[github.index(step) :].splitlines()[1]
        assert after.strip() == "if: ${{ !cancelled() }}", step
    assert re.search(r"artifacts:\n\s+when: always\n", gitlab)


def test_results_are_kept_for_the_next_run_when_the_gate_is_red():
    github, gitlab = (path.read_text() for path in CI)
    assert "actions/cache@" not in github
    restored, saved = (github.index(f"actions/cache/{step}@") for step in ("restore", "save"))
    assert restored < github.index("kinform run") < saved
    step = github[github.rindex("- name:", 0, saved) : github.index("- name: reports")]
    assert "if: ${{ !cancelled() }}" in step
    keys = re.findall(r" key: (.*)", github)
    assert len(keys) == 2
    assert keys[0] == keys[1]
    assert "run_attempt" in keys[0]
    assert re.search(r"cache:\n(?:.*\n)*?\s+when: always\n", gitlab)


@pytest.mark.parametrize("path", CI, ids=lambda path: path.name)
def test_the_page_is_among_the_reports_that_are_kept(path):
    text = path.read_text()
    made = [words for words in commands(text) if words[1] == "report"]
    assert [words[words.index("-o") + 1] for words in made] == ["reports/report.html"]
    kept = text[text.rindex("path:" if "upload-artifact" in text else "paths:") :]
    assert re.search(r"^\s*(- )?reports$", kept, re.MULTILINE)


@pytest.mark.parametrize("path", [*EVERY, ROOT / ".pre-commit-hooks.yaml"], ids=lambda path: path.name)
def test_an_example_is_yaml(path):
    yaml = package("yaml")
    assert yaml.safe_load(path.read_text())


def test_the_hook_is_the_gate(tmp_path):
    hook = dict(re.findall(r"^\s*(?:- )?(\w+): (.*)$", (ROOT / ".pre-commit-hooks.yaml").read_text(), re.MULTILINE))
    shutil.copytree(FIXTURES / "pairs" / "planar_block", tmp_path / "design")
    entry = [sys.executable, "-m", "kinform_cli", *shlex.split(hook["entry"])[1:]]
    manifest = tmp_path / "design" / "planar_block.toml"
    codes = []
    # as the head of the file shows it, where nothing was built yet
    shown = re.search(r"args: \[([^\]]+)\]", (ROOT / ".pre-commit-hooks.yaml").read_text())[1].split(", ")
    arguments = [word.replace("designs/arm.toml", "design/planar_block.toml") for word in shown]
    for _ in range(2):
        ran = subprocess.run(
            [*entry, *arguments],
            cwd=tmp_path,
            capture_output=True,
            text=True,
            check=False,
        )
        codes.append(ran.returncode)
        manifest.write_text(manifest.read_text().replace("mobility = 3", "mobility = 5"))
    assert codes == [0, 1]
    assert re.search(hook["files"], "parts/camera.stl")
    assert hook["pass_filenames"] == "false"


@pytest.mark.parametrize("path", CI, ids=lambda path: path.name)
def test_an_example_installs_from_the_repository(path):
    installs = re.findall(r"pip install (.*)", path.read_text())
    assert installs == ['"git+$KINFORM"']
    assert re.search(r"^\s+KINFORM: https://\S+\.git@\S+$", path.read_text(), re.MULTILINE)


def test_many_designs_have_one_gate_and_keep_results_and_reports_when_it_is_red():
    text = MANY.read_text()
    (gate,) = [words for words in commands(text) if words[1] == "batch"]
    assert "||" not in text
    assert text.index("actions/cache/restore@") < text.index("kinform batch") < text.index("actions/cache/save@")
    after = text[text.index("kinform batch") :]
    assert after.count("if: ${{ !cancelled() }}") == after.count("- name:") + after.count("- uses:") == 3
    keys = re.findall(r" key: (.*)", text)
    assert len(keys) == 2 and keys[0] == keys[1] and "run_attempt" in keys[0]
    written = [word.partition("=")[2] for word in gate if "=" in word]
    assert all(name.startswith("reports/") for name in written) and "reports/findings.sarif" in written
    assert re.findall(r"pip install (.*)", text) == ['"kinform[batch] @ git+$KINFORM"']
    assert re.search(r"^\s+KINFORM: https://\S+\.git@\S+$", text, re.MULTILINE)


@pytest.mark.parametrize("path", EVERY, ids=lambda path: path.name)
def test_earlier_results_are_trusted_only_where_no_pull_request_writes_them(path):
    text = path.read_text()
    lines = [line for line in text.splitlines() if not line.strip().startswith("#")]
    gate = next(k for k, line in enumerate(lines) if re.search(r"kinform (run|batch) ", line))
    assert "$TRUST" in lines[gate]  # empty, unless a line before says otherwise
    if "gitlab" in path.name:
        (trusting,) = (line for line in lines if "--trust-results" in line)
        assert re.search(r'if \[ "\$CI_COMMIT_REF_PROTECTED" = "true" \].*; else TRUST=; rm -rf build; fi', trusting)
        assert any("git -c" in line and "test -z" in line for line in lines[:gate])
        return
    steps = re.split(r"\n      - ", text)
    trusting = [step for step in steps if "--trust-results" in step or "cache/restore" in step]
    only = "if: ${{ github.event_name == 'push' && github.ref_name == github.event.repository.default_branch }}"
    assert len(trusting) == 2 and all(only in step for step in trusting)
    assert any(step.startswith("run: rm -rf") for step in steps[: steps.index(trusting[0])])
