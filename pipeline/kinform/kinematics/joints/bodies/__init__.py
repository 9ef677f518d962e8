"""Which parts are one body, and which bodies have a joint.

`fusing` is the method: `merging` makes parts one, by groups, assumptions and contact; `classification` asks `pair`
about every two bodies that touch, again until nothing fuses; `fasteners` adds what suggestions say, where that joins
nothing that is `kept_apart`.

Then the joints: `readings` chooses where contact admits two interpretations, `end_play` makes revolute what slides
between collars by a little, `stated_joints` are those of assumptions and of bodies without geometry, and where a
function states all joints (`complete_function`), `joints_in_force` decides between it and contact, and
`ignored_contacts` are those that constrain nothing. `overlaps` finds doubts where bodies interpenetrate; `extents` has
sizes and volumes.
"""
