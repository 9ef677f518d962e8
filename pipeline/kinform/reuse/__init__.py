"""Reuse of earlier results under one promise: the bytes of a run from nothing.

Somebody changes one bolt of two hundred parts and runs kinform again. Nearly everything in the results file is still
what a run would give, and computing it again would take minutes; but nobody may ever have to ask whether a result is
stale. So nothing is reused because it is likely to be right: it is reused where it is known that computing it would
give the same bits, and a test compares whole files.

How it is known. A stage says in one record what its result depends on (`dependence`): the packages whose code makes
it, what it sees of the assembly, earlier results, settings. Of that a hash is made, the fingerprint, which is written
into the results file beside the result:

    JOINTS = Stage("joints", code={"joints": ("kinematics", "foundation")}, fills=("kinematics",),
                   view=views.for_joints, needs=("surfaces", "contacts"))

    fingerprint = hash("joints", version of kinform, CODE_VERSION of those packages, hash of each input)

Equal fingerprints are the licence to reuse (`advance`), and where they are not equal, the hashes of single inputs say
why ("contacts changed"). The stage is given the view and nothing else of the assembly, so it cannot come to depend on
what its fingerprint leaves out. No file time, path, host or order of events counts.

`CODE_VERSION` is an integer in the `__init__` of each package whose code decides results. Raise it by one in a change
after which the package may give other bits for some input, however few: another joint, number, order or message. Leave
it where results stay the same: names, moved code, docstrings, speed. If in doubt, raise it: that costs users one run
from nothing, and forgetting it leaves stale results. Between releases it is what tells two states of the code apart;
`benchmarks/golden.py` shows whether it has to be raised. It is stated by hand rather than computed: a digest of the
source would change with every comment, and reading all source would take longer than a run that reuses everything.

What is smaller than a stage is reused in the same way, each with a fingerprint of its own:

- meshes by the content of their file (`kinform.form.reload`); the manifest is not parsed again where only meshes
  changed;
- surfaces mesh by mesh, contacts pair by pair (`contacts`), masses part by part (`masses`);
- inside the joints stage, what contact decides of single pairs, and which contacts of a block can open together: steps
  that depend on nothing but the question they are asked (`decisions`, `packing`).

And before any of it the files alone are looked at (`lineage`): where they and the code are as they were, nothing is
parsed.

What is kept at all has been measured on one changed part of two hundred (`benchmarks/change.py`): anything that saved
less than 0.1 s was left out. `ledger` holds the earlier results, from whomever they come, and accounts for what became
of them; `digest` makes the hashes. Nothing here knows HDF5: `kinform.results` reads and writes.
"""
