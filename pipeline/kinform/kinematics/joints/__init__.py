"""Joints between bodies, from the contacts between their parts.

When are two axes parallel, or one? Three questions, each with a bound of its own. May two surfaces mate: their charts
decide (`contacts.mating.analytic`). Have the mates of one pair a common axis: within `Tolerances.alignment` and what
clearance allows (`pair.hypotheses`). Are axes of several joints meant as one: within three standard deviations of how
well contact tells them, and no more than `Tolerances.alignment` (`axes.bounds`). A stated axis is compared with the
found one by rules KF403 and KF404.

Sub-packages; each imports only those above it:

- `pair`: the joint of two bodies, from the contact between them
- `bodies`: which parts are one body, and which bodies have a joint
- `axes`: axes made consistent across the assembly
"""
