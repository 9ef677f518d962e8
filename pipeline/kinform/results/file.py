"""The results file as a whole: which group holds what, and what makes a file one of ours.

`kinform.results.groups` has a module for each group; the attributes of a group say under which schema it was written,
and what it was made of (`Fingerprints`). The bytes depend on the design and on the versions of kinform and HDF5 alone:
groups are written in one order, nothing is compressed, no times are kept, byte order and file format are pinned.
"""

from __future__ import annotations

import dataclasses
import json
from collections.abc import Callable, Container
from pathlib import Path
from typing import TYPE_CHECKING, cast

import h5py

from kinform.design import Design
from kinform.errors import ResultsError
from kinform.foundation import provenance
from kinform.model.fingerprints import Fingerprints
from kinform.results.at_need import NONSENSE, STAGE_OF, Earlier, codec, marks_of, of_origin
from kinform.results.conformity import check_group
from kinform.results.groups import assembly
from kinform.results.held import HeldGroup
from kinform.results.opening import DAMAGE, SCHEMA, NotWholeError, check_replaceable, not_whole, opened
from kinform.results.replacement import check_target, refuse, replace_file
from kinform.results.seal import BLOCK, block_of, digest_in, seal
from kinform.reuse import lineage
from kinform.version import __version__

if TYPE_CHECKING:
    from kinform.model.assembly import Assembly
    from kinform.model.kinematics import Kinematics

GROWTH = 1 << 20
"""Bytes by which the image of a file grows: a small file takes one step, and one of 100 MB is not copied a thousand
times. Chosen, not measured."""


def write(design: Design, path: str | Path) -> None:
    """Write the design to `path`, whole or not at all.

    Identical bytes keep the file and touch its time. The file is recorded as written by this user's kinform, unless the
    design rests on results that are not. Raises ResultsError when `path` cannot be written,
    or holds something that is not a results file of this schema: that is never overwritten.
    """
    check_output(path)
    image = _image(design)
    _replace(path, block_of(image, SCHEMA), image, recorded=design.recorded)


def write_bytes(data: bytes, path: str | Path, below: Path | None = None) -> None:
    """Write to `path`, which stays `below` a folder, what another process made with `to_bytes` for this one, and record
    it; raises as `write`."""
    check_output(path)
    _replace(path, data[:BLOCK], data[BLOCK:], recorded=True, below=below)


def _replace(path: str | Path, block: bytes, image: bytes, *, recorded: bool, below: Path | None = None) -> None:
    if recorded:
        provenance.record(digest_in(block))
    replace_file(path, block, image, below=below)


def check_output(path: str | Path) -> None:
    """Raise ResultsError when `write` would refuse this path. A results file that is no longer whole is no reason."""
    check_target(path)
    target = Path(path)
    if target.exists() and target.stat().st_size > 0:
        try:
            check_replaceable(target)
        except ResultsError as error:
            message = f"{error.problem.message}; it is not overwritten"
            raise refuse(path, message, "delete it, or give another name with -o") from error


def read(path: str | Path) -> Design:
    """The design in the results file at `path`; its arrays are read-only.

    Raises ResultsError when there is no file, or it is not HDF5, of another program, of another schema,
    or damaged.
    """
    with Earlier(path) as found:
        return found.design


def read_at_need(path: str | Path) -> Design:
    """The design in the results file at `path`, each part of it read when it is first looked at: to be looked at only.

    Raises ResultsError as `read` does, of a part that makes no sense when that is looked at.
    """
    return cast(Design, Earlier(path, open_on=True))


def earlier(
    path: str | Path,
    say: Callable[[str], None] | None = None,
    say_unknown: Callable[[str], None] | None = None,
    *,
    trust: bool = False,
) -> Earlier | None:
    """What an earlier run has left at `path`, which is about to be written; None where there is nothing.

    What is no longer whole counts as nothing, of which `say` is told, and so does what this user's kinform did not
    write, unless `trust`, of which `say_unknown` is told. What makes no sense raises NotWholeError where it is read.
    Raises ResultsError when `write` would refuse this path.
    """
    check_output(path)
    target = Path(path)
    if not target.exists() or target.stat().st_size == 0:
        return None
    try:
        found = Earlier(path)
    except NotWholeError as error:
        if say is not None:
            say(as_absent(error))
        return None
    if found.recorded or trust:
        return found
    found.close()
    if say_unknown is not None:
        say_unknown(f"{path}: {computed_anew(path)}")
    return None


def is_unknown(path: str | Path) -> bool:
    """Whether there are results at `path` that this user's kinform did not record."""
    try:
        with opened(path) as file:
            return not file.recorded
    except (ResultsError, *DAMAGE):
        return False


def computed_anew(path: str | Path) -> str:
    """What is said of earlier results that are not used for that."""
    return f"{unknown_origin(path)}: computed anew; --trust-results uses them"


def unknown_origin(path: str | Path) -> str:
    """What is said of a file that this user's kinform did not record, and why it did not where that is known."""
    why = provenance.fault(path)
    return f"results of unknown origin ({why})" if why else "results of unknown origin"


