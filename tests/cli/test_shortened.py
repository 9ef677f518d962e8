"""The overview of a large design: the beginning of each topic, and the command that shows all of it."""

from __future__ import annotations

import io
import re
from dataclasses import replace

import pytest
from rich.console import Console
from rich.text import Text
from support.places import FIXTURES

from kinform_cli.shortened import MOST_OF_TOPIC, Shortened
from kinform_cli.tables import Rows, stacked
from kinform_cli.views import assembly, joints, mobility


def drawn(item: object) -> list[str]:
    file = io.StringIO()
    Console(file=file, width=80).print(item)
    return [line.rstrip() for line in file.getvalue().splitlines()]


def table(rows: int) -> Rows:
    made = Rows("name", "count")
    for k in range(rows):
        made.add(f"pin{k}", str(k))
    return made


def test_what_is_hardly_longer_than_the_limit_is_shown_whole():
    whole = drawn(table(MOST_OF_TOPIC + 2))
    assert drawn(Shortened(table(MOST_OF_TOPIC + 2), "never")) == whole


def test_of_a_long_table_the_first_lines_and_the_remedy_are_shown():
    got = drawn(stacked("before", Shortened(table(5000), "`kinform show a.h5 joints`"), "after"))
    whole = drawn(table(5000))
    assert got[0] == "before"
    assert got[1 : MOST_OF_TOPIC + 1] == whole[:MOST_OF_TOPIC]
    assert got[MOST_OF_TOPIC + 1 :] == ["… and more: `kinform show a.h5 joints`", "after"]


def test_lines_beyond_are_not_even_drawn():
    asked = []

    class Endless:
        def __rich_console__(self, console, options):
            for k in range(10**9):
                asked.append(k)
                yield Text(str(k))

    assert len(drawn(Shortened(Endless(), "more"))) == MOST_OF_TOPIC + 1
    assert len(asked) < 2 * MOST_OF_TOPIC


@pytest.fixture(scope="module")
def large(derive_design):
    """The design of a revolute pair with each part, joint and freedom a hundred times."""
    design = derive_design(FIXTURES / "pairs" / "revolute_collars" / "revolute_collars.toml")
    found = design.kinematics
    times = range(100)
    parts = design.assembly.parts
    parts = (*parts, *(replace(part, name=f"{part.name}{k:02}") for part in parts for k in times))
    joints = (*found.joints, *(replace(joint, name=f"{joint.name}{k:02}") for joint in found.joints for k in times))
    counts = replace(found.mobility, named=found.mobility.named * 100, idle_bodies=tuple(f"pin{k}" for k in times))
    kinematics = replace(found, joints=joints, mobility=counts)
    return replace(design, assembly=replace(design.assembly, parts=parts), kinematics=kinematics)


@pytest.mark.parametrize("topic", [assembly, joints, mobility])
def test_a_topic_in_short_begins_as_the_whole_of_it_and_goes_on_long_enough_to_say_so(topic, large):
    whole, short = (drawn(Shortened(topic.render(large, short=way), "all")) for way in (False, True))
    assert whole[-1] == short[-1] == "… and more: all"
    different = [(a, b) for a, b in zip(whole, short, strict=False) if a != b]
    assert not different or (topic is mobility and "pin0" in different[0][1])
    assert len(drawn(topic.render(large, short=True))) < len(drawn(topic.render(large)))


def test_the_first_bodies_that_idle_are_named_in_short_and_the_others_counted(large):
    short, whole = (" ".join(drawn(mobility.render(large, short=way))) for way in (True, False))
    named = re.findall(r"\bpin\d+", short)
    assert named == [f"pin{k}" for k in range(len(named))]
    assert re.search(rf"pin{len(named) - 1} \D*{100 - len(named)}\b", short)
    assert "pin99" in whole and "pin99" not in short
