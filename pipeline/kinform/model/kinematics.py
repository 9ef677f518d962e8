"""Behaviour without forces: bodies, joints, constraints, mobility. World frame, SI and radians.

Twists are (ω; v), v the velocity of the point at the world's origin.
"""

from __future__ import annotations

from collections.abc import Iterable
from collections.abc import Set as AbstractSet
from dataclasses import field
from functools import cached_property
from typing import Annotated, Literal, get_args

import numpy as np

from kinform.frozen import dataclass
from kinform.model.arrays import Array, Ints
from kinform.model.names import BodyName, JointName, PartName
from kinform.model.quantities import (
    Direction,
    JointValue,
    Lead,
    Metres,
    PartPair,
    Place,
    Radians,
    Ratio,
    SquareMetres,
    columns,
)

JointType = Literal[
    "fixed", "revolute", "prismatic", "cylindrical", "spherical", "planar", "screw", "universal", "general"
]
"""The lower pairs, a universal joint, and `general` for any other space of motions."""
JOINT_TYPES: tuple[JointType, ...] = get_args(JointType)
JointStatus = Literal["determined", "inferred", "stated", "ambiguous", "blocked"]
"""determined: by contact. inferred: contact admits it, and something else chose it. stated: taken from the function.
ambiguous: contact does not decide. blocked: contact decides when a few patches are left out."""
STATUSES: tuple[JointStatus, ...] = get_args(JointStatus)
MotionKind = Literal["turn", "slide", "screw"]
ReadingCause = Literal["", "stop", "sliver", "flank", "prism", "pin", "bend", "contact", "end", "doubt"]
"""What the faces are that a reading leaves out: stop, sliver, flank; prism where flats are those of one; pin where it
has clearance in its slot; bend where a roller in its ring turns less over a distance than at the first instant. Of a
joint that is taken as stated, how contact leaves it: contact (free), end (free in one sense) or doubt. Else empty."""
CurvatureVerdict = Literal["", "extends", "partly", "obstructed"]
"""Freedoms that the curvature of the closure allows: extends (all), partly (some directions), obstructed (none); empty
where it was not tested."""
RedundancyKind = Literal["pair", "loop", "loops", "block"]
"""pair (contacts of one joint), loop, loops (several together), or block (spread, not told apart)."""
CouplingKind = Literal["gear", "rack", "screw", "cam"]
"""Of a cam the ratio is that of this pose."""
CouplingStatus = Literal["determined", "ambiguous"]
MembershipCause = Literal["held", "cut", "nearest"]
"""held: one with a part that a joint names, as no joint may separate them. cut: of all bodies, this one breaks least
contact. nearest: it touches nothing, and that body is nearest."""

TWIST = "rad/s, m/s (ω; v)"
FLANKS = columns(*(f"{side}_{axis}" for side in ("flank", "back") for axis in "xyz"), shape=(2, 3))
ValueRatio = Annotated[float, "rad or m over rad or m"]
RateRatio = Annotated[float, "rad/s or m/s, or their ratio"]


FREEDOMS: dict[str, int] = {
    "fixed": 0, "revolute": 1, "prismatic": 1, "screw": 1, "cylindrical": 2, "universal": 2,
    "spherical": 3, "planar": 3,
}  # fmt: skip
"""Freedoms of each type of joint but `general`."""
REASONS_SHOWN = 12
"""Reasons why parts are one body that a sentence has: bodies of robots have two or three, and every joint between the
parts of a body says them all. Chosen, not measured."""


@dataclass(frozen=True)
class Body:
    """Parts that move as one. Named after its alphabetically first group, else its first part."""

    name: BodyName
    parts: tuple[PartName, ...]
    """Sorted."""
    ground: bool
    merged: tuple[str, ...] = ()
    """Why the parts are one body: "group shoulder", "contact a~b leaves no freedom", "assumed: reason"."""
    turning: tuple[str, ...] = ()
    """Pairs of parts, "a~b", that are one by contact at rest, which only pushes and lets them turn apart."""

    @cached_property
    def why_one(self) -> str:
        """`merged` in a sentence, with the number of those beyond `REASONS_SHOWN`."""
        shown = "; ".join(self.merged[:REASONS_SHOWN])
        more = len(self.merged) - REASONS_SHOWN
        return f"{shown}; and {more} more" if more > 0 else shown


