"""A build that is killed at any moment and resumed ends with the bytes of one that was not."""

from __future__ import annotations

import os
import random
import shutil
import signal
import subprocess
import time
from pathlib import Path

import pytest
from support.command_line import KINFORM
from support.places import ROOT

THREE = ("pairs/revolute_cone", "locators/fixed_d_shaft", "seekers/seeker_1dof")


def project(folder: Path, designs) -> list[str]:
    """The example Makefile and these designs in a folder; the command that builds them."""
    if not KINFORM.exists() or shutil.which("make") is None:
        pytest.skip("needs make, and kinform installed beside the interpreter")
    (folder / "examples").mkdir(parents=True)
    shutil.copy(ROOT / "examples" / "Makefile", folder / "examples" / "Makefile")
    names = []
    for design in designs:
        name = design.rpartition("/")[2]
        shutil.copytree(ROOT / "fixtures" / design, folder / "fixtures" / design)
        names.append(name)
    places = [f"{name}=../fixtures/{design}/{name}.toml" for name, design in zip(names, designs, strict=True)]
    make = ["make", "-s", "-j2", "-C", str(folder / "examples"), f"KINFORM={KINFORM}", f"DESIGNS={' '.join(names)}"]
    return [*make, *places, "all"]


def results(folder: Path) -> dict[str, bytes]:
    return {path.name: path.read_bytes() for path in sorted((folder / "examples" / "build").glob("*.h5"))}


def build(command: list[str], kill_after: float | None = None) -> bool:
    """Run the build in a process group of its own; whether it ended by itself before it was killed."""
    running = subprocess.Popen(command, start_new_session=True, stderr=subprocess.PIPE, text=True)
    try:
        _, errors = running.communicate(timeout=kill_after)
        assert running.returncode == 0, errors
        return True
    except subprocess.TimeoutExpired:
        os.killpg(running.pid, signal.SIGKILL)
        running.communicate()
        return False


def kill_and_resume(folder: Path, designs, kills: int) -> None:
    """Kills a build `kills` times, each time some way on from where the last one left it, and from nothing again
    whenever it ends; so the moments are spread over the whole of it, and most of them fall into work."""
    plain, torn = folder / "plain", folder / "torn"
    start = time.monotonic()
    build(project(plain, designs))
    whole = time.monotonic() - start
    expected = results(plain)
    assert len(expected) == 5 * len(designs)
    command = project(torn, designs)
    moments = random.Random(6)
    stage = 2.0 * whole / len(expected)  # two at a time
    done = 0
    while done < kills:
        if build(command, moments.uniform(0.0, 2.0 * stage)):
            assert results(torn) == expected
            shutil.rmtree(torn / "examples" / "build")
            continue
        done += 1
        # nothing half-written bears a name that a build would trust
        present = results(torn) if (torn / "examples" / "build").exists() else {}
        assert all(expected[name] == data for name, data in present.items())
    build(command)
    assert results(torn) == expected
    assert not [path.name for path in (torn / "examples" / "build").iterdir() if path.suffix == ".tmp"]
    assert build([*command, "-q"])


@pytest.mark.slow
def test_a_build_that_is_killed_and_resumed_ends_with_the_same_bytes(tmp_path):
    kill_and_resume(tmp_path, THREE[:1], 3)


@pytest.mark.sweep
def test_a_build_of_three_that_is_killed_thirty_times_ends_with_the_same_bytes(tmp_path):
    kill_and_resume(tmp_path, THREE, 30)
