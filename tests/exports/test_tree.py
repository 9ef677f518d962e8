"""Which joint of a loop the tree leaves out: what formats without loops lose."""

from __future__ import annotations

import xml.etree.ElementTree as ElementTree

import pytest
from support.devices import Z, intended
from support.export_models import design, driven_four_bar, four_bar

from kinform.exports import export
from kinform.simulation.mechanism.topology import arrange

SIDES = {
    "hinge": ("base", "crank", (0, 0, 0)),
    "pivot": ("base", "rocker", (0.1, 0, 0)),
    "elbow": ("coupler", "crank", (0.03, 0.05, 0)),
    "wrist": ("rocker", "coupler", (0.09, 0.07, 0)),
}
BODIES = {name: "~".join(sorted(sides[:2])) for name, sides in SIDES.items()}


def left_out(made) -> str:
    """The one joint of the loop that the URDF has not."""
    root = ElementTree.fromstring(export(design(made, run=False), "urdf").files["device.urdf"])
    (missing,) = set(BODIES.values()) - {joint.get("name") for joint in root.findall("joint")}
    return missing


def stated(order, **closing):
    return [
        intended(name, *SIDES[name][:2], "revolute", Z, SIDES[name][2], closure=closing.get(name, False))
        for name in order
    ]


@pytest.mark.parametrize("last", sorted(SIDES))
def test_a_loop_is_opened_at_the_joint_that_is_stated_last(last):
    order = [*sorted(set(SIDES) - {last}, reverse=True), last]
    assert left_out(four_bar(intended=stated(order))) == BODIES[last]


def test_a_joint_that_nobody_states_goes_before_those_that_are_stated():
    assert left_out(four_bar(intended=stated(["wrist", "pivot", "hinge"]))) == BODIES["elbow"]


@pytest.mark.parametrize("closing", sorted(SIDES))
def test_what_is_stated_as_closing_goes_first_wherever_it_is_stated(closing):
    order = [closing, *sorted(set(SIDES) - {closing})]
    assert left_out(four_bar(intended=stated(order, **{closing: True}))) == BODIES[closing]


def test_a_driven_joint_stays_though_it_is_stated_last():
    order = ["pivot", "elbow", "wrist", "hinge"]
    assert left_out(driven_four_bar(intended=stated(order))) == BODIES["wrist"]


def test_without_a_function_the_tree_is_that_of_the_simulation():
    pairs = [(0, 1), (0, 3), (2, 1), (2, 3)]  # base, crank, coupler, rocker
    (closing,) = arrange(4, pairs, [False] * 4, 0).closing
    assert left_out(four_bar()) == ("base~crank", "base~rocker", "coupler~crank", "coupler~rocker")[closing]
