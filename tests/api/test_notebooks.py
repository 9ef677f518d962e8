"""What a notebook shows of results."""

from __future__ import annotations

import html

import pytest
from support.places import FIXTURES

import kinform
from kinform.api import Results


@pytest.fixture(scope="module")
def results(derive_design):
    """A seeker whose gimbal reaches into the housing."""
    return Results(derive_design(FIXTURES / "broken" / "seeker_gimbal_overlaps" / "seeker_gimbal_overlaps.toml"))


def test_the_verdict_is_a_word(results, derive_design):
    assert results.verdict == "inconsistent"
    assert Results(derive_design(FIXTURES / "seekers" / "seeker_2dof" / "seeker_2dof.toml")).verdict == "consistent"


def test_tables_are_shown_as_html_with_names_as_text(results):
    shown = results.joints._repr_html_()
    for joint in results.joints.values():
        assert f"<td>{html.escape(joint.name)}</td>" in shown
    assert shown.count("<tr>") == 1 + len(results.joints)
    assert "KF201" in results.findings._repr_html_()
    assert results.findings == results.report.findings
    whole = results._repr_html_()
    assert "inconsistent" in whole and "KF201" in whole and shown in whole


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
    with pytest.raises(ImportError, match="pip install pandas"):
        results.joints.to_frame()
    assert kinform.open is not None