@dataclass(frozen=True, eq=False)
class Blocker:
    """A contact that was left out of the decision, and what it forbids."""

    parts: PartPair
    patch: int
    """Index into Contacts.patches."""
    area: SquareMetres
    share: Ratio
    """Of the pair's contact area."""
    place: Place
    """(3,) m."""
    gap: Metres
    forbids: str
    """In words: "rotation about +z", …"""


@dataclass(frozen=True, eq=False)
class EndStop:
    """A contact that ends the motion of a joint at the drawn pose, in one sense."""

    parts: PartPair
    patch: int
    """Index into Contacts.patches."""
    area: SquareMetres
    place: Place
    """(3,) m."""
    sense: int
    """1 where it ends the motion about or along the joint's axis, −1 where it ends the reverse."""
    ends: str
    """In words: "the turn about +z"."""


@dataclass(frozen=True, eq=False)
class Release:
    """One way in which the second body can leave the first, breaking contact; the opposite way is blocked."""

    kind: MotionKind
    twist: Annotated[Array, TWIST, columns("*_wx", "*_wy", "*_wz", "*_vx", "*_vy", "*_vz")]
    """(6,) of the second relative to the first: unit direction of a slide, unit ω of a turn or screw."""
    direction: Direction
    """(3,) unit, signed: of the slide, or of the turn by the right hand."""
    point: Place | None
    """(3,) m, on the axis of a turn or screw."""
    extreme: bool
    """False: one of very many directions, in the middle of them."""
    words: str
    """"lift off along +z", "tip about -x"."""


@dataclass(frozen=True, eq=False)
class Reading:
    """Another joint that the contact of two bodies admits: what stands against a motion may end it or guide it."""

    type: JointType
    axis: Direction | None
    """(3,) unit, canonical sign."""
    point: Place | None
    """(3,) m."""
    pitch: Lead | None
    freedoms: int
    cause: ReadingCause
    words: str
    """When it holds: "cylindrical, if 314 mm² between base and rod are an end stop"."""


@dataclass(frozen=True, eq=False)
class Joint:
    """What two bodies may do relative to each other; values are of the second about `axis`
    relative to the first."""

    name: JointName
    bodies: Annotated[tuple[BodyName, BodyName], columns("body_a", "body_b")]
    """Sorted by name."""
    type: JointType
    axis: Direction | None
    """(3,) unit, canonical sign."""
    point: Place | None
    """(3,) m: on the axis, near the contact; the centre for spherical."""
    axis2: Direction | None
    pitch: Lead | None
    freedoms: int
    twists: Annotated[Array, TWIST]
    """(freedoms, 6) basis of the relative motions."""
    evidence: tuple[str, ...]
    """Sorted names of surface kinds, or "rim", "bolt circle", "assumption", "function"."""
    status: JointStatus
    reason: str
    """One sentence: why this type and status."""
    patches: tuple[int, ...]
    """Indices into Contacts.patches that carry the joint."""
    blockers: tuple[Blocker, ...]
    singular_values: Annotated[Array, "1"]
    """(6,) ascending."""
    range_lower: JointValue | None = None
    range_upper: JointValue | None = None
    range_status: str = "unknown"
    held: bool | None = None
    """Whether contact lets no motion of the second body break it; None where contact does not say."""
    releases: tuple[Release, ...] = ()
    """Ways to leave, where they are not held: slides first."""
    at_rest: Annotated[Array, TWIST] = field(default_factory=lambda: np.zeros((0, 6)))
    """(r, 6) canonical basis of the motions that keep all contact of the pair; empty where contact does not decide."""
    closed: Annotated[Array, TWIST] = field(default_factory=lambda: np.zeros((0, 6)))
    """(c, 6) canonical basis of the span of all motions that contact allows, which pushes and does not pull."""
    open: bool = False
    """Whether one motion opens all contact that holds, or bodies without freedoms come apart along one line."""
    at_stop: tuple[EndStop, ...] = ()
    """What ends its motion at this pose."""
    extremes: int | None = None
    """How many extreme directions the leaving motions have; None where held, not known, or too many to list."""
    held_reason: str = ""
    """Why it is not known whether they are held."""
    motion: str = ""
    """In words what the second body may do: "turns about …, slides along …"; of joints that contact decided."""
    axis_uncertainty: Radians = 0.0
    """Standard uncertainty of the direction of the axis, by the fits of what decides it; 0 where it has none."""
    point_uncertainty: Metres = 0.0
    """Standard uncertainty of the place of the axis, or of the centre; 0 where it has none."""
    readings: tuple[Reading, ...] = ()
    """What else the contact may mean: of an ambiguous joint the other answers, of an inferred one those not chosen."""

    @property
    def touching(self) -> tuple[int, ...]:
        """Indices into Contacts.patches, ascending: what carries it, what blocks it and what ends it."""
        beside = (one.patch for some in (self.blockers, self.at_stop) for one in some)
        return tuple(sorted({*self.patches, *beside}))

    def __repr__(self) -> str:
        return f"Joint {self.name}: {self.type} ({self.status})"


