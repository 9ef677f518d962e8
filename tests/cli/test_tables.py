"""Tables at any width: nothing is wider than it may be, nothing is lost, and no two names look alike."""

from __future__ import annotations

import io
import re

import pytest
from hypothesis import given
from hypothesis import strategies as st
from rich.console import Console
from support.places import FIXTURES

from kinform import results
from kinform.reports.values.topics import TOPICS
from kinform_cli.main import main
from kinform_cli.tables import Rows
from kinform_cli.text import hanging, quantity

LONG = [f"base_motor_holder_so101_v1~waveshare_mounting_plate_so101_v{k}" for k in range(3)]


def drawn(rows: Rows, width: int) -> list[str]:
    console = Console(width=width, file=io.StringIO(), color_system=None)
    console.print(rows)
    return [line.rstrip() for line in console.file.getvalue().splitlines()]  # type: ignore[attr-defined]


@pytest.mark.parametrize(
    "fixture", ["mechanisms/four_bar/four_bar", pytest.param("seeker/5_complete/seeker", marks=pytest.mark.sweep)]
)
def test_off_a_terminal_no_line_is_wider_than_eighty_and_no_number_has_an_exponent(
    fixture, derive_design, tmp_path, capsys, monkeypatch
):
    monkeypatch.delenv("COLUMNS", raising=False)
    path = tmp_path / "design.h5"
    results.write(derive_design(FIXTURES / f"{fixture}.toml"), path)
    for topic in ("", *TOPICS):
        assert main(["show", str(path), *([topic] if topic else [])]) == 0
        lines = capsys.readouterr().out.splitlines()
        assert lines and max(map(len, lines)) <= 80, topic
        told = [line for line in lines if "residual below" not in line]
        assert not any(re.search(r"\de[-+]\d", line) for line in told), topic


def test_columns_asks_for_a_width_off_a_terminal(derive_design, tmp_path, capsys, monkeypatch):
    path = tmp_path / "design.h5"
    results.write(derive_design(FIXTURES / "seeker/5_complete/seeker.toml"), path)
    monkeypatch.setenv("COLUMNS", "200")
    main(["show", str(path), "mobility"])
    assert max(map(len, capsys.readouterr().out.splitlines())) > 100


def test_names_are_shortened_in_their_middle_where_the_columns_then_fit():
    rows = Rows("name", "status", names=["name"])
    for name in LONG:
        rows.add(name, "determined")
    lines = drawn(rows, 60)
    assert len(lines) == 4 and max(map(len, lines)) <= 60
    for k, line in enumerate(lines[1:]):
        assert re.match(rf"base_\S*…\S*~\S*…\S*_v{k}  determined$", line)


def test_names_that_would_look_alike_stay_whole():
    rows = Rows("name", "status", names=["name"])
    names = [f"part_{'x' * 30}_{k}_{'y' * 30}" for k in range(2)]
    for name in names:
        rows.add(name, "fixed")
    text = "\n".join(drawn(rows, 40)).replace("\n  ", "")
    assert all(name in text for name in names)


def test_texts_are_wrapped_between_words_only():
    rows = Rows("rule", "because", texts=["because"])
    rows.add("KF402", "the contact of housing/inner_bearing_seat forbids what is intended, " * 2)
    lines = drawn(rows, 50)
    assert lines[0].split() == ["rule", "because"] and 4 <= len(lines) <= 6
    assert any("housing/inner_bearing_seat" in line for line in lines)


@given(
    table=st.lists(st.tuples(*[st.text("ab_~ /", max_size=40).map(str.strip)] * 3), min_size=1, max_size=4),
    width=st.integers(20, 120),
)
def test_no_line_is_wider_and_no_value_is_lost(table, width):
    rows = Rows("one", "two", "three", names=["one"], texts=["two"])
    for row in table:
        rows.add(*row)
    lines = drawn(rows, width)
    assert max(map(len, lines), default=0) <= width
    shown = re.sub(r"\s", "", "".join(lines))
    for _, *values in table:
        for word in " ".join(values).split():
            assert set(word) <= set(shown)
    if "…" not in shown:
        letters = sum(len(re.sub(r"\s", "", value)) for row in table for value in row)
        assert len(shown) >= letters


def test_quantities_have_units_in_which_they_read_well():
    assert quantity(0.001515, "N·m") == "1.515 mN·m"
    assert quantity(5.519e-05, "J") == "0.05519 mJ"
    assert quantity(2e-7, "W") == "0.2 µW"
    assert quantity(-0.02, "N") == "-0.02 N"
    assert quantity(25000.0, "N") == "25 kN"
    assert quantity(0.0, "J") == "0 J"


def test_lines_of_a_text_go_on_indented():
    text = "shaft is new\n  " + "word " * 20
    lines = hanging(text, 40).split("\n")
    assert lines[0] == "shaft is new" and max(map(len, lines)) <= 40
    assert lines[1].startswith("  word") and all(line.startswith("    word") for line in lines[2:])
