"""A batch reads no design through a link out of its folder, and writes neither results nor its record through one."""

from __future__ import annotations

from pathlib import Path

import pytest

from kinform.batch import record, session
from kinform.batch.discovery import Found
from kinform.batch.record import Record
from kinform.batch.session import Settings
from kinform.batch.task import INPUT
from kinform.batch.work import refuse_outside
from kinform.errors import InputError, ResultsError


def test_a_design_that_is_a_link_out_is_refused(tmp_path: Path):
    (tmp_path / "designs").mkdir()
    for name in ("m.toml", "designs/own.toml"):
        (tmp_path / name).write_text("")
    (tmp_path / "designs" / "link.toml").symlink_to("../m.toml")
    (tmp_path / "designs" / "near.toml").symlink_to("own.toml")
    link = str(tmp_path / "designs" / "link.toml")
    with pytest.raises(InputError):
        refuse_outside(link, allow_outside=False)
    refuse_outside(link, allow_outside=True)
    refuse_outside(str(tmp_path / "designs" / "near.toml"), allow_outside=False)


def test_the_record_is_not_written_through_a_link(tmp_path: Path):
    (tmp_path / "r").mkdir()
    (tmp_path / "r" / record.NAME).symlink_to("../precious")
    with pytest.raises(ResultsError):
        record.read(tmp_path / "r")
    with pytest.raises(ResultsError):
        record.write(Record(), tmp_path / "r")
    assert not (tmp_path / "precious").exists()


@pytest.mark.parametrize("name", ["a/m.toml", "m.toml"])
def test_results_are_not_written_through_a_link(tmp_path: Path, name: str):
    (tmp_path / "r").mkdir()
    (tmp_path / "out").mkdir()
    found = Found(tmp_path / name, name)
    link = (tmp_path / "r" / found.results).parent if "/" in name else tmp_path / "r" / found.results
    link.symlink_to(tmp_path / "out" / ("" if "/" in name else "m.h5"))
    (row,) = session.run([found], tmp_path / "r", Settings())
    assert row.failure == INPUT
    assert list((tmp_path / "out").iterdir()) == []