@dataclass(frozen=True, eq=False)
class Separation:
    """Bodies that can leave the rest of the assembly together, as one, with everything else at rest."""

    bodies: tuple[BodyName, ...]
    """Sorted. Parts or groups, where contact alone makes them one body with others."""
    contacts: tuple[JointName, ...]
    """The pairs whose contact it breaks; none of those that slide along all their contacts."""
    releases: tuple[Release, ...]
    """Relative to the rest; slides first."""


@dataclass(frozen=True, eq=False)
class ConstraintMatrix:
    """The assembly's J: one row a contact sample, six columns a body (ω; v at `centre`, v over `length`).

    Row r, for the bodies a and b: n·(velocity of b − velocity of a) at the sample. J V ≥ 0.
    """

    bodies: tuple[BodyName, ...]
    data: Annotated[Array, "1 (lengths over scaling.length)"]
    indices: Ints
    indptr: Ints
    patch: Ints
    """(rows,) index into Contacts.patches."""
    sample: Ints
    """(rows,) index into the patch's points."""
    centre: Place
    length: Metres


@dataclass(frozen=True)
class Move:
    """By how much one joint was moved so that its axis agrees with others exactly."""

    joint: JointName
    angle: Radians
    """By which its axis was turned."""
    distance: Metres
    """By which its line was shifted across itself, or its centre."""


@dataclass(frozen=True)
class Misfit:
    """What snapping did: the greatest change of a direction and of a position, and where."""

    angle: Radians = 0.0
    distance: Metres = 0.0
    angle_at: str = ""
    distance_at: str = ""


@dataclass(frozen=True)
class FiniteCertificate:
    """What finite steps and the second-order test say of one block of joints that close loops.

    A block whose loops leave no freedom of first order has none. Lengths are shares of the block's size.
    """

    joints: tuple[JointName, ...]
    instantaneous: int | None
    """Freedoms of first order of the block; None where it is too large to be tried."""
    finite: int | None
    """Dimension of its motions: the largest of the branches through the pose; None where not decided."""
    infinitesimal: int = 0
    """Freedoms that no branch has."""
    singular: bool = False
    """Branches have fewer freedoms than the pose: where there are several, a bifurcation."""
    branches: tuple[int, ...] = ()
    """Freedoms of the branches that were found, eight at most: one where the pose is regular, or where the motions
    beside it are a cone that is no union of branches; none where nothing moves."""
    step: Annotated[float, "rad, or of the size"] = 0.0
    """rad, and share of the size."""
    kept: Ratio = 0.0
    """Share of the step that is left on the closed loops: the least of generic steps where the pose is
    regular, else the greatest of any step."""
    residual: Annotated[float, "rad, or of the size"] = 0.0
    """Bound, a power of ten, of the closure errors of the stepped poses (rad, and share of the size)."""
    stepped: int | None = None
    """Freedoms of first order at the stepped poses, the most; None where no step was kept."""
    second_order: CurvatureVerdict = ""
    moves: tuple[JointName, ...] = ()
    """Joints that move in the freedoms that are only infinitesimal."""
    statement: str = ""
    """In words, where there is anything to say: a shaky structure, a bifurcation, or why it is not known."""
    at_ends: bool = True
    """Whether it is shaky or singular at both ends of the mobility, too; else by contact that only pushes."""


@dataclass(frozen=True, eq=False)
class Freedom:
    """One freedom of the assembly, as a motion that one joint drives and the rates that follow."""

    driver: JointName | None
    """None: a body that no joint connects to ground."""
    body: BodyName
    """What the driver moves: its body further from ground; of an idle freedom the body that spins."""
    kind: MotionKind
    """Of the driving joint's second body relative to its first."""
    axis: Direction
    """(3,) unit, canonical sign."""
    point: Place
    """(3,) m: on the axis, near the joint."""
    pitch: Lead
    """m a turn; 0 unless a screw."""
    idle: bool
    """One of the idle freedoms: the others are effective."""
    looped: bool
    """Whether loops must close for it: other joints follow."""
    drives: tuple[Annotated[tuple[JointName, int, RateRatio], columns("joint", "twist", "rate")], ...]
    """(joint, index of its twist, rate) where not zero, the driver's rate being ±1 (rad/s, m/s); empty without
    driver."""


