"""Standard parts by name, shape and copies: screws, nuts, washers, pins, circlips, balls, bearings.

A name is split at everything that is no letter or digit and looked up in the words that catalogues and standards use
in several languages; of a number only what stands after DIN, ISO or GB counts. By shape, a screw is a head and a
longer, thinner shank about one axis, a washer a flat ring, a pin a plain rod, a ball a sphere; as knobs, wheels and
spacers have these shapes, too, they count only with copies of the same part, or with the drive of a screw.
"""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from kinform.foundation.algebra.vectors import norm
from kinform.foundation.words import counted
from kinform.kinematics.partition import constants
from kinform.model.arrays import Array
from kinform.model.assembly import Assembly, Part
from kinform.model.names import PartName
from kinform.model.surfaces import MeshSurfaces, Surface

WORDS = {
    "screw": "screw screws bolt bolts capscrew setscrew grubscrew shcs bhcs fhcs schraube schrauben zylinderschraube "
    "senkschraube linsenschraube sechskantschraube gewindestift vis vite viti tornillo tornillos perno parafuso skruv "
    "skrue schroef sruba śruba vint винт болт 螺丝 螺钉 螺栓 ネジ ねじ ボルト",
    "nut": "nut nuts hexnut locknut mutter muttern sechskantmutter ecrou écrou dado tuerca porca moer nakretka гайка "
    "螺母 ナット",
    "washer": "washer washers scheibe unterlegscheibe federring rondelle rondella arandela arruela bricka шайба 垫圈 "
    "ワッシャ",
    "pin": "dowel dowels dowelpin stift zylinderstift passstift goupille pasador штифт 销",
    "rivet": "rivet rivets niet nieten rivetto remache rebite заклепка 铆钉",
    "circlip": "circlip circlips seeger seegerring sicherungsring eclip snapring retainingring circlips 卡簧",
    "ball": "kugel bille sfera",
    "bearing": "bearing bearings lager kugellager wälzlager waelzlager roulement cuscinetto rodamiento rolamento "
    "подшипник 轴承 ベアリング",
}
"""Words of names, by kind."""
STANDARDS = {
    "screw": "din84 din85 din912 din913 din914 din915 din916 din931 din933 din963 din965 din7380 din7500 din7984 "
    "din7985 din7991 iso1207 iso2009 iso4014 iso4017 iso4026 iso4027 iso4028 iso4029 iso4762 iso7045 iso7046 iso7047 "
    "iso7380 iso10642 iso14579 iso14583 gb701 gb703 gb5781 gb5782 gb5783",
    "nut": "din439 din555 din562 din934 din936 din985 din6923 iso4032 iso4034 iso4035 iso7040 iso7042 iso10511 gb6170 "
    "gb6172",
    "washer": "din125 din126 din127 din433 din6798 din7349 din9021 iso7089 iso7090 iso7091 iso7092 iso7093 iso7094 "
    "gb971 gb93",
    "pin": "din1 din7 din1481 din6325 din7343 din7346 iso2338 iso2339 iso8734 iso8735 iso8752 gb1191",
    "circlip": "din471 din472 din6799 gb8941 gb8931",
    "rivet": "din660 din661 iso15973 iso15977",
    "bearing": "din625 din628 din720",
}
"""Numbers of standards, by kind."""
_KIND_OF = {word: kind for kind, words in WORDS.items() for word in words.split()}
_KIND_OF_NUMBER = {number: kind for kind, numbers in STANDARDS.items() for number in numbers.split()}
HOLDERS = ("screw", "nut", "washer", "rivet", "circlip")
"""Kinds that hold other parts together; pins may be pivots."""


@dataclass(frozen=True)
class StandardPart:
    """What a part is, and how that was told."""

    kind: str
    evidence: str


def standard_parts(assembly: Assembly, surfaces: Mapping[str, MeshSurfaces]) -> dict[PartName, StandardPart]:
    """The standard parts of an assembly, by name."""
    copies = Counter(_alike(part) for part in assembly.parts if part.mesh is not None)
    out = {}
    for part in sorted(assembly.parts, key=lambda part: part.name):
        found = _by_name(part.name)
        if found is None and part.mesh is not None and part.mesh.digest in surfaces:
            found = by_shape(surfaces[part.mesh.digest].surfaces, copies[_alike(part)])
        if found is not None:
            out[part.name] = found
    return out


def _alike(part: Part) -> tuple[int, float]:
    """What copies have in common, however they were placed: facets, and volume to five digits."""
    assert part.mesh is not None
    return len(part.mesh.faces), float(f"{abs(part.mesh.health.volume or 0.0):.5g}")


def _by_name(name: str) -> StandardPart | None:
    """By the last word of the name that says what it is: "bearing screw" is a screw."""
    leaf = name.rsplit("/", 1)[-1]
    words = [word for word in re.split(r"[\W_]+", re.sub(r"(?<=[a-z])(?=[A-Z])", " ", leaf).lower()) if word]
    for k, word in enumerate(words[:-1]):
        if word in ("din", "iso", "gb", "en"):
            digits = words[k + 1] if words[k + 1] not in ("t", "en", "iso") else words[min(k + 2, len(words) - 1)]
            kind = _KIND_OF_NUMBER.get(("din" if word == "din" else "gb" if word == "gb" else "iso") + digits)
            if kind is not None:
                return StandardPart(kind, f"named {word.upper()} {digits}")
    for word in reversed(words):
        kind = _KIND_OF.get(word) or _KIND_OF_NUMBER.get(word)
        if kind is not None:
            return StandardPart(kind, f"named '{word}'")
    return None


