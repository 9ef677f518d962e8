"""Every key of a manifest is found on its line, in whatever style of TOML the manifest is written."""

from __future__ import annotations

import json
import tomllib

import pytest
from hypothesis import given
from hypothesis import strategies as st

from kinform.errors import InputError
from kinform.form import load
from kinform.form.readers.places import Left
from kinform.form.readers.toml_lines import LineTable

KEYS = st.sampled_from(["name", "mass", "axis of", "[[part]]", "a.b", "#", "é"])
SCALARS = st.sampled_from(
    ["1", "-2.5", '"x"', "'#no'", '"]"', "true", "1e3", '"a\\"b"', "inf", '"""\nlong\n"""', "'''x'''"]
)
STYLES = st.sampled_from(["header", "dotted", "inline"])


def shown(key):
    return key if key.isascii() and key.isalpha() else json.dumps(key, ensure_ascii=False)


class Writer:
    """Writes tables, and notes the line of every key as it goes."""

    def __init__(self, ending):
        self.text, self.ending, self.known = "", ending, {}

    def line(self):
        return self.text.count("\n") + 1

    def add(self, text, path=None):
        if path is not None:
            self.known.setdefault(path, self.line())
        self.text += text.replace("\n", self.ending)

    def pairs(self, table, path):
        for key, value in table.items():
            self.add(f"{shown(key)} = {value}  # {key} = [\n", (*path, key))

    def inline(self, table, path):
        self.add("{")
        for n, (key, value) in enumerate(table.items()):
            self.add(", " if n else "")
            self.add(f"{shown(key)} = {value}", (*path, key))
        self.add("}")

    def tables(self, name, rows, style, gap):
        if style == "inline":
            self.add(f"{name} = [\n", (name,))
            for k, row in enumerate(rows):
                self.add("# {\n" * gap)
                self.known[name, k] = self.line()
                self.inline({key: value for key, value in row.items() if "\n" not in value}, (name, k))
                self.add(", # ]\n")
            self.add("]\n")
        for k, row in enumerate(rows if style == "header" else ()):
            self.add("\n" * gap)
            self.add(f" [[ {name} ]]\n", (name, k))
            self.pairs(row, (name, k))
        for key, value in rows[0].items() if style == "dotted" else ():
            self.add(f"{name} . {shown(key)} = {value}\n", (name, key))


ROWS = st.lists(st.dictionaries(KEYS, SCALARS, min_size=1, max_size=4), min_size=1, max_size=4)


@given(st.lists(st.tuples(ROWS, STYLES, st.integers(0, 2)), min_size=1, max_size=3), st.sampled_from(["\n", "\r\n"]))
def test_every_key_is_found_on_its_line(tables, ending):
    writer = Writer(ending)
    order = sorted(tables, key=lambda item: item[1] == "header")  # what has no header of its own comes first
    for n, (rows, style, gap) in enumerate(order):
        writer.tables(f"t{n}", rows, style, gap)
    tomllib.loads(writer.text)
    lines = LineTable(writer.text)
    assert {path: lines.line(path) for path in writer.known} == writer.known


@given(ROWS, st.data())
def test_lines_stay_right_when_tables_are_taken_out(rows, data):
    writer = Writer("\n")
    writer.tables("part", rows, "header", 1)
    gone = data.draw(st.sets(st.integers(0, len(rows) - 1)))
    left = Left(LineTable(writer.text), {("part", k) for k in gone})
    kept = [k for k in range(len(rows)) if k not in gone]
    for now, before in enumerate(kept):
        for key in rows[before]:
            assert left.line(("part", now, key)) == writer.known["part", before, key]


def test_what_is_wrong_behind_a_refused_table_is_told_at_its_own_line_and_the_refused_is_not_missed(tmp_path):
    text = """schema = 1
assembly = {name = "x", units = "mm", ground = "a"}
[[part]]
name = "a"
mass = "heavy"
[[part]]
name = "b"
material = "unobtainium"
[[group]]
name = "g"
parts = ["a", "b", "c"]
[[function.require]]
name = "r"
kind = "mess"
[[function.require]]
name = "s"
kind = "mass"
of = "nobody"
maximum = 1
"""
    for edited in (text, "\ufeff" + text.replace("\n", "\r\n")):
        (tmp_path / "m.toml").write_bytes(edited.encode())
        with pytest.raises(InputError) as caught:
            load(tmp_path / "m.toml")
        found = {problem.line: problem.message for problem in caught.value.problems}
        assert sorted(found) == [5, 8, 11, 14, 18]
        assert '"c"' in found[11]
        assert '"r"' in found[14] and '"mess"' in found[14]
        assert '"nobody"' in found[18]