@dataclass(frozen=True, eq=False)
class Redundancy:
    """Constraints that hold nothing more, in a set of joints none of which could be left out of it."""

    kind: RedundancyKind
    text: str
    """One sentence: where, why, how many, and which."""
    rows: int
    """Independent constraints too many. Those of pairs are in addition to `Mobility.redundant`."""
    joints: tuple[JointName, ...]
    """In the order of walking for a loop, else sorted."""
    patches: tuple[int, ...]
    """Indices into Contacts.patches: the contacts that make these joints."""
    directions: tuple[str, ...]
    """What can be locked in, one a row: "force along z", "moment about x"; empty where not told apart."""
    wrenches: Annotated[Array, "N m, N (τ; f)"]
    """(n, 6) N·m, N (τ about the world's origin; f): the same as wrenches through the first joint; n = directions."""


@dataclass(frozen=True, eq=False)
class Mobility:
    """How many independent motions the bodies have together, relative to ground, and which."""

    instantaneous: int
    finite: int | None
    effective: int
    idle: int
    redundant: int
    blocked: int
    """Instantaneous mobility when blockers count as constraints (`blocked_mobility`)."""
    freedoms: Annotated[Array, TWIST]
    """(instantaneous, bodies, 6) orthonormal basis of body twists, ground at rest. Of large assemblies, where it
    would hold over a million numbers, (0, bodies, 6): `named` says the same."""
    idle_bodies: tuple[BodyName, ...]
    uncertain: tuple[JointName, ...]
    """Joints that are ambiguous or general or blocked: the counts depend on them."""
    finite_reason: str = ""
    """Why `finite` is less than `instantaneous`, or is not known; empty where every freedom is a motion."""
    infinitesimal: int = 0
    """Freedoms that exist at first order only (a shaky structure); those of a bifurcation do not count."""
    singular: bool = False
    """The pose has more freedoms than the poses that it can move to."""
    on_edge: bool = False
    """Two ways to count the freedoms of first order disagree: none of the counts is certain."""
    certificates: tuple[FiniteCertificate, ...] = ()
    """One a block of joints with loops and freedoms, in the order of the joints."""
    named: tuple[Freedom, ...] = ()
    """A readable basis of the freedoms: block by block of the graph, then bodies that nothing holds."""
    by_contact: int | None = None
    """Instantaneous mobility of what contact alone gives, where joints are taken as the function states them."""
    redundancies: tuple[Redundancy, ...] = ()
    """Those of loops sum to `redundant`; those of pairs come first and are not counted there."""
    low: int | None = None
    """The least that `effective` may be: all contact is kept as it is at rest. None: computed by an older version."""
    high: int | None = None
    """The most: contact that only pushes, and that no stated joint names, is left out where it can separate."""

    def __repr__(self) -> str:
        counts = ", ".join(f"{name} {'not known' if value is None else value}" for name, value in self._counts())
        return f"Mobility: {counts}"

    def _repr_html_(self) -> str:
        rows = (f"<tr><td>{'–' if value is None else value}</td><td>{name}</td></tr>" for name, value in self._counts())
        return f"<table><tbody>{''.join(rows)}</tbody></table>"

    def _counts(self) -> tuple[tuple[str, int | None], ...]:
        """What is shown of it, by name."""
        return (
            ("effective", self.effective), ("instantaneous", self.instantaneous), ("finite", self.finite),
            ("idle", self.idle), ("redundant", self.redundant), ("blocked", self.blocked),
        )  # fmt: skip

    @property
    def ends(self) -> tuple[int, int]:
        """The least and the most that `effective` may be."""
        return self.effective if self.low is None else self.low, self.effective if self.high is None else self.high

    def admits(self, stated: int) -> bool | None:
        """Whether a stated mobility is this one: with or without idle freedoms, or at one of its ends; None strictly
        between the ends."""
        low, high = self.ends
        if stated in (low, high) or self.effective <= stated <= self.effective + self.idle:
            return True
        return None if low < stated < high else False

    @property
    def gruebler(self) -> int:
        """6(N−1) − Σ(6−f): the count that knows no geometry."""
        return self.instantaneous - self.redundant


