"""Numbers by which rules decide, by the module that uses them. What users may set is in `Tolerances`."""

from __future__ import annotations

import math
from collections.abc import Mapping

# --- comparisons/couplings --------------------------------------------------------------------------------------------

UNCOUNTED_TEETH = 1e-2
"""Relative: what the ratio of teeth at one pose may be off."""
COUNTED_TEETH = 1e-3
"""Relative: what a stated ratio may be rounded by where the teeth are counted."""
SCREW_PITCH = 1e-3
"""Relative: what the pitch of a screw may be off."""
UNCERTAIN_RATIO = 0.05
"""Relative uncertainty, for each coupling of a chain, beyond which a ratio says nothing."""
DEVIATIONS = 3.0
"""Standard uncertainties of a derived ratio within which a stated one agrees."""

# --- comparisons/free_links -------------------------------------------------------------------------------------------

OPENS = 1e-3
"""Least speed with which all of a contact must open, for a motion of 1: normals of surfaces that were recovered from
meshes are off by less, and a bore that reaches half round, less one facet of 3000, still opens."""

# --- comparisons/limits -----------------------------------------------------------------------------------------------

RATE_RESOLVED = 0.1
"""Share of the greatest rate by which a rate may miss what its derivatives at both ends of a step make of it; a sine is
within it from six output times a period."""
MOST_STEPS = 0.2
"""Share of the steps that may miss by more: single kinks and jumps of a law are no reason to doubt."""
QUIET = 1e-9
"""rad/s or m/s below which nothing moves."""
BENT_ALIKE = 0.25
"""Share of its curvature that a peak's neighbours must have for a parabola to say how high it is; a choice."""

# --- rules/kf415 ------------------------------------------------------------------------------------------------------

DEGREES = 8.0 * math.pi, 360.0
"""Limits of a joint that turns (rad) which are probably degrees, or stand for none: from four turns on, which hardly a
joint of a robot goes, to as many degrees as a turn has. A choice."""

# --- comparisons/near -------------------------------------------------------------------------------------------------

MOST_CORRECTIONS = 4
"""Corrections, and joints of the loops, that are named of one motion that loops nearly make: a choice."""

# --- comparisons/plausibility -----------------------------------------------------------------------------------------

LARGE = 20.0
"""Diagonal (m) above which the units are doubted."""
MASSIVE = 1000.0
"""Volume of solid material (m³) above which the units are doubted."""
TINY: Mapping[str, float] = {"um": 3e-6}
"""Diagonal (m) below which the units are doubted, for each unit; `TINY_ELSE` where not listed."""
TINY_ELSE = 3e-3
"""m."""
OUTLIER = 100.0
"""A part so many times larger than all others together is doubted."""
MIXED = 1000.0
"""Parts whose largest is so many times larger than the smallest, with a gap between two sizes of `OUTLIER`, are in
different units: metres and millimetres."""
MIXED_ROUNDING = 1e-3
"""By so much less may they differ: the same part in metres and in millimetres has numbers that are rounded."""

# --- rules/kf121_mass_invalid -----------------------------------------------------------------------------------------

TRIANGLE_ROUNDING = 1e-9
"""Relative rounding that the triangle inequality of the moments is allowed (thin discs reach equality)."""

# --- rules/kf201_parts_interpenetrate ---------------------------------------------------------------------------------

AT_JOINT = 0.02
"""Share of the size of the smaller of two links that a joint joins, up to which they may overlap in a description:
bearings, flush horns, bevel gears drawn at their nominal size."""

# --- rules/kf405_joint_pitch_differs ----------------------------------------------------------------------------------

SAME_PITCH = 1e-3
"""Relative difference of pitches that counts as equal."""

# --- rules/kf412_joint_range_short, rules/kf413_range_exceeded --------------------------------------------------------

DRAWN_TURN = math.radians(2.0)
"""An end that a joint which nothing holds finds within this of the drawn pose is no stop. Of 38 public robots those
within 0.9° are teeth and bars of loops that touch as they are drawn; the next is at 5.9°."""
DRAWN_SLIDE = 0.02
"""The same for slides, as a share of the stated range: a chosen number, the robots have slides at exactly 0 only."""
SHORT_TURN = math.radians(0.02)
"""rad by which a turn may fall short: a stop on facets is not where it is on the surface."""
SHORT_SLIDE = 1e-3
"""Share of a stated length by which a slide may fall short."""
BEYOND = 1e-6
"""Share of the range (rad or m where it is endless) by which a motion may pass its end: a drive to just there is no
finding."""

# --- rules/kf421_region_not_reached -----------------------------------------------------------------------------------

REACHED_SHARE = 1e-3
"""Share of the assembly's size within which a place is reached, where no tolerance is stated; a choice."""
REACHED_ANGLE = math.radians(0.1)
"""rad within which a direction is reached, where no tolerance is stated; a choice."""
SAMPLED_FREEDOMS = 2
"""Freedoms of closed loops up to which sampling is dense enough for a "no"."""

# --- rules/kf422_path_not_followed ------------------------------------------------------------------------------------

SAME_TIME = 1e-9
"""Share of the simulated time by which a path may be longer: rounding."""

# --- rules/kf424_holding_effort_exceeded ------------------------------------------------------------------------------

AT_END = 1e-6
"""rad or m: a pose at the very end of a range is inside."""
NO_EFFORT = 1e-12
"""N·m or N below which an effort is shown as nothing: rounding."""

