"""What a study says, and what it draws."""

from __future__ import annotations

import os
from pathlib import Path

import numpy as np
import pytest
from scipy import stats

from kinform.errors import InputError
from kinform.form.keys import changed, looked_up, steps_of
from kinform.study.plan import read_plan
from kinform.study.sampling import samples

MEASURE = '[[measure]]\nname = "m"\nvalue = "mobility.effective"\n'


def plan(folder: Path, study: str, *varied: str, design="schema = 1\n"):
    (folder / "d.toml").write_text(design)
    tables = "\n".join(f"[[vary]]\n{text}" for text in varied)
    (folder / "s.toml").write_text(f'schema = 1\n[study]\ndesign = "d.toml"\n{study}\n{tables}\n{MEASURE}')
    return read_plan(folder / "s.toml")


A = 'name = "a"\nvalue = "x.a"\n'
B = 'name = "b"\nvalue = "x.b"\n'


def test_a_grid_is_every_combination(tmp_path):
    found = plan(tmp_path, 'method = "grid"', A + "values = [1, 2]", B + "between = [0, 1]\nsteps = 3")
    assert samples(found) == [(a, b) for a in (1, 2) for b in (0.0, 0.5, 1.0)]


def test_one_at_a_time_leaves_the_others_in_the_middle(tmp_path):
    found = plan(tmp_path, 'method = "one-at-a-time"', A + "values = [1, 2, 3]", B + "between = [0, 1]\nsteps = 2")
    assert samples(found) == [(2, 0.5), (1, 0.5), (3, 0.5), (2, 0.0), (2, 1.0)]


METHODS = ("monte-carlo", "latin-hypercube", "sobol")


@pytest.mark.parametrize(
    ("method", "way", "expected"),
    [
        pytest.param(method, *case, marks=[] if row % 3 == column else pytest.mark.sweep)
        for row, case in enumerate(
            [
                ("between = [2, 5]", stats.uniform(2, 3)),
                ('between = [2, 5]\ndistribution = "triangular"', stats.triang(0.5, 2, 3)),
                ("mean = 4\ndeviation = 0.5", stats.norm(4, 0.5)),
                ('tolerance = "±0.3"\nnominal = 10', stats.norm(10, 0.1)),
                ('tolerance = "+0.2/-0.1"\nnominal = 10\ndistribution = "uniform"', stats.uniform(9.9, 0.3)),
                ('tolerance = "H7/g6"\nnominal = 0\ndiameter = 20', stats.norm(0.024, 0.034 / 6)),
            ]
        )
        for column, method in enumerate(METHODS)
    ],
)
def test_samples_are_of_their_distribution(tmp_path, method, way, expected):
    found = plan(tmp_path, f'method = "{method}"\nsamples = 1024\nseed = 3', A + way, B + "between = [0, 1]")
    drawn = np.array(samples(found))
    assert stats.kstest(drawn[:, 0], expected.cdf).pvalue > 0.01
    assert abs(stats.spearmanr(drawn[:, 0], drawn[:, 1]).statistic) < 0.1
    assert samples(found) == samples(found)


def test_the_nominal_value_is_that_of_the_manifest(tmp_path):
    study = 'method = "monte-carlo"\nsamples = 3'
    for design in ("[x]\na = 7.0\n", "\ufeff[x]\r\na = 7.0\r\n"):
        found = plan(tmp_path, study, A + 'tolerance = "±1"', design=design)
        assert (found.axes[0].low, found.axes[0].high) == (6.0, 8.0)


def test_the_nominal_value_of_a_description_is_what_it_states(tmp_path):
    inertia = '<inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/>'
    box = '<visual><geometry><box size="1 1 1"/></geometry></visual>'
    link = f'<link name="arm">{box}<inertial><mass value="0.4"/>{inertia}</inertial></link>'
    (tmp_path / "arm.urdf").write_text(f'<robot name="r">{link}</robot>')
    (tmp_path / "over.toml").write_text('schema = 1\n[assembly]\nname = "r"\nfrom = "arm.urdf"\n')
    for design in ("arm.urdf", "over.toml"):
        (tmp_path / "s.toml").write_text(
            f'schema = 1\n[study]\ndesign = "{design}"\nsamples = 3\n[[vary]]\nname = "a"\n'
            f'value = "group.arm.mass"\ntolerance = "±0.1"\n{MEASURE}'
        )
        axis = read_plan(tmp_path / "s.toml").axes[0]
        assert (axis.low, axis.high) == pytest.approx((0.3, 0.5))