@dataclass(frozen=True, eq=False)
class Meshing:
    """Teeth that keep a constant ratio: value(first) = ratio · value(second), whatever the pose."""

    ratio: ValueRatio
    """That of the pitches: exact over whole pitches. SI, of the values as kinform counts them."""
    teeth: Annotated[tuple[int, int], columns("teeth_a", "teeth_b")]
    """Counted on either side: all of a whole wheel, those in an even row of a rack or a sector."""
    pitches: Annotated[tuple[float, float], "rad or m", columns("pitch_a", "pitch_b")]
    """rad or m."""
    deviation: JointValue
    """rad or m of the first: by how much the motion of the meshes leaves the ratio while one tooth passes, peak to
    peak."""
    play: JointValue
    """rad or m of the first, the second held: the least while one tooth passes."""
    reach: Annotated[tuple[float, float], "rad or m", columns("reach_lower", "reach_upper")]
    """Values of the first between which there are teeth at the contact; infinite for whole wheels."""
    place: Place
    """(3,) m: the pitch point, at half of the contact's width; the body that bears both sides carries it."""
    normals: Annotated[Array, "1", FLANKS]
    """(2, 3) unit, of the flanks that touch and of the others, taken to be symmetric: from the first side's body into
    the second's. Lines of action go through the pitch point."""


@dataclass(frozen=True)
class Coupling:
    """Two joints that one contact, or one screw, ties to each other: value(first) = ratio · value(second)."""

    joints: Annotated[tuple[JointName, JointName], columns("joint_a", "joint_b")]
    ratio: ValueRatio
    """Of the values as kinform counts them (of the second body about the listed axis relative to the first), SI."""
    kind: CouplingKind
    through: JointName
    """The joint that ties them: a higher pair or a screw."""
    status: CouplingStatus
    uncertainty: ValueRatio
    """Of the ratio; nan where it is not known."""
    reason: str = ""
    """Why the teeth are not known to keep a constant ratio; empty where they do, and for screws."""
    meshing: Meshing | None = None
    """The constant ratio of the teeth, where sections through them show one."""


@dataclass(frozen=True, eq=False)
class IgnoredContact:
    """Contact between two bodies that the function moves relative to each other by other joints: it holds nothing."""

    name: JointName
    bodies: Annotated[tuple[BodyName, BodyName], columns("body_a", "body_b")]
    type: JointType
    """Which joint the contact would be, taken alone."""
    freedoms: int
    status: JointStatus
    area: SquareMetres
    axis: Direction | None
    words: str
    """How the function moves the two, beside how the contact lies."""

    @property
    def loose(self) -> bool:
        """Whether the contact is no joint by itself, or not surely one."""
        return self.type in ("planar", "general") or self.status == "ambiguous"


@dataclass(frozen=True)
class Membership:
    """Why a part is in its body, where the bodies follow from the function."""

    part: PartName
    body: BodyName
    how: MembershipCause
    margin: Ratio
    """By how much the next best body would be dearer (prices of `kinematics/partition`); inf: none is in question."""
    other: BodyName
    """The next best body; empty where none is in question."""
    either: bool
    """Whether it could be elsewhere as well: next to nothing but journals and faces round a joint's axis, and what
    suggests screws, speaks for one side; or it touches nothing."""
    evidence: str = ""
    """What holds it there, what it was parted from, and which standard part it is."""


@dataclass(frozen=True)
class Unseparated:
    """An intended joint whose two sides contact holds together, where the bodies follow from the function."""

    joint: str
    parts: tuple[PartName, ...]
    """A shortest chain of parts from one side to the other, each of which touches the next and none of which the joint
    may part from it."""


@dataclass(frozen=True, eq=False)
class UndeclaredJoint:
    """A joint that contact alone would make inside one body, where the bodies follow from the function."""

    body: BodyName
    type: JointType
    """revolute or spherical."""
    axis: Direction | None
    point: Place
    first: tuple[PartName, ...]
    second: tuple[PartName, ...]
    """The parts of its two sides, as far as contact holds them together."""
    words: str

    def parts(self, one: PartName, other: PartName) -> bool:
        """Whether these two parts lie on different sides of it."""
        first, second = set(self.first), set(self.second)
        return (one in first and other in second) or (one in second and other in first)


@dataclass(frozen=True)
class FoundSides:
    """The sides of an intended joint that names one part, or none."""

    joint: str
    parts: Annotated[tuple[str, str], columns("part_a", "part_b")]
    """The named one first; of two found ones, that on the ground's side."""
    evidence: str
    """What parts them, what each side has, and by how much the next way of parting would be dearer."""


