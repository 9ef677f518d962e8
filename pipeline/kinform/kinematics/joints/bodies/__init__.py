"""Which parts are one body, and which bodies have a joint.

`merging` makes parts one, by groups, assumptions and contact; `classification` asks `pair` about every two bodies
that touch, again until nothing fuses; `stated_joints` are those that need no contact, `fasteners` what suggestions
add, where they are asked for and join nothing that is `kept_apart`; `extents` says how large bodies are."""
