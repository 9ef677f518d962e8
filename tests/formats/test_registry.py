"""The registry of formats: what it names is there, and the root element decides among formats of one suffix."""

from __future__ import annotations

from importlib import import_module
from pathlib import Path

import pytest

from kinform.exports import FORMATS
from kinform.form.sources import is_scene, is_source, states_units
from kinform.formats.registry import ROBOT_FORMATS, SCENE_FORMATS, WRITTEN, edits_of, reader_of, reader_of_text


@pytest.mark.parametrize("format", ROBOT_FORMATS, ids=lambda format: format.title)
def test_the_root_element_chooses_the_reader_among_formats_of_a_suffix(format):
    read = import_module(f"kinform.formats.{format.reader}").read
    for suffix in format.suffixes:
        assert is_source(Path(f"a{suffix}")) and not is_scene(Path(f"a{suffix}"))
        assert reader_of(Path(f"a{suffix}"), f"<?xml version='1.0'?><!-- <x> -->\n<{format.root}>".encode()) is read
    assert reader_of(Path("a.xml"), b"<other/>") is None


@pytest.mark.parametrize("name", WRITTEN)
def test_a_format_that_is_written_has_a_writer_edits_and_a_reader_of_what_is_written_back(name):
    assert callable(FORMATS[name].write) and callable(reader_of_text(name))
    assert {"write_range", "write_inertial", "write_folder"} <= set(vars(edits_of(name)))


@pytest.mark.parametrize("format", SCENE_FORMATS, ids=lambda format: format.name)
def test_a_scene_format_has_its_reader(format):
    assert callable(getattr(import_module(f"kinform.{format.module}"), format.function))
    for suffix in format.suffixes:
        assert is_scene(Path(f"a{suffix}"))
        assert states_units(Path(f"a{suffix}")) is not format.unitless