@dataclass(frozen=True, eq=False)
class Kinematics:
    """All of it."""

    bodies: tuple[Body, ...]
    joints: tuple[Joint, ...]
    matrix: ConstraintMatrix
    mobility: Mobility
    misfit: Misfit
    misaligned: tuple[Annotated[tuple[str, Radians, Metres], columns("joint", "angle", "offset")], ...] = ()
    """(joint name, angle rad, offset m) of pairs whose axes were mated beyond what clearance allows."""
    separations: tuple[Separation, ...] = ()
    """What can leave the assembly, ground held; sorted by bodies."""
    separations_reason: str = ""
    """Why it is not known, or not known of all bodies, whether they can leave."""
    slides: tuple[Separation, ...] = ()
    """What slides along its contacts, breaking none of them, ground held; sorted by bodies."""
    couplings: tuple[Coupling, ...] = ()
    moves: tuple[Move, ...] = ()
    """What snapping did to each joint that it moved, in the order of the joints; `misfit` has the greatest."""
    asides: tuple[IgnoredContact, ...] = ()
    """With `[function] complete = true`: contact that constrains nothing, sorted by bodies."""
    membership: tuple[Membership, ...] = ()
    """With `[function] complete = true`: every part of an assembly with meshes, sorted by name."""
    unparted: tuple[Unseparated, ...] = ()
    """With `[function] complete = true`: joints whose sides contact holds together, sorted by name."""
    left_out: tuple[UndeclaredJoint, ...] | None = ()
    """With `[function] complete = true`: joints that contact alone would make inside bodies. None: nobody looked."""
    sides: tuple[FoundSides, ...] = ()
    """Of joints that name one part or none, sorted by name."""

    def body_of(self, part: str) -> Body:
        """The body that contains the part; KeyError otherwise."""
        return self._body_of[part]

    @cached_property
    def named_bodies(self) -> dict[str, Body]:
        """The bodies by their names."""
        return {str(body.name): body for body in self.bodies}

    @cached_property
    def named_joints(self) -> dict[str, Joint]:
        """The joints by their names."""
        return {str(joint.name): joint for joint in self.joints}

    def joints_between(self, first: str, second: str) -> tuple[Joint, ...]:
        """The joints of two bodies, in their order."""
        return self._joints_between.get(frozenset((first, second)), ())

    def joints_among(self, names: AbstractSet[str]) -> list[Joint]:
        """The joints whose bodies are both among these, in their order."""
        places = {k for name in names for k in self._joints_of.get(name, ())}
        return [self.joints[k] for k in sorted(places) if names >= set(self.joints[k].bodies)]

    @cached_property
    def neighbours(self) -> dict[str, frozenset[str]]:
        """The bodies that have a joint with each."""
        near: dict[str, set[str]] = {name: set() for name in self.named_bodies}
        for joint in self.joints:
            first, second = joint.bodies
            near.setdefault(first, set()).add(second)
            near.setdefault(second, set()).add(first)
        return {name: frozenset(others) for name, others in near.items()}

    @cached_property
    def _joints_between(self) -> dict[frozenset[str], tuple[Joint, ...]]:
        out: dict[frozenset[str], list[Joint]] = {}
        for joint in self.joints:
            out.setdefault(frozenset(joint.bodies), []).append(joint)
        return {pair: tuple(joints) for pair, joints in out.items()}

    @cached_property
    def _joints_of(self) -> dict[str, list[int]]:
        out: dict[str, list[int]] = {}
        for k, joint in enumerate(self.joints):
            for name in joint.bodies:
                out.setdefault(name, []).append(k)
        return out

    @cached_property
    def _body_of(self) -> dict[str, Body]:
        return {str(part): body for body in self.bodies for part in body.parts}


def body_of_part(bodies: Iterable[Body]) -> dict[PartName, BodyName]:
    """The body of every part."""
    return {part: body.name for body in bodies for part in body.parts}


def only_bodies(bodies: tuple[Body, ...]) -> Kinematics:
    """Which parts move as one, and nothing of how."""
    zero = np.zeros(0)
    none = np.zeros(0, dtype=np.int64)
    matrix = ConstraintMatrix((), zero, none, np.zeros(1, dtype=np.int64), none, none, np.zeros(3), 1.0)
    mobility = Mobility(0, None, 0, 0, 0, 0, np.zeros((0, len(bodies), 6)), (), ())
    return Kinematics(bodies, (), matrix, mobility, Misfit())
