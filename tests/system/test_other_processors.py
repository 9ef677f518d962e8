"""What is sensitive to last bits passes as on any other processor: with the kernels that OpenBLAS has for others, and
with numpy's vector code for newer ones turned off."""

import os
import re
import subprocess
import sys
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from support.once import common
from support.places import FIXTURES, ROOT

SENSITIVE = (
    "tests/simulation",
    "tests/kinematics",
    "tests/consistency/questions",
    "tests/system/test_blocked_joints.py",
    "tests/system/test_far_from_origin.py",
    "tests/system/test_pins_in_slots.py",
    "tests/system/test_screw_joints.py",
    "tests/surfaces",
    *(
        f"tests/system/test_{name}.py"
        for name in (
            "known_arms",
            "known_mechanisms",
            "as_subassemblies",
            "metamorphic_fixtures",
            "story",
            "truth",
            "whole_answers",
        )
    ),
    "tests/mass",
    "tests/docs",
    "tests/collisions/test_joint_ranges.py",
    "tests/behaviour/test_couplings.py",
    "tests/system/test_fixtures_swing.py",
)
"""What hangs on singular values, on integrations and on fits, and what is written and compared byte for byte."""
ALIKE = ("seekers/seeker_2dof/seeker_2dof", "mechanisms/bennett/bennett", "mechanisms/four_bar/four_bar")


def able(*features: str) -> bool:
    """Whether the processor has these features, as Linux calls them."""
    try:
        text = Path("/proc/cpuinfo").read_text()
    except OSError:
        return False
    flags = next((line.split(":")[1].split() for line in text.splitlines() if line.startswith("flags")), [])
    return set(features) <= set(flags)


def dispatched() -> list[str]:
    """The features beyond the least that numpy has code for and this processor has."""
    from numpy._core import _multiarray_umath as core

    return [name for name in core.__cpu_dispatch__ if core.__cpu_features__.get(name)]


PROCESSORS = {
    "Nehalem": ("sse4_2",),
    "Haswell": ("avx2", "fma"),
    "SkylakeX": ("avx512f", "avx512cd", "avx512bw", "avx512dq", "avx512vl"),
}
"""Names that OpenBLAS has for processors, with what their kernels need; it has none of its own for AMD's."""


def left_out(name: str) -> list[str]:
    """Numpy's own vector code that is newer than this processor."""
    newer = {"Nehalem": dispatched(), "Haswell": [f for f in dispatched() if "512" in f or f == "X86_V4"]}
    return newer.get(name, [])


def settings_of(name: str) -> dict[str, str]:
    """The environment of a process that computes as on that processor."""
    if not able(*PROCESSORS[name]):
        pytest.skip(f"this processor has not what OpenBLAS uses for {name}: {', '.join(PROCESSORS[name])}")
    # a session of its own, not a worker of this one
    own = {key: value for key, value in os.environ.items() if not key.startswith("PYTEST_")}
    reduced = " ".join(left_out(name))
    return {**own, "OPENBLAS_CORETYPE": name, "NPY_DISABLE_CPU_FEATURES": reduced, "OPENBLAS_NUM_THREADS": "1"}


def native() -> str:
    """What OpenBLAS takes this processor for."""
    environment = {**os.environ, "OPENBLAS_VERBOSE": "2"}
    done = subprocess.run([sys.executable, "-c", "import numpy"], env=environment, capture_output=True, text=True)
    found = re.search(r"Core: (\w+)", done.stderr)
    return found.group(1) if found else ""


def run_python(name: str, *arguments: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [sys.executable, *arguments], cwd=ROOT, env=settings_of(name), capture_output=True, text=True, check=False
    )


@pytest.mark.slow
@pytest.mark.parametrize("name", PROCESSORS)
def test_the_sensitive_part_of_the_suite_passes_as_on(name):
    if name == native() and not left_out(name):
        pytest.skip(f"this processor is a {name} to OpenBLAS: the suite itself has passed on it, or has not")
    # two such runs come to one worker, and the other has done all else by then
    done = run_python(name, *"-m pytest -q -x -p no:cacheprovider -n 2 --dist worksteal".split(), *SENSITIVE)
    assert done.returncode == 0, done.stdout[-4000:]


@pytest.mark.slow
@pytest.mark.parametrize(("name", "fixture"), [*zip(("SkylakeX", "Haswell", "SkylakeX"), ALIKE, strict=True)])
def test_results_of_two_processors_are_the_same_behaviour_to_diff(name, fixture, tmp_path):
    """Last bits differ, and are kept: no finding does, and nothing beyond the tolerances of `diff`."""
    manifest, files, findings = FIXTURES / f"{fixture}.toml", [], []
    for each in ("Nehalem", name):
        files.append(tmp_path / f"{each}.h5")
        done = run_python(each, "-m", "kinform_cli", "run", str(manifest), "-o", str(files[-1]), "--format", "json")
        assert done.returncode == 0, done.stderr
        # what is not zero by rounding alone is said to be so much, and no more
        findings.append(re.sub(r"\d(\.\d+)?e-(09|1\d)", "0", done.stdout))
    assert findings[0] == findings[1]
    same = run_python(name, "-m", "kinform_cli", "diff", *map(str, files))
    assert (same.returncode, same.stderr) == (0, "")


def test_numpy_can_be_told_to_leave_its_newer_code():
    """Else the tests above would compare one thing with itself."""
    from numpy._core import _multiarray_umath as core

    assert set(dispatched()) <= set(core.__cpu_dispatch__)
    assert np.show_config("dicts")["Build Dependencies"]["blas"]["name"].endswith("openblas")


def test_a_session_begun_by_a_worker_keeps_what_it_computes_to_itself(tmp_path, monkeypatch):
    """Else it takes what sessions before it computed, on another processor or with another kinform."""
    monkeypatch.setenv("PYTEST_XDIST_WORKER", "gw1")
    for own, expected in (("pytest-7", "pytest-7"), ("pytest-7/popen-gw1", "pytest-7")):
        factory = SimpleNamespace(getbasetemp=lambda own=own: tmp_path / own)
        assert common(factory) == tmp_path / expected
    assert not [key for key in settings_of("Nehalem") if key.startswith("PYTEST_")]
