"""`kinform init` proposes groups that can be taken over by removing the comment signs; `show` lists suggestions."""

from __future__ import annotations

import json
import re
import shutil
import tomllib
from dataclasses import replace

import numpy as np
import pytest
from support.command_line import ran_here
from support.places import FIXTURES
from support.solids import box, rod, save
from support.suggestions import CORNERS, drilled


def servo_and_bracket():
    return {
        "servo": box(-10, 10, -6, 6, 0, 20),
        "bracket": box(-30, 30, -15, 15, -4, 12) - box(-10, 10, -6, 6, 0, 30),
        "servo_body": drilled(30, 35, CORNERS),
        'a "quoted" plate': drilled(35, 40, CORNERS),
    }


def written(folder):
    names = []
    for name, solid in servo_and_bracket().items():
        save(solid, folder / f"{name}.stl")
        names.append(f"{name}.stl")
    return names


def kinform(folder, *arguments):
    return ran_here(*arguments, cwd=folder)


def uncommented(text):
    return re.sub(r"^# (\[\[group\]\]|name = |parts = )", r"\1", text, flags=re.MULTILINE)


@pytest.fixture(scope="module")
def begun(tmp_path_factory):
    folder = tmp_path_factory.mktemp("begun")
    ran = kinform(folder, "init", *written(folder), "--units", "mm", "-o", "m.toml")
    assert ran.returncode == 0, ran.stderr
    return folder, ran


def test_proposed_groups_are_ready_to_be_taken_over(begun):
    folder, _ = begun
    text = (folder / "m.toml").read_text()
    assert text.count("# [[group]]") == 2
    (folder / "taken.toml").write_text(uncommented(text))
    for steps in (["import", "taken.toml"], ["contacts", "t.h5"], ["joints", "t.h5"]):
        ran = kinform(folder, *steps, "-o", "t.h5")
        assert ran.returncode == 0, ran.stderr
    shown = json.loads(kinform(folder, "show", "t.h5", "joints", "--format", "json").stdout)
    assert sorted(sorted(body["parts"]) for body in shown["bodies"]) == [
        ['a "quoted" plate', "servo_body"],
        ["bracket", "servo"],
    ]


def test_nothing_but_comments_is_proposed(begun):
    folder, _ = begun
    ran = kinform(folder, "init", *(f"{name}.stl" for name in servo_and_bracket()), "--units", "mm", "--no-suggest")
    plain = [line for line in ran.stdout.splitlines() if not line.startswith("#")]
    kept = [line for line in (folder / "m.toml").read_text().splitlines() if not line.startswith("#")]
    # only the name differs: a manifest that is written is named after its file
    assert kept == ['name = "m"' if line == f'name = "{folder.name}"' else line for line in plain]


def test_the_evidence_stands_above_each_proposal_and_stays_a_comment(begun):
    folder, ran = begun
    lines = (folder / "m.toml").read_text().splitlines()
    for index in (k for k, line in enumerate(lines) if line == "# [[group]]"):
        assert lines[index - 1].startswith("## ")
    assert "kinform run m.toml -o m.h5" in ran.stderr


def test_a_unit_that_is_hard_to_believe_is_said_at_once_and_nothing_is_proposed(begun):
    folder, _ = begun
    ran = kinform(folder, "init", *(f"{name}.stl" for name in servo_and_bracket()), "--units", "um", "-o", "tiny.toml")
    assert ran.returncode == 0
    assert "warning: " in ran.stderr
    assert "## " not in (folder / "tiny.toml").read_text()


def test_millimetres_that_are_read_as_metres_are_said_too(begun):
    folder, _ = begun
    ran = kinform(folder, "init", *(f"{name}.stl" for name in servo_and_bracket()), "--units", "m", "-o", "large.toml")
    assert ran.returncode == 0
    assert "warning: " in ran.stderr and '"mm"' in ran.stderr
    assert "## " not in (folder / "large.toml").read_text()


def test_the_manifest_alone_goes_to_stdout(begun):
    folder, _ = begun
    ran = kinform(folder, "init", *(f"{name}.stl" for name in servo_and_bracket()), "--units", "mm")
    assert tomllib.loads(ran.stdout)["schema"] == 1
    assert len(tomllib.loads(ran.stdout)["part"]) == len(servo_and_bracket())


def test_show_lists_suggestions_with_evidence_and_confidence(begun):
    folder, _ = begun
    for steps in (["import", "m.toml"], ["contacts", "s.h5"]):
        assert kinform(folder, *steps, "-o", "s.h5").returncode == 0
    table = kinform(folder, "show", "s.h5", "contacts").stdout
    assert "holes" in table
    listed = json.loads(kinform(folder, "show", "s.h5", "contacts", "--format", "json").stdout)["suggestions"]
    assert [(hint["parts"], hint["kind"], hint["confidence"], hint["fastens"]) for hint in listed] == [
        (['a "quoted" plate', "servo_body"], "holes", "fair", True),
        (["bracket", "servo"], "pocket", "fair", True),
    ]


