"""The joint of a pair of bodies, from the contact between them.

How a joint is decided
======================

Two bodies touch along patches: pieces of planes, cylinders, cones and so on, each with samples p (m), unit normals n
out of the first body, gaps and an area. Which relative motions keep all of this contact? They are the freedoms of the
joint.

The question is linear in the velocities. A relative twist (ω; v) of the second body moves a sample at the velocity v
+ ω × p. It keeps contact there where the velocity has no part along the normal, n·(v + ω × p) = 0, and it does not
penetrate where this is not negative (Sinha, Paredis and Khosla 2000, equation 11). So a sample is a row of a matrix,
and the freedoms are its null space.

Three things stand between that sentence and the parts of a real assembly:

- Scale. ω is in rad/s and v in m/s; whether a number beside zero is small depends on the unit of length. Twists are
  scaled: with the centre c and half the diagonal L of the contact's box, V = (L ω; v at c). All six numbers are
  velocities then, and a row is [((p − c) / L) × n, n] (`foundation.algebra.screws`). An assembly and its copy at
  another scale answer alike.
- Tessellation. A bore in a mesh file is a polygon, so that no turn of a shaft keeps all of it. Rows have the normals
  of the fitted surfaces instead of those of the facets, and what is left is the uncertainty of the fits.
- Error. Shafts are drawn with clearance, holes 0.01 mm off, axes to six digits. A null space in floating point would
  be empty almost always. So it is not looked for: motions are guessed, and tested within what each patch can tell.

The steps
---------

1. `evidence`: patches become rows with weights. Each patch counts with the square root of its area, less where its
   gap is wide; each has an angle (rad) and a position (m) by which it may be off before that is a fact.
2. `hypotheses`: the elementary motions that the surfaces suggest. Axes of cylinders give turns, screws and slides,
   centres of balls give turns, planes give turns about their normals and slides along the lines in which they meet.
   Every lower pair is spanned by such motions. Axes that agree within what their clearances allow become one, fitted
   to all of them.
3. `freedoms`: each motion is tested against each patch. It is preserved where the root mean square of its speeds
   along the normals is no more than that which the patch's angle and position allow at such velocities. Motions that
   every patch preserves, and that are independent of those before them, are the freedoms. Then the rows are made
   exactly consistent with these (what they say against them is taken out), and the singular values of the weighted
   rows say whether anything else is free: below 1e-4 a direction is free, above 2e-3 it is held (`Tolerances.free`,
   `.held`), and in between the joint is `ambiguous`.
4. `lower_pairs`: a basis of twists gets the name of the joint: type, axis, point and pitch, or `general`.
5. `motion_cone`: contact pushes and does not pull. The motions at rest keep all contact; the cone of motions is all
   that contact allows, and its span, `closed`, what opposing contact does not hold in both senses. The true motion lies
   between the two. Where they are equal there is no doubt by one-sided contact.
6. `decision`: which of the two the joint is. Contact that all opens by one motion is open, and the joint is what is at
   rest (a block on its table); so it is where fixed bodies come apart along one line (a lid in its pocket), unless the
   guide is long enough to slide in. A turn about a journal that goes more than half round, ended in one sense by
   contact beside it, is the joint, drawn at its end stop (a door on its jamb). A small part that is drawn into the
   other body by more than a press, and alone forbids a motion, is left out, and the joint is `blocked` by it.
   `certainty` says what makes the answer doubtful: it is `ambiguous` then, never silently one or the other.
   Contact that may not hold what its rows say is listed by generators (`suspects`) in one table of precedence:
   `uncertainty` and `strays` what the fits hardly know and what may not be meant to touch, `coarse_flats` what coarse
   meshes may hide, `scraps` what is too slight for the answer to hang on it, `slots` what pins hold,
   `one_sided` which faces may end a motion at this pose and not guide it. Of the last ones the other reading is kept
   (`Joint.readings`), and the stated function may choose (`bodies.readings`).
7. `joint` has the result as a `Joint`; `question` is all of it as a function of what it depends on; `extremes` are
   the samples that the constraint matrix has rows for.

A pin in a bore, with a collar at each end
------------------------------------------

Radius 5 mm, length 20 mm along z; the collars, rings from 5 to 8 mm, lie at z = ±10 mm against the plate. The box of
the contact is 16 × 16 × 20 mm, so L = 15.1 mm and c is the middle of the pin. Areas of 628, 123 and 123 mm² give
weights by their roots of 0.53, 0.23 and 0.23. At an angle φ, in polar coordinates, the rows against (L ω; v) are

    bore,    height z:   [ −(z/L) sin φ, (z/L) cos φ, 0,   cos φ, sin φ, 0 ]
    collars, radius r:   [ ±(r/L) sin φ, ∓(r/L) cos φ, 0,   0,     0,     ±1 ]

(the radius of the bore falls out: its normals go through the axis). Guessed are a turn about z and slides along z, x
and y. The bore preserves the turn and the slide along z, the collars preserve the turn and the slides along x and y.
What all three preserve is the turn. The singular values, ascending:

    0        the turn about z: free
    0.32 ×2  tilting about x and y: √(0.53·½·mean(z/L)² + 0.47·½·mean(r/L)²)
    0.52 ×2  going sideways: √(0.53·½), held by the bore
    0.68     going along z: √0.47, held by the collars

One value is below 1e-4, the next is above 2e-3: a revolute joint about z, `determined`. Without the collars the
values are 0, 0, 0.41, 0.41, 0.71, 0.71: the turn and the slide, a cylindrical joint. With a plane of 4 mm² more
beside the pin, whose normal opposes the turn one way only, no guess is preserved by all four patches, and the lowest
singular value of their rows is 0.075: nothing is free at rest. But the cone of motions has the turn in the other sense:
closed is the turn. The bore goes all round its axis, so that the joint is revolute, `determined`, and `at_stop` by that
patch.

Sources: Sinha, Paredis and Khosla, Kinematics support for design and simulation of mechatronic systems, 2000; Hunt,
Kinematic geometry of mechanisms, 1978 (screws); Hervé 1978 and Gelfand and Guibas 2004 (which spaces are lower pairs).
"""
