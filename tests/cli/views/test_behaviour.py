"""`kinform show F.h5 behaviour` and `simulation`: the port model, what drives give, what was assumed; bad manifests."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from support.manifests import stated_joint, stated_part

from kinform_cli.main import main

HEAD = 'schema = 1\n[assembly]\nname = "device"\nunits = "m"\n'
MOTOR = (
    f'{HEAD}ground = "stator"\n{stated_part("stator", 0.5)}{stated_part("rotor", 0.2, (0, 0.01, 0))}'
    f"{stated_joint('bearing', ('stator', 'rotor'), 'revolute')}"
)
DEVICE = f"""{HEAD}ground = "base"
{stated_part("base", 1)}
[[subassembly]]
name = "yaw"
file = "motor.toml"
[[subassembly]]
name = "pitch"
file = "motor.toml"
position = [0.1, 0, 0.1]
rpy = [0, 90, 0]
{stated_joint("pan", ("base", "yaw/stator"), "revolute")}
{stated_joint("mount", ("yaw/rotor", "pitch/stator"), "revolute", (0, 1, 0), (0.1, 0, 0))}
[[function.drive]]
joint = "yaw/bearing"
kind = "motion"
law = {{type = "sine", amplitude = 20, frequency = 1}}
[[function.drive]]
joint = "pitch/bearing"
kind = "dc_motor"
resistance = 2
constant = 0.04
voltage = 6
[simulation]
duration = 0.5
step = 0.1
"""


@pytest.fixture(scope="module")
def file(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("behaviour")
    (folder / "motor.toml").write_text(MOTOR)
    (folder / "device.toml").write_text(DEVICE)
    main(["run", str(folder / "device.toml"), "-o", str(folder / "d.h5"), "-q", "--no-ranges"])
    return folder / "d.h5"


def printed(capsys: pytest.CaptureFixture[str], *arguments: object) -> str:
    capsys.readouterr()
    assert main([str(a) for a in arguments]) == 0
    return capsys.readouterr().out


def test_sub_assemblies_are_systems_with_ports_and_counts_of_their_own(
    file: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    found = json.loads(printed(capsys, "show", file, "behaviour", "-f", "json"))
    assert [level["system"] for level in found["counts"]] == ["", "pitch", "yaw"]
    assert all(level["unknowns"] == level["equations"] for level in found["counts"])
    inside = {c["subject"]: c for c in found["components"] if c["kind"] == "system"}
    kinds = sorted(c["kind"] for c in inside["pitch"]["components"])
    assert kinds == ["dc_motor", "joint", "rigid_body", "rigid_body", "voltage_source"]
    assert [port["component"] for port in inside["pitch"]["ports"]] == ["body pitch/stator"]
    text = printed(capsys, "show", file, "behaviour")
    for value in ("pitch/", "2 Ω", "0.04 N·m/A", "0.2 kg"):
        assert value in text


def test_the_same_model_is_exported_as_was_simulated(file: Path, tmp_path: Path) -> None:
    from kinform import results
    from kinform.exports import port_model

    assert main(["export", str(file), "--to", "json", "-o", str(tmp_path), "-q"]) == 0
    exported = port_model.read((tmp_path / "device.json").read_text(encoding="utf-8"))
    kept = results.read(file).behaviour
    assert kept is not None
    assert port_model.network(exported) == port_model.network(kept.nested)


def test_the_simulation_shows_what_drives_give_and_what_was_assumed(
    file: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    text = " ".join(printed(capsys, "show", file, "simulation").split())
    for named in ("-9.81) m/s²", "pitch/bearing", "base~yaw/stator"):
        assert named in text


def test_a_second_run_keeps_the_model_and_another_stage_drops_it(file: Path, tmp_path: Path) -> None:
    from kinform import results

    before = file.read_bytes()
    main(["run", str(file.parent / "device.toml"), "-o", str(file), "-q", "--no-ranges"])
    assert file.read_bytes() == before
    assert main(["mass", str(file), "-o", str(tmp_path / "m.h5"), "-q"]) == 0
    assert results.read(tmp_path / "m.h5").behaviour is None


BASE = """schema = 1
[assembly]
name = "bad"
units = "m"
ground = "base"
"""


def part(name: str, *, known: bool = True) -> str:
    weight = "mass = 1.0\ncentre_of_mass = [0, 0, 0]\ninertia = [[0.1, 0, 0], [0, 0.1, 0], [0, 0, 0.1]]\n"
    return f'[[part]]\nname = "{name}"\n{weight if known else ""}'


def joint(name: str, first: str, second: str, x: float = 0.0, y: float = 0.0) -> str:
    place = f"axis = [0, 0, 1]\npoint = [{x}, {y}, 0]\n"
    return f'[[function.joint]]\nname = "{name}"\nbetween = ["{first}", "{second}"]\ntype = "revolute"\n{place}'


def drive(name: str, law: str) -> str:
    return f'[[function.drive]]\njoint = "{name}"\nkind = "motion"\nlaw = {law}\n'


SINE = '{type = "sine", amplitude = 20, frequency = 1}'
HINGE = part("base") + part("arm") + joint("hinge", "base", "arm")
LOOP = "".join(
    [part("base"), part("a"), part("b"), part("c"), joint("j1", "base", "a"), joint("j2", "a", "b", 0, 1),
     joint("j3", "b", "c", 1, 1), joint("j4", "base", "c", 1, 0)]
)  # fmt: skip
BAD = {
    "no mass": (part("base") + part("arm", known=False) + joint("hinge", "base", "arm"), "arm"),
    "massless chain": (
        HINGE + part("tip", known=False) + joint("wrist", "arm", "tip", 1), "tip",
    ),
    "disconnected body": (HINGE + part("loose"), "loose"),
    "inconsistent loop": (
        LOOP + drive("j1", '{type = "constant", value = 30}') + drive("j4", '{type = "constant", value = -30}'),
        "a~base, base~c",
    ),
    "two drives": (HINGE + drive("hinge", SINE) + drive("hinge", SINE), "arm~base"),
}  # fmt: skip


@pytest.mark.parametrize("name", BAD)
def test_bad_models_are_refused_with_the_name_of_the_component(
    name: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    text, subject = BAD[name]
    (tmp_path / "bad.toml").write_text(BASE + text + '[simulation]\nlevel = "dynamic"\nduration = 0.5\nstep = 0.1\n')
    assert main(["run", str(tmp_path / "bad.toml"), "-o", str(tmp_path / "b.h5"), "-q", "-v", "--no-ranges"]) in (1, 2)
    said = " ".join(capsys.readouterr().out.split())
    assert all(f"'{name}'" in said for name in subject.split(", "))
    found = json.loads(printed(capsys, "show", tmp_path / "b.h5", "simulation", "-f", "json"))
    assert found["status"] == "refused"
    assert subject in [failure["subject"] for failure in found["failures"]]


@pytest.mark.parametrize(
    ("text", "told"),
    [
        (HINGE + drive("elbow", SINE), '"elbow"'),
        (HINGE + drive("hinge", '{type = "sine", amplitude = nan, frequency = 1}'), "amplitude"),
        (HINGE.replace("mass = 1.0", "mass = nan"), "mass"),
    ],
)
def test_what_no_model_can_be_made_of_is_an_error_with_its_line(
    text: str, told: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "bad.toml").write_text(BASE + text + "[simulation]\nduration = 0.5\n")
    assert main(["run", str(tmp_path / "bad.toml"), "-o", str(tmp_path / "b.h5"), "-q", "--no-ranges"]) == 2
    said = " ".join(capsys.readouterr().err.split())
    assert told in said
    assert "bad.toml:" in said
    assert not (tmp_path / "b.h5").exists()
