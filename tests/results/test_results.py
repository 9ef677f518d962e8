"""Everything in the model survives the results file, to the last bit."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from unittest import mock

import pytest
from hypothesis import HealthCheck, Phase, given, settings
from support.designs import arrays_in, designs, difference

from kinform import results
from kinform.design import Design

SETTINGS = settings(
    max_examples=4,
    deadline=None,
    phases=[Phase.generate],  # these values are too large to be shrunk in good time
    suppress_health_check=[HealthCheck.too_slow, HealthCheck.data_too_large, HealthCheck.large_base_example],
)


def _through_file(design: Design, folder: Path) -> Design:
    path = folder / "r.h5"
    results.write(design, path)
    return results.read(path)


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("round_trip")


@pytest.fixture(scope="module", autouse=True)
def no_sense_is_asked_for() -> Iterator[None]:
    """These designs are any numbers and texts: they say nothing that holds together."""
    with mock.patch("kinform.results.at_need.check_group"):
        yield


@SETTINGS
@given(design=designs())
def test_a_design_comes_back_bit_for_bit_and_is_written_again_as_the_same_bytes(design: Design, folder: Path) -> None:
    again = _through_file(design, folder)
    assert difference(design, again) is None
    assert results.to_bytes(again) == (folder / "r.h5").read_bytes()
    assert not any(array.flags.writeable for array in arrays_in(again))