def fault_of(path: str | Path) -> ResultsError | None:
    """Why the results file at `path` is as good as none, and may be written again; None where it is whole and makes
    sense, or where there is nothing that was written as one."""
    try:
        read(path)
    except NotWholeError as error:
        return error
    except ResultsError:
        return None
    return None


def as_absent(error: ResultsError) -> str:
    """What is said of a file that is not whole and is written anew."""
    return f"{error.problem.file}: {error.problem.message}; it counts as absent, and is made again"


def to_bytes(design: Design) -> bytes:
    """The results file as bytes: the same design gives the same bytes, everywhere."""
    return seal(_image(design), SCHEMA)


def _image(design: Design) -> bytes:
    """The HDF5 of a results file, made to stand behind its seal."""
    file = h5py.File(
        "results", "w", driver="core", backing_store=False, block_size=GROWTH, userblock_size=BLOCK,
        libver=("earliest", "v108"), track_order=False,
    )  # fmt: skip
    with file:
        file.attrs["schema"] = SCHEMA
        file.attrs["kinform"] = __version__
        write_groups(file, design)
        file.flush()
        image: bytes = file.id.get_file_image()
    return image


def _group(file: h5py.File, name: str, marks: Fingerprints) -> h5py.Group:
    group = file.create_group(name)
    group.attrs["schema"] = f"{SCHEMA}/{name}"
    group.attrs["fingerprint"] = marks.stages.get(STAGE_OF.get(name, name), "")
    if name in marks.lineage:
        group.attrs["lineage"] = marks.lineage[name]
    if name in marks.inputs:
        group.attrs["inputs"] = json.dumps(marks.inputs[name], sort_keys=True)
    return group


def write_groups(file: h5py.File, design: Design, only: Container[str] | None = None) -> None:
    """All groups of which something is known; or `only` some of them."""
    kinematics = design.kinematics
    contents = {
        "assembly": design.assembly, "surfaces": design.surfaces or design.contacts, "contacts": design.contacts,
        "constraints": kinematics, "joints": kinematics, "mobility": kinematics, "mass": design.mass,
        "behaviour": design.behaviour, "simulation": design.simulation, "findings": design.report,
    }  # fmt: skip
    for name, content in contents.items():
        if content is not None and (only is None or name in only):
            codec(name).write(_group(file, name, design.fingerprints), design)


def files_of(path: str | Path) -> tuple[str, ...]:
    """The files that were read for these results, relative to the manifest; () where there are no such results."""
    try:
        with opened(path) as file:
            return assembly.read_files(file.group("assembly"))
    except (ResultsError, *DAMAGE):
        return ()


def read_if_current(path: str | Path, manifest: Path, *, allow_outside: bool, trust: bool = False) -> Design | None:
    """What findings are told with, of results that are what a run of the manifest would give; None of others, and of
    those that this user's kinform did not write, unless `trust`.

    The assembly is without parts, the kinematics without joints. Raises nothing: whatever is wrong with the file or
    its inputs, a run will tell.
    """
    try:
        with opened(path) as file:
            if not (file.recorded or trust):
                return None
            marks = Fingerprints(lineage=marks_of(file, "lineage"), recorded=file.recorded)
            contents = assembly.read_contents(file.group("assembly"))
            written_from = marks.lineage.get("findings")
            if not written_from or written_from != lineage.current(manifest, contents, allow_outside=allow_outside):
                return None
            for name in file.groups():
                check_group(file, name)
            gist = assembly.read_header(file.group("assembly"))
            report = of_origin(codec("findings").read(file.group("findings")), file.recorded)
            return Design(gist, kinematics=_bodies(file, gist), report=report, fingerprints=marks)
    except (ResultsError, *DAMAGE):
        return None


def read_gist(path: str | Path, *, recorded: bool | None = None) -> Design:
    """What findings are told with, of results as they are: the assembly without parts, the kinematics with its bodies
    and mobility alone; of fingerprints lineage and files. `recorded` as of Design, where the caller knows. Raises
    ResultsError as `read` does."""
    from kinform.model.kinematics import only_bodies
    from kinform.results.groups import joints, mobility

    with opened(path) as file:
        try:
            for name in file.groups():
                check_group(file, name)
            gist = assembly.read_header(file.group("assembly"))
            contents = assembly.read_contents(file.group("assembly"))
            bodies = only_bodies(joints.read_bodies(file.group("joints")))
            kinematics = dataclasses.replace(bodies, mobility=mobility.read(file.group("mobility")))
            known = file.recorded if recorded is None else recorded
            report = of_origin(codec("findings").read(file.group("findings")), known)
        except NONSENSE as error:
            raise not_whole(path, f"the results file is damaged ({error})") from error
        marks = Fingerprints(lineage=marks_of(file, "lineage"), files=contents, recorded=known)
        return Design(gist, kinematics=kinematics, report=report, fingerprints=marks)


def _bodies(file: HeldGroup, gist: Assembly) -> Kinematics | None:
    """The bodies, where the ground is one that kinform chose and findings are told with a note about it."""
    if gist.ground is not None:
        return None
    from kinform.model.kinematics import only_bodies
    from kinform.results.groups import joints

    return only_bodies(joints.read_bodies(file.group("joints")))
