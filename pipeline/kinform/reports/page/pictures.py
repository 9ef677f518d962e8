"""Pictures of the assembly and of findings, without a graphics card, for pull requests and for print.

Whole parts in the colours of their bodies; a finding's parts in full, everything else faint, what it is about
marked by a ring, overlaps red. The background is transparent. Each shape is drawn once (`figures`), and the pictures
are put together from it (`canvas`).
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from functools import cached_property

import numpy as np

from kinform.frozen import dataclass
from kinform.model.arrays import Array
from kinform.reports.constants import FINDING_MARGIN, FINDING_SHIFT, FINDING_ZOOM, OVERLAP_COLOUR
from kinform.reports.page.canvas import (
    FINER,
    OUTLINE_STEP,
    Shown,
    coarse,
    layer,
    nearness,
    over,
    paint,
    smaller,
    whole_numbers,
)
from kinform.reports.page.figures import Figure
from kinform.reports.page.focus import Focus
from kinform.reports.page.raster import AXES, VIEW_MARGIN, View, png, view_of
from kinform.reports.page.scene import Scene
from kinform.reports.page.strokes import dashed, polylines, rgb, ring, strokes_of

MOST_PICTURES = 24
"""Errors and warnings with a picture on the page; the others can be shown in the interactive view. Chosen,
not measured: the page stays a few megabytes."""
OVERVIEW_WIDTH, OVERVIEW_HEIGHT = 960, 600
"""px, of the picture of the whole. Chosen by eye."""
PICTURE_WIDTH, PICTURE_HEIGHT = 480, 320
"""px, of the picture of a finding. Chosen by eye."""
SIGNS_MARGIN = 1.5
"""Size of a picture over that of what it holds where only signs of joints are drawn, which have a size of their own.
Chosen by eye."""
FAINT = 0.22
"""Weight of what a finding is not about. Chosen by eye, as the next two."""
GLASS = 0.35
"""Weight of a part that stands before the place where it meets another."""
TINT = 0.4
"""Share of red in parts that meet. Chosen by eye."""
OVERLAP_WEIGHT, FINDING_OVERLAP_WEIGHT = 0.75, 0.8
"""Weights of overlaps over the whole, and over what a finding is about. Chosen by eye."""


@dataclass(frozen=True, eq=False)
class _Stage:
    """What the picture of a finding shows: parts in full and others, where bodies are, and from where it is seen."""

    chosen: Shown
    others: Shown
    moved: Mapping[str, Array]
    """Displacements of bodies."""
    names: frozenset[str]
    """Of the parts in full."""
    place: Array | None
    """(3,) m, of the ring, in the axes of the eye."""
    view: View


class Artist:
    """Draws one scene; what parts look like from the eye's side is worked out once."""

    def __init__(self, scene: Scene):
        self.scene = scene
        self.known: dict[str, Figure] = {}
        self.drawn: dict[int, bytes] = {}
        self.wholes: dict[tuple[int, int], bytes] = {}

    def overview(self, width: int = OVERVIEW_WIDTH, height: int = OVERVIEW_HEIGHT) -> bytes:
        """The whole assembly with the axes of its joints, overlaps in red, as PNG; drawn once of each size."""
        if (width, height) not in self.wholes:
            self.wholes[width, height] = self._overview(width, height)
        return self.wholes[width, height]

    def _overview(self, width: int, height: int) -> bytes:
        figures, signs = self._whole()
        if not figures and not signs:
            return png(np.zeros((height, width, 4), np.uint8))
        view = _whole_view(figures, signs, width, height)
        image = layer(view, figures)
        paint(image, view, self._red(lambda parts: True), OVERLAP_WEIGHT)
        polylines(image, [view.project(stroke)[:, :2] for stroke in signs], 2.0 * FINER)
        return png(whole_numbers(smaller(image)))

    def _whole(self) -> tuple[Shown, list[Array]]:
        """All parts, and the lines (n, 3) of the signs of joints, in the axes of the eye."""
        signs = [
            stroke @ AXES.T for joint in self.scene.joints for stroke in strokes_of(joint, *self.scene.sign_of(joint))
        ]
        return self._figures([part.name for part in self.scene.design.assembly.parts]), signs

    def finding(self, index: int) -> bytes:
        """What a finding is about, as PNG; drawn once."""
        if index not in self.drawn:
            if not self.drawn:
                self._prepare()
            self.drawn[index] = self._finding(self.scene.focuses[index])
        return self.drawn[index]

    def _prepare(self) -> None:
        """Tell figures how fine the errors and warnings of a page, and the whole, will want them, so that each is drawn
        once for all."""
        report = self.scene.design.report
        whole = _whole_view(*self._whole(), OVERVIEW_WIDTH, OVERVIEW_HEIGHT)
        for figure in self.known.values():
            figure.expect(whole)
        findings = report.findings[:MOST_PICTURES] if report else ()
        for finding, focus in zip(findings, self.scene.focuses, strict=False):
            if finding.severity != "note" and focus.movement < 0:
                stage = self._stage(focus)
                if stage is not None:
                    for figure, _ in stage.chosen:
                        figure.expect(stage.view)
                    for figure, _ in stage.others:
                        figure.expect(coarse(stage.view))

    def _stage(self, focus: Focus) -> _Stage | None:
        """What the picture of a finding shows; None where there is nothing to be seen."""
        scene = self.scene
        moved = scene.movements[focus.movement].at(focus.time) if focus.movement >= 0 else {}
        ends = {body for joint in scene.joints if joint.name in focus.joints for body in joint.bodies}
        parts = [*focus.parts, *(p for body in scene.bodies if body.name in ends for p in body.parts)]
        names = [part.name for part in scene.design.assembly.parts]
        chosen, rest = [n for n in names if n in parts], [n for n in names if n not in parts]
        if not chosen:
            chosen, rest = names, []
        figures = self._figures(chosen, moved, focus.meeting)
        if not figures:
            return None
        view = view_of(
            np.concatenate([figure.box for figure, _ in figures]),
            FINER * PICTURE_WIDTH,
            FINER * PICTURE_HEIGHT,
            margin=FINDING_MARGIN,
        )
        place = None if focus.place is None else AXES @ focus.place
        if place is not None:
            view = replace(
                view,
                target=(1.0 - FINDING_SHIFT) * view.target + FINDING_SHIFT * place,
                scale=FINDING_ZOOM * view.scale,
            )
        return _Stage(figures, self._figures(rest, moved), moved, frozenset(chosen), place, view)

    def _finding(self, focus: Focus) -> bytes:
        stage = self._stage(focus)
        if stage is None:
            return png(np.zeros((PICTURE_HEIGHT, PICTURE_WIDTH, 4), np.uint8))
        view, place = stage.view, stage.place
        before = [
            item for item in stage.chosen if focus.meeting and place is not None and _covers(view, item[0], place)
        ]
        image = layer(view, [item for item in stage.chosen if item not in before] or before)
        if 0 < len(before) < len(stage.chosen):
            paint(image, view, before, GLASS)
        red = self._red(lambda both: not stage.moved and set(both) <= stage.names)
        paint(image, view, red, FINDING_OVERLAP_WEIGHT)
        for joint in self.scene.joints:
            if joint.name in focus.joints and joint.axis is not None and not stage.moved:
                point, size = self.scene.sign_of(joint)
                ends_of_axis = np.array([point - 1.6 * size * joint.axis, point + 1.6 * size * joint.axis])
                dashed(image, view.project(ends_of_axis @ AXES.T)[:, :2], 2.0 * FINER)
        if place is not None:
            ring(image, view.project(place[None])[0, :2], 15.0 * FINER, 2.0 * FINER)
        image = smaller(image)
        if stage.others:
            image = over(image, layer(coarse(view), stage.others), 1.0, FAINT)
        return png(whole_numbers(image))

    def _figures(
        self, names: Sequence[str], moved: Mapping[str, Array] | None = None, meeting: Sequence[str] = ()
    ) -> Shown:
        """Parts in the colours of their bodies, those that meet in red; `moved` are displacements of bodies."""
        wanted = set(names)
        out = []
        for part in self.scene.design.assembly.parts:
            if part.mesh is None or part.name not in wanted or not len(part.mesh.faces):
                continue
            body = self.scene.body_index[part.name]
            colour = rgb(self.scene.colours[body])
            if part.name in meeting:
                colour = tuple(
                    (1.0 - TINT) * own + TINT * red for own, red in zip(colour, rgb(OVERLAP_COLOUR), strict=True)
                )  # type: ignore[assignment]
            away = (moved or {}).get(self.scene.bodies[body].name)
            figure = self.known.get(part.name) if away is None else None
            if figure is None:
                health = part.mesh.health
                closed = health.watertight and health.consistent_winding and health.volume > 0.0
                pose = part.X_WP if away is None else away @ part.X_WP
                figure = Figure(self.scene.shapes[part.mesh.digest], pose, closed)
                if away is None:
                    self.known[part.name] = figure
            out.append((figure, colour))
        return out

    def _red(self, wanted: Callable[[tuple[str, str]], bool]) -> Shown:
        """Overlaps of the wanted pairs of parts."""
        return [(figure, rgb(OVERLAP_COLOUR)) for both, figure in self._overlaps if wanted(both)]

    @cached_property
    def _overlaps(self) -> list[tuple[tuple[str, str], Figure]]:
        found = [] if self.scene.design.contacts is None else self.scene.design.contacts.interferences
        return [
            (item.parts, Figure(shape, np.eye(4), False))
            for item, shape in zip(found, self.scene.overlaps, strict=True)
            if shape is not None and len(shape.faces)
        ]


def _whole_view(figures: Shown, signs: list[Array], width: int, height: int) -> View:
    """From where everything is seen."""
    return view_of(
        np.concatenate([*signs, *(figure.box for figure, _ in figures)]),
        FINER * width,
        FINER * height,
        VIEW_MARGIN if figures else SIGNS_MARGIN,
    )


def _covers(view: View, figure: Figure, place: Array) -> bool:
    """Whether the figure stands between the eye and the place, given in the axes of the eye."""
    x, y, near = view.project(place[None])[0]
    return nearness(view, figure, int(x), int(y)) > float(near + OUTLINE_STEP / view.scale)
