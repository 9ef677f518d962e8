"""Blocks of loops that are tried in step have the motions that each has alone, to the last bit."""

from __future__ import annotations

import numpy as np
import pytest
from support.devices import joint
from support.linkages import KNOWN, generic, planar

from kinform.kinematics.mobility.finite_motion import finite_mobility
from kinform.kinematics.mobility.local_dimension import local_motions, local_motions_of_each
from kinform.mechanism.frame import joint_frame
from kinform.mechanism.loop_system import loop_system
from kinform.reuse.packing import pack

TABLE = {name: mechanism for name, (mechanism, *_) in KNOWN.items()}


def linkages(rng):
    """Mechanisms of the literature, regular and singular, and many with the loops of each other: flat four-bars and
    five-bars, folded ones among them, and spatial ones."""
    out = list(TABLE.values())
    for bars in (4, 4, 4, 5):
        out += [planar(*rng.normal(size=(bars, 2))) for _ in range(3)]
        out.append(planar(*[(x, 0.0) for x in rng.normal(size=bars)]))
    return out + [generic(bars, seed) for bars in (6, 7, 8) for seed in range(2)]


def built(mechanism):
    """Its joints, and the bodies that they join, by number."""
    joints = [joint(a, b, kind, axis, point, axis2) for a, b, kind, axis, point, axis2 in mechanism]
    names = sorted({name for one in joints for name in one.bodies})
    return joints, [(names.index(a), names.index(b)) for a, b in (one.bodies for one in joints)]


def system(mechanism):
    joints, edges = built(mechanism)
    return loop_system(edges, [one.twists for one in joints], joint_frame(joints, 5.0))


@pytest.mark.parametrize("seed", [0, *(pytest.param(k, marks=pytest.mark.sweep) for k in range(1, 6))])
def test_motions_do_not_depend_on_what_is_tried_with_them(seed):
    rng = np.random.default_rng(seed)
    systems = [system(mechanism) for mechanism in linkages(rng)]
    alone = [pack(local_motions(one)) for one in systems]
    assert len(set(alone)) > 30  # so that none could be taken for another
    chosen = rng.permutation(len(systems))[: int(rng.integers(2, len(systems) + 1))].tolist()
    assert [pack(motions) for motions in local_motions_of_each([systems[k] for k in chosen])] == [
        alone[k] for k in chosen
    ]


def test_of_many_on_one_frame_each_has_the_certificate_that_it_has_alone():
    rng = np.random.default_rng(0)
    joints, alone, first = [], {}, 0
    for k, mechanism in enumerate(linkages(rng)):
        named = [(*(body if body == "base" else f"{k} {body}" for body in one[:2]), *one[2:]) for one in mechanism]
        members, between = built(named)
        count = sum(one.freedoms for one in members)
        found = finite_mobility(between, members, 1 + max(map(max, between)), count, 5.0)
        alone |= {certificate.joints: pack(certificate) for certificate in found.certificates}
        first += sum(certificate.instantaneous for certificate in found.certificates)
        joints += members
    names = sorted({name for one in joints for name in one.bodies})
    edges = [(names.index(a), names.index(b)) for a, b in (one.bodies for one in joints)]
    together = finite_mobility(edges, joints, len(names), first, 5.0)
    assert len(alone) > 30
    assert {certificate.joints: pack(certificate) for certificate in together.certificates} == alone
