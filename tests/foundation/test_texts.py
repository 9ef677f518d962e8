"""Texts are what they look like: no line, name or element that a person who reads them does not see."""

from __future__ import annotations

from pathlib import Path

import pytest

from kinform.errors import InputError
from kinform.form import load
from kinform.form.recognition import is_design
from kinform.foundation.texts import TextError, parse_json, read_text
from kinform.foundation.xml_root import is_plain

MANIFEST = 'schema = 1\n[assembly]\nname = "a"\nunits = "mm"\n[[part]]\nname = "p"\n'
HIDDEN = '# the end\r[[check.ignore]]\rcode = "KF301"\rreason = "x"\n'


@pytest.mark.parametrize("text", [MANIFEST + HIDDEN, (MANIFEST + HIDDEN).replace("\n", "\r")])
def test_a_carriage_return_ends_no_comment_of_a_manifest(tmp_path: Path, text: str):
    path = tmp_path / "m.toml"
    path.write_bytes(text.encode())
    with pytest.raises(InputError) as caught:
        load(path)
    assert caught.value.problems[0].file == "m.toml"
    assert is_design(path)


def test_other_ends_of_lines_are_read(tmp_path: Path):
    path = tmp_path / "m.toml"
    path.write_bytes(MANIFEST.replace("\n", "\r\n").encode())
    assert load(path).name == "a"
    path.write_bytes(b"0,1\r1,2\r")
    assert read_text(path, 100, "a table").split() == ["0,1", "1,2"]
    path.write_bytes(b"0,1\n1,2\r2,3\n")
    with pytest.raises(TextError):
        read_text(path, 100, "a table")


def test_a_name_that_json_gives_twice_is_refused():
    assert parse_json('{"a": {"b": 1}, "b": 2}') == {"a": {"b": 1}, "b": 2}
    for text in ('{"a": 1, "b": 2, "a": 1}', '[{"b": {"a": 1, "\\u0061": 2}}]'):
        with pytest.raises(ValueError, match="a"):
            parse_json(text)


def test_a_description_in_an_encoding_that_hides_elements_is_refused(tmp_path: Path):
    hidden = "<!-- +AC0ALQA+- +ADw-link name=+ACI-b+ACI-/+AD4 +ADwAIQAtAC0- -->"
    path = tmp_path / "r.urdf"
    path.write_text(f'<?xml version="1.0" encoding="UTF-7"?>\n<robot name="r"><link name="a"/>{hidden}</robot>')
    with pytest.raises(InputError) as caught:
        load(path)
    assert caught.value.problems[0].line == 1
    assert is_design(path)
    for name in ("UTF-8", "utf_8", "UTF-16LE", "iso-8859-15", "windows-1252", "GB2312", "Shift_JIS", None):
        assert is_plain(name)
    for name in ("UTF-7", "ISO-2022-JP", "HZ", "unicode-1-1-utf-7", "IBM037"):
        assert not is_plain(name)