# --- rules/kf430_inertia_out_of_bounds --------------------------------------------------------------------------------

INERTIA_SPREAD = 5.0 / 3.0
"""An error of the shape that adds so much to the mass adds so much more to the inertia, at equal proportions."""

# --- rules/kf432_not_retained -----------------------------------------------------------------------------------------

SAME_DIRECTION = math.cos(math.radians(1.0))
"""Cosine of the angle within which directions agree."""
SHARED_MOTION = 0.02
"""Share of a motion within which what contact leaves is a motion that a loop's closure leaves, too; as `ADMITTED`."""
NAMED_UNCLEAR = 8
"""So many parts of unclear bodies are named in one finding."""
NO_TURN = 1e-6
"""Share of the greatest rate below which a freedom does not turn, or does not slide; a choice."""

# --- rules/kf503_simulation_residual_large, rules/kf504_energy_not_balanced, rules/kf508_vibration_damped -------------

LOOP_RESIDUAL = 1e-6
"""Residual relative to the size of the assembly (m), and absolute (rad)."""
DAMPED_UNSEEN = 1e-6
"""Share of the energy exchanged that went with vibrations which the solver damped, up to which the motion is known:
they had a thousandth of its speeds. A choice."""
ENERGY_DRIFT = 1e-3
"""Drift relative to the energy exchanged."""
ENERGY_SOLVED = 1e-6
"""Share of the greatest kinetic energy that solving leaves: output times may catch the motion where nothing is
exchanged."""
NO_ENERGY = 1e-15
"""Energy exchanged (J) below which there is nothing to compare."""

# --- comparisons/masses: KF110, KF123, KF124 --------------------------------------------------------------------------

DENSEST = 23000.0
"""kg/m³: osmium has 22 600. Nothing has more mass over the volume of its convex hull, in which all of it is."""
HEAVY = 12000.0
"""kg/m³ above which what closed meshes enclose is doubted: lead has 11 340; a screw or a motor that is not drawn makes
a small part heavy."""
LIGHT = 5.0
"""kg/m³ below which what closed meshes enclose is doubted: the lightest foams have 10; hollow links of public robots
have 100 and more."""
WRONG_SCALE = 1e9
"""By so much a density is off where a mesh is in metres and is in millimetres, or the other way round."""
SCALE_SPREAD = 50.0
"""Factor about `WRONG_SCALE` within which a density says a wrong unit: hulls of 10 to 25 000 kg/m³ are right ones."""
HULL_DENSITY = 500.0
"""kg/m³: mass over the volume of the convex hull, as parts of robots have it; in the middle of what there is."""
SCALE_OUTLIER = 20.0
"""Factor by which a shape with such a density must also be larger or smaller than the middle one of the others: what a
placeholder of a nanogram is stated for is not."""
INERTIA_LARGE = 1.001
"""Share of m·r² (r from the centre of mass to the farthest point of the hull) above which half the trace of an inertia
is impossible: rounding of stated numbers."""
INERTIA_FAR = 30.0
"""Factor by which an inertia may be below or above that of the same mass, spread evenly over the shape, before it is
doubted: hollow shells have up to 3, dense motors in light shells down to a tenth."""
CENTRE_OUTSIDE = 0.03
"""Share of the size by which a centre of mass may lie outside of the hull: pieces that are not drawn, rounding."""

# --- control ----------------------------------------------------------------------------------------------------------

FEW_WARNINGS = 6
"""Warnings of one rule on a robot description that are told one by one: the sides of three joints. Of more, nobody
reads the last."""
WORST_WARNINGS = 3
"""Of more, so many are told; the rest is one finding."""
NAMED_WARNINGS = 4
"""Of these, so many are named."""

# --- comparisons/gathering --------------------------------------------------------------------------------------------

ALIKE_MOST = 3
"""Findings of one kind in one description that are told one by one; more are one finding, of the worst."""

# --- rules/kf130_collision_geometry_differs ---------------------------------------------------------------------------

BARE_SHARE = 0.15
"""Share of the visual's area that may lie outside of the collision geometry: rounded covers by boxes stay below."""
BARE_DEPTH = 0.10
"""Share of the link's size by which it may reach out there."""
FAR_BEYOND = 0.30
"""Share of the link's size by which collision geometry may reach beyond the visual: boxes and cylinders around slender
links."""
THOUSAND = 1000.0
"""Metres over millimetres."""
THOUSAND_SPREAD = 5.0
"""Factor about it within which two sizes of one link say so."""

# --- comparisons/sides, rules/kf132_sides_not_mirrored ----------------------------------------------------------------

MIRRORED = 2e-3
"""Share of the span of all pairs by which a frame may be off its mirror image: rounded numbers."""
PLANE_NEAR = math.cos(math.radians(15.0))
"""Cosine of the angle within which the plane of symmetry is across an axis of the first link: robots are drawn so."""
MIRRORED_ANGLE = math.radians(0.5)
"""rad by which an axis may be off its mirror image."""
SAME_LOOK = 0.02
"""Share of a link's size by which its geometry may be off the image of the other side: screws, labels, connectors."""
SAME_MASS = 0.02
"""Relative difference of masses of two sides."""
SAME_CENTRE = 0.02
"""Share of the size by which a centre of mass may be off the image of the other side's."""
SAME_INERTIA = 0.10
"""Relative difference of inertias of two sides, products included."""
