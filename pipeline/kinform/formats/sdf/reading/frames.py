"""Frames of an SDF: each stands in another one of its model, or in the world; and to which link each is attached.

Names are full ones, "outer::inner::name", as SDFormat scopes them; "" is the world. A model has the frame
"model::__model__", and its own name for it. Reference: SDFormat, "Pose Frame Semantics" (sdformat.org, 1.7 and later).
"""

from __future__ import annotations

from collections.abc import Container

import numpy as np

from kinform.formats.description.elements import Element, Xml
from kinform.foundation.algebra.displacements import inverse
from kinform.foundation.name_hints import did_you_mean, in_quotes
from kinform.frozen import dataclass
from kinform.model.arrays import Array

WORLD = ""
MODEL = "__model__"


@dataclass(frozen=True, eq=False)
class Frame:
    """A frame where it is stated."""

    scope: str
    """The prefix of the names that it can say, "outer::"."""
    relative: str
    """The name, as stated, of the frame in which its pose is."""
    X: Array
    """(4, 4), its pose there."""
    element: Element
    attached: str | None = None
    """The name, as stated, of what it is fixed to; None: a link itself."""
    placed: str | None = None
    """Of a model whose frame of this name is to have the pose."""


class Frames:
    """All frames of a file, by their full names."""

    def __init__(self, xml: Xml):
        self._xml = xml
        self._frames: dict[str, Frame] = {}
        self._poses: dict[tuple[str, str], Array | None] = {}
        self._links: dict[str, str | None] = {}
        """By name of a frame the link that it is attached to."""

    def add(self, name: str, frame: Frame) -> None:
        """A frame; what had the name before keeps it: links before joints."""
        self._frames.setdefault(name, frame)

    def full(self, scope: str, stated: str, element: Element, what: str) -> str | None:
        """The full name of a frame that is stated in a scope; None after noting that there is none."""
        if stated in ("", "world", "__root__"):
            return WORLD
        name = scope + stated
        if name in self._frames:
            return name
        if stated == MODEL and not scope:
            return WORLD
        known = [other.removeprefix(scope) for other in self._frames if other.startswith(scope)]
        self._xml.complain(
            element, f"{what} {in_quotes(stated)} is not there", did_you_mean(stated, known, "the frames")
        )
        return None

    def pose(self, name: str) -> Array | None:
        """(4, 4) in the world; None after noting why there is none."""
        return self._pose(name, WORLD)

    def link_of(self, name: str, links: Container[str]) -> str | None:
        """The link that a frame is attached to, "" for the world; None after noting why there is none. The `links` are
        the same each time."""
        chain: dict[str, None] = {}
        end: str | None = name
        while end is not None and end not in links and end != WORLD:
            if end in self._links:
                end = self._links[end]
                break
            end = self._attached(end, chain)
        self._links |= dict.fromkeys(chain, end)
        return end

    def _attached(self, name: str, chain: dict[str, None]) -> str | None:
        """What a frame is attached to, which is added to the chain; None after noting why there is nothing."""
        frame = self._frames[name]
        if name in chain:
            wrong = f"frames are attached to each other in a circle: {in_quotes(name)}"
            self._xml.complain(frame.element, wrong, "attach one of them to a link")
            return None
        chain[name] = None
        if frame.attached is None:
            self._xml.complain(frame.element, f"{in_quotes(name)} is attached to no link", "name a link")
            return None
        return self.full(frame.scope, frame.attached, frame.element, "attached_to")

    def _pose(self, name: str, base: str) -> Array | None:
        """(4, 4) of a frame in `base`, which is the world or the model that it is in."""
        chain: dict[str, None] = {}
        here: str | None = name
        while here is not None and here != base and (here, base) not in self._poses:
            here = self._relative(here, base, chain)
        X = np.eye(4) if here == base else None if here is None else self._poses[here, base]
        for below in reversed(chain):
            X = self._poses[below, base] = None if X is None else self._composed(below, X)
        return X

    def _relative(self, name: str, base: str, chain: dict[str, None]) -> str | None:
        """The frame in which a frame is posed, which is added to the chain; None after noting why there is none."""
        if name == WORLD:
            wrong = "placement_frame is posed relative to the world, outside of its model"
            self._xml.complain(self._frames[base].element, wrong, "name a frame that is posed relative to the model")
            return None
        frame = self._frames[name]
        if name in chain:
            names = list(chain)
            circle = " → ".join(in_quotes(other) for other in (*names[names.index(name) :], name))
            self._xml.complain(frame.element, f"poses are relative to each other in a circle: {circle}",
                               "state one of them relative to the model")  # fmt: skip
            return None
        chain[name] = None
        return self.full(frame.scope, frame.relative, frame.element, "the pose: its relative_to")

    def _composed(self, name: str, X: Array) -> Array | None:
        """The pose of a frame of which what it is relative to has the pose X."""
        frame = self._frames[name]
        out = X @ frame.X
        if frame.placed is not None:
            full = self.full(name.removesuffix(MODEL), frame.placed, frame.element, "placement_frame")
            X_MP = None if full is None else self._pose(full, name)
            return None if X_MP is None else np.asarray(out @ inverse(X_MP))
        return np.asarray(out)