def by_shape(surfaces: Sequence[Surface], copies: int) -> StandardPart | None:
    """By its surfaces, and by how many parts are like it."""
    total = sum(surface.area for surface in surfaces)
    if sum(s.area for s in surfaces if s.kind == "sphere" and s.side > 0) > constants.BALL_AREA * total:
        return StandardPart("ball", f"a sphere, {counted(copies, 'copy', 'copies')}") if copies >= 3 else None
    round_ = [s for s in surfaces if s.kind == "cylinder" and s.sweep > constants.ALL_ROUND]
    if not round_:
        return None
    main = max(round_, key=lambda s: s.area)
    if _turned(surfaces, main) < constants.TURNED * total:
        return None
    rods = [s for s in round_ if s.side > 0 and _coaxial(s, main)]
    bores = [s for s in round_ if s.side < 0 and _coaxial(s, main)]
    hexagon = _hexagon(surfaces, main.axis)
    many = f"{counted(copies, 'copy', 'copies')} of it"
    if not rods:
        flats = _flats(surfaces, main)
        wide = 2.0 * max(flats, default=0.0)
        nut = (
            len(bores) == 1
            and hexagon
            and len(flats) == 6
            and _reach(surfaces, main.axis) < constants.NUT_HEIGHT * wide
        )
        return StandardPart("nut", f"a hexagon with a bore, {many}") if nut and copies >= 2 else None
    high, low = max(s.radius for s in rods), min(s.radius for s in rods)
    length = max(s.extent[1] - s.extent[0] for s in rods if s.radius == low)
    whole = _reach(surfaces, main.axis)
    if bores:
        flat = whole < constants.WASHER_HEIGHT * high and len(rods) == len(bores) == 1 and not hexagon
        return StandardPart("washer", f"a flat ring, {many}") if flat and copies >= 3 else None
    head = constants.HEAD[0] * low <= high <= constants.HEAD[1] * low and length >= constants.SHANK * low
    if head and (hexagon or copies >= 3):
        drive = "with a hexagon, " if hexagon else ""
        return StandardPart("screw", f"a head and a shank, {drive}{many}")
    if hexagon and len(rods) == 1 and length >= constants.SHANK * low and copies >= 2:
        return StandardPart("screw", f"a hexagon and a shank, {many}")
    if len(rods) == 1 and whole >= constants.PIN_LENGTH * high and copies >= 3 and not hexagon:
        only = sum(s.area for s in surfaces if s.kind in ("cylinder", "plane", "cone", "torus"))
        plain = only > 0.98 * total and len([s for s in surfaces if s.kind == "plane"]) == 2
        return StandardPart("pin", f"a plain rod, {many}") if plain else None
    return None


def _flats(surfaces: Sequence[Surface], main: Surface) -> list[float]:
    """m: how far the planes along the axis of the main cylinder lie beside it."""
    beside = [s for s in surfaces if s.kind == "plane" and abs(float(s.axis @ main.axis)) < 0.05]
    return [abs(float((s.point - main.point) @ s.axis)) for s in beside]


def _turned(surfaces: Sequence[Surface], main: Surface) -> float:
    """m²: what is turned about the axis of its main cylinder, lies across it, or is a flat along it close by."""
    rods = [s.radius for s in surfaces if s.kind == "cylinder" and s.side > 0 and _coaxial(s, main)]
    flats = _flats(surfaces, main)
    reach = max(rods) if rods else max(flats, default=0.0) if len(flats) == 6 else 0.0
    area = 0.0
    for s in surfaces:
        if s.kind == "plane":
            along = abs(float(s.axis @ main.axis))
            close = abs(float((s.point - main.point) @ s.axis)) <= 1.01 * reach
            area += s.area if along > 0.999 or (along < 0.05 and close) else 0.0
        elif s.kind in ("cylinder", "cone", "torus", "revolution", "helicoid"):
            gap = s.point - main.point
            off = norm(gap - (gap @ main.axis) * main.axis)
            on = off < constants.COAXIAL_OFF * main.radius and abs(float(s.axis @ main.axis)) > 0.999
            area += s.area if on else 0.0
        elif s.kind == "sphere":
            gap = s.point - main.point
            area += s.area if norm(gap - (gap @ main.axis) * main.axis) < 0.1 * main.radius else 0.0
    return area


def _coaxial(one: Surface, other: Surface) -> bool:
    gap = one.point - other.point
    off = norm(gap - (gap @ other.axis) * other.axis)
    return abs(float(one.axis @ other.axis)) > np.cos(constants.COAXIAL) and off < constants.COAXIAL_OFF * one.radius


def _hexagon(surfaces: Sequence[Surface], axis: Array) -> bool:
    """Whether six planes stand round the axis, at equal distances, 60° from each other."""
    beside = [s for s in surfaces if s.kind == "plane" and abs(float(s.axis @ axis)) < np.sin(constants.COAXIAL)]
    if len(beside) < 6:
        return False
    for first in beside:
        turned = [float(s.axis @ first.axis) for s in beside]
        if all(any(abs(t - c) < constants.HEXAGON for t in turned) for c in (1.0, 0.5, -0.5, -1.0)):
            return len(turned) >= 6
    return False


def _reach(surfaces: Sequence[Surface], axis: Array) -> float:
    """How long the part is along its axis, by the planes across it and what is round."""
    ends = [float(s.point @ axis) for s in surfaces if s.kind == "plane" and abs(float(s.axis @ axis)) > 0.999]
    for s in surfaces:
        if s.kind == "cylinder" and abs(float(s.axis @ axis)) > 0.999:
            ends += [float((s.point + t * s.axis) @ axis) for t in s.extent]
    return max(ends) - min(ends) if ends else 0.0
