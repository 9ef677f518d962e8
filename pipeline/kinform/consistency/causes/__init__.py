"""One finding for each cause: between the rules and the reports.

A wrong place, a wrong unit or a wrong export makes many findings. `grouping.by_cause` gives one for each cause, and
keeps what it stands for as members. A cause is stated only where it is proved: the parts are moved, scaled or left out,
contacts and joints are found anew, and rules are asked again (`asking`). What no cause explains stays as it is.

- `layouts`: parts that were never put together
- `repeated`: the same shapes again and again
- `scaled`: meshes of another unit
- `displaced`: parts that one motion puts right; `mates` proposes motions, `movable` says of what
- `remedies`: where parts should be, in the numbers of the file that places them
"""
