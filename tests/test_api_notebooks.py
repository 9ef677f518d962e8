"""What a notebook shows of results."""

from __future__ import annotations

import html
import re
from xml.etree import ElementTree

import pytest
from support.places import FIXTURES

import kinform
from kinform.api import Results
from kinform.consistency import verdict_of

pytestmark = pytest.mark.usefixtures("small_pictures")


@pytest.fixture(scope="module")
def results(derive_design):
    """A seeker whose gimbal reaches into the housing."""
    return Results(derive_design(FIXTURES / "broken" / "seeker_gimbal_overlaps" / "seeker_gimbal_overlaps.toml"))


def test_the_verdict_is_that_of_the_gate(results, derive_design):
    assert results.verdict == verdict_of(results.report).line and results.verdict.startswith("FAILED")
    good = Results(derive_design(FIXTURES / "seekers" / "seeker_2dof" / "seeker_2dof.toml"))
    assert good.verdict == "consistent"
    assert good.coverage == verdict_of(good.report).coverage and good.coverage in repr(good)


def test_tables_are_shown_as_html_with_names_as_text(results):
    shown = results.joints._repr_html_()
    for joint in results.joints.values():
        assert f"<td>{html.escape(joint.name)}</td>" in shown
    assert shown.count("<tr>") == 1 + len(results.joints)
    assert "KF201" in results.findings._repr_html_()
    assert results.findings == results.report.findings
    whole = results._repr_html_()
    assert html.escape(results.verdict) in whole and "KF201" in whole and shown in whole


def test_the_view_is_the_page_in_a_frame(results):
    view = results.view(500)
    frame = view._repr_html_()
    assert "height:500px" in frame
    assert html.unescape(frame.partition('srcdoc="')[2].partition('"')[0]) == results.page()
    assert len(repr(view)) < 80


def test_tables_become_data_frames(results):
    pandas = pytest.importorskip("pandas")
    frame = results.joints.to_frame()
    assert isinstance(frame, pandas.DataFrame)
    assert list(frame["name"]) == list(results.joints)
    assert frame["freedoms"].sum() == 2
    assert list(results.findings.to_frame()["code"]) == ["KF201"]
    assert results.mass.to_frame()["mass"].sum() == pytest.approx(sum(m.mass for m in results.mass.values()))


def test_without_pandas_it_says_what_to_install(results, monkeypatch):
    monkeypatch.setitem(__import__("sys").modules, "pandas", None)
    with pytest.raises(ImportError, match="pandas"):
        results.joints.to_frame()
    assert kinform.open is not None


@pytest.fixture(scope="module")
def moving(derive_design):
    return Results(derive_design(FIXTURES / "seeker" / "5_complete" / "seeker.toml"))


def test_curves_of_a_run_are_drawings_in_the_cell(moving, results):
    shown = moving.plots()._repr_html_()
    for heading in ("Joint values", "Drive efforts", "Reactions in the joints", "Energy"):
        assert f"<h4>{heading}</h4>" in shown
    drawings = re.findall(r"<svg.*?</svg>", shown, re.DOTALL)
    assert len(drawings) >= 8 and repr(moving.plots()).startswith(f"Plots({len(drawings)} ")
    for drawing in drawings:
        ElementTree.fromstring(drawing)
    assert all(f".kinform-plots .plot .{kind}" in shown for kind in ("grid", "curve-0", "limit"))
    assert shown in moving._repr_html_()


def test_reprs_are_short(moving):
    assert re.findall(r"(\w+) (\d)", repr(moving.mobility))[:4] == [
        ("effective", "2"), ("instantaneous", "2"), ("finite", "2"), ("idle", "0"),
    ]  # fmt: skip
    assert "<tr><td>2</td><td>effective</td></tr>" in moving.mobility._repr_html_()
    assert repr(moving.assembly) == "Assembly seeker: 12 parts, lengths shown in mm"
    assert repr(moving.joints["base~gimbal"]) == "Joint base~gimbal: revolute (determined)"
    assert repr(moving.simulation) == "Simulation: dynamic done, 201 samples"
    assert len(repr(moving.mass)) < 400
