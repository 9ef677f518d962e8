"""No process of a batch, a study or a run is left after a signal that ends it."""

from __future__ import annotations

import os
import shutil
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest
from support.command_line import environment
from support.places import FIXTURES

pytestmark = [
    pytest.mark.slow,
    pytest.mark.skipif(sys.platform != "linux", reason="a process watches the work on Linux only"),
]

MARK = "KINFORM_TEST_MARK"
STUDY = """schema = 1
[study]
design = "revolute_collars.toml"
method = "grid"
[[vary]]
name = "k"
values = [1, 2, 3]
value = "part.shaft.density"
[[make]]
part = "shaft"
command = ["sh", "-c", "setsid sleep 600; cp shaft.stl {file}"]
[[measure]]
name = "mobility"
value = "mobility.effective"
"""


def marked(value: str) -> list[int]:
    """Processes in whose environment the mark has this value."""
    out = []
    for place in Path("/proc").glob("[0-9]*"):
        try:
            if f"{MARK}={value}\0".encode() in (place / "environ").read_bytes():
                out.append(int(place.name))
        except OSError:
            continue
    return out


@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGINT])
@pytest.mark.parametrize(
    ("words", "processes"),
    [
        ("batch . -o r --jobs 2", 7),  # two that watch and work, two of Dask, one that clears up, desks
        ("study s.toml -o s.h5 --jobs 2 --allow-commands", 9),
        ("run seeker/seeker_2dof.toml -o s.h5 --jobs 2", 3),
    ],
)
def test_nothing_is_left(words: str, processes: int, number: signal.Signals, tmp_path: Path):
    shutil.copytree(FIXTURES / "pairs" / "revolute_collars", tmp_path, dirs_exist_ok=True)
    for name in ("seeker", "other"):
        shutil.copytree(FIXTURES / "seekers" / "seeker_2dof", tmp_path / name)
    (tmp_path / "s.toml").write_text(STUDY)
    value = os.urandom(8).hex()
    running = subprocess.Popen(
        [sys.executable, "-m", "kinform_cli", *words.split()], cwd=tmp_path, env=environment(**{MARK: value}),
        stdout=subprocess.PIPE, stderr=subprocess.PIPE,
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_DFL),
    )  # fmt: skip
    while len(marked(value)) < processes:
        assert running.poll() is None, running.communicate()
        time.sleep(0.02)
    running.send_signal(number)
    running.wait(timeout=30)
    assert marked(value) == []
    running.communicate()
    assert running.returncode == (2 if number == signal.SIGINT else -number)