@pytest.mark.parametrize("place", ["study", "design"])
def test_a_pipe_and_what_is_no_text_are_refused(tmp_path, place):
    study = ('method = "monte-carlo"\nsamples = 3', A + 'tolerance = "±1"')
    plan(tmp_path, *study, design="[x]\na = 7.0\n")
    file = tmp_path / {"study": "s.toml", "design": "d.toml"}[place]
    file.write_bytes(b"\xff")
    with pytest.raises(InputError):
        read_plan(tmp_path / "s.toml")
    file.unlink()
    os.mkfifo(file)
    with pytest.raises(InputError):
        read_plan(tmp_path / "s.toml")


@pytest.mark.parametrize(
    ("study", "varied", "named"),
    [
        ("samples = 3", A, ["vary.0"]),
        ("samples = 3", A + "between = [2, 1]", ["vary.0", "between"]),
        ("samples = 3", A + 'tolerance = "K7"\nnominal = 20', ["'a'", "K7"]),
        ("samples = 3", A + 'tolerance = "±1"', ["'a'", "nominal"]),
        ("", A + "between = [0, 1]", ["[study]", "samples"]),
        ('method = "sobol"\nsamples = 100', A + "between = [0, 1]", ["[study]", "64", "128"]),
        ('method = "grid"', A + "between = [0, 1]", ["'a'", "values", "steps"]),
        ("samples = 3\nindices = true", A + "between = [0, 1]", ["[study]", "sobol"]),
        ("samples = 3", 'name = "m"\nvalue = "x"\nbetween = [0, 1]', ["'m'"]),
        ("samples = 3", 'name = "a"\nbetween = [0, 1]', ["'a'"]),
        ("samples = 3\nspeed = 1", A + "between = [0, 1]", ["study.speed"]),
    ],
)
def test_what_makes_no_sense_is_refused_by_the_names_of_its_keys(tmp_path, study, varied, named):
    with pytest.raises(InputError) as caught:
        plan(tmp_path, study, varied)
    assert caught.value.problems[0].file == str(tmp_path / "s.toml")
    assert all(name in caught.value.problems[0].message for name in named)


TABLES = {"part": [{"name": "a.b", "position": [1, 2, 3]}, {"name": "c"}], "x": {"y": 1}}


def test_paths_lead_by_names_and_numbers():
    steps = steps_of('part."a.b".position.1')
    assert looked_up(TABLES, steps) == 2
    assert looked_up(changed(TABLES, steps, 9.0), steps) == 9.0 and looked_up(TABLES, steps) == 2
    assert looked_up(changed(TABLES, steps_of("part.c.density"), 5), steps_of("part.1.density")) == 5
    assert looked_up(TABLES, steps_of("part.count")) == 2
    assert looked_up(TABLES, steps_of("part.0.position.max")) == 3


@pytest.mark.parametrize("text", ["part.d.position.0", "part.5", "z.y", "x.y.z", "part.c.position.0"])
def test_a_path_that_leads_nowhere_is_an_error(text):
    with pytest.raises(KeyError):
        changed(TABLES, steps_of(text), 1)


def test_nothing_is_below_a_value_and_below_what_is_not_known_is_nothing_known():
    with pytest.raises(KeyError):
        looked_up(TABLES, steps_of("x.y.z"))
    assert looked_up({"x": None}, steps_of("x.y.z")) is None


@pytest.mark.parametrize("text", ["", ".a", "a..b", "a.", 'a"b', '"a'])
def test_what_is_no_path_is_refused(text):
    with pytest.raises(ValueError) as caught:  # noqa: PT011
        steps_of(text)
    assert repr(text) in str(caught.value)