def test_joints_are_proposed_that_can_be_taken_over(tmp_path):
    """A plate on a pivot, screwed to another: one joint, and nothing about the screws."""
    base = box(-30, 30, -30, 30, -10, 0) + rod(5, -1, 30, 48)
    low = box(-10, 60, -10, 10, 0, 6) - rod(5.02, -1, 7, 48) - rod(2, -1, 7, 24).translate((40, 0, 0))
    screw = rod(1.98, 0, 6, 24) + rod(3.5, 6, 9, 24)
    for name, solid in {"base": base, "low": low, "screw": screw.translate((40, 0, 0))}.items():
        save(solid, tmp_path / f"{name}.stl")
    done = kinform(tmp_path, "init", "base.stl", "low.stl", "screw.stl", "--units", "mm", "-o", "arm.toml")
    assert done.returncode == 0, done.stderr
    text = (tmp_path / "arm.toml").read_text()
    wanted = r"^# (\[function\]|complete = |\[\[function\.joint\]\]|name = \"joint|type = |between = |axis = |point = )"
    (tmp_path / "arm.toml").write_text(re.sub(wanted, r"\1", text, flags=re.MULTILINE))
    stated = tomllib.loads((tmp_path / "arm.toml").read_text())["function"]
    (one,) = stated["joint"]
    assert (one["type"], set(one["between"])) == ("revolute", {"base", "low"})
    assert np.allclose(one["axis"], [0, 0, 1], atol=1e-6)
    assert np.allclose(one["point"][:2], 0.0, atol=1e-3)
    done = kinform(tmp_path, "run", "arm.toml", "-o", "arm.h5")
    assert done.returncode == 0, done.stdout + done.stderr
    bodies = json.loads(kinform(tmp_path, "show", "arm.h5", "bodies", "--format", "json").stdout)
    assert sorted(body["parts"] for body in bodies["bodies"]) == [["base"], ["low", "screw"]]
    (screwed,) = (one for one in bodies["membership"] if one["part"] == "screw")
    assert "'low'" in screwed["evidence"] and "'screw'" in screwed["evidence"]


def test_a_cad_file_without_function_gets_proposals_as_meshes_do(tmp_path):
    """The joint that is proposed for a STEP file is that of the STL version, and the manifest is one that runs."""
    pytest.importorskip("cascadio")
    source = FIXTURES.parent / "tests/form/scenes/step/revolute_collars.step"
    shutil.copy(source, tmp_path)
    ran = kinform(tmp_path, "init", source.name, "-o", "m.toml")
    assert ran.returncode == 0
    text = (tmp_path / "m.toml").read_text()
    lines = text.split("# [function]\n")[1].splitlines()
    meant = "\n".join(line.removeprefix("# ") for line in lines if line.startswith("# "))
    (joint,) = tomllib.loads(meant)["function"]["joint"]
    assert (joint["type"], sorted(joint["between"])) == ("revolute", ["block", "shaft"])
    stated = tomllib.loads((FIXTURES / "pairs/revolute_collars/revolute_collars.toml").read_text())
    (twin,) = stated["function"]["joint"]
    axis, wanted = (np.array(table["axis"]) / np.linalg.norm(table["axis"]) for table in (joint, twin))
    assert abs(axis @ wanted) == pytest.approx(1.0, abs=1e-6)
    beside = np.cross(np.array(joint["point"]) - twin["point"], wanted)  # mm
    assert np.linalg.norm(beside) < 0.02
    without = kinform(tmp_path, "init", source.name, "--no-suggest")
    assert "function.joint" not in without.stdout


def test_no_material_is_suggested_that_nothing_speaks_for(begun):
    text = (begun[0] / "m.toml").read_text()
    assert text.count('# material = "…"') == 4
    assert 'material = "steel"' not in text
    assert "pla, " in text


def test_what_is_outside_the_folder_is_said_once_with_how_many(begun):
    folder, _ = begun
    (folder / "below").mkdir(exist_ok=True)
    text = (folder / "m.toml").read_text().replace('mesh = "', 'mesh = "../')
    (folder / "below" / "m.toml").write_text(text)
    ran = kinform(folder, "run", "below/m.toml")
    assert ran.returncode == 2
    assert sum("../" in line for line in ran.stderr.splitlines()) == 1


def test_what_is_rounding_in_a_proposed_joint_is_not_written():
    from kinform.form.without_manifest import joint_lines
    from kinform.model.function import IntendedJoint

    axis, point = np.array([-6e-06, 1.0, 5e-06]), np.array([0.097234, -7.76e-05, 1e-7])
    noisy = IntendedJoint("j", ("a", "b"), "revolute", axis, None, point, None, None, None, None)
    assert {"axis = [0, 1, 0]", "point = [0.097234, -7.76e-05, 0]"} < set(joint_lines(noisy, "m", 0.2))
    middle = replace(noisy, point=np.array([-1e-20, 3e-17, 2e-19]))
    assert "point = [0, 0, 0]" in joint_lines(middle, "m", 0.2)
