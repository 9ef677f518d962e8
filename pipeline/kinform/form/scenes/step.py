"""STEP (ISO 10303-21): solids of a CAD program, tessellated by OpenCASCADE through cascadio, an optional package.

OpenCASCADE is native code that may end the process, writes to the terminal, reads its configuration in the working
folder and other files that a file refers to wherever they are, and takes a broken file for as much of it as it can
read: the frame of the file is looked at before, it runs in a process of its own, which leaves the working folder and on
Linux can open no file, and what it says is read after. It gives a GLB in metres, whose vertices lie on the surfaces;
what lies between them is measured on the facets, as that of any mesh (`chord` of surfaces).
"""

from __future__ import annotations

import re
from dataclasses import replace
from pathlib import Path

from kinform.form.constants import STEP_TURN
from kinform.form.meshes.raw import Fault, MeshError
from kinform.form.scenes.scene import EXPORT, Scene
from kinform.form.sources import AS_IT_IS, Reading
from kinform.formats.gltf.reading.reader import read_gltf
from kinform.foundation.name_hints import first_names, in_quotes
from kinform.foundation.no_more_files import open_no_more_files
from kinform.foundation.processes import Crash, in_own_process
from kinform.foundation.words import counted

STEP_BYTES = 1 << 30
"""Largest STEP file that is read: the largest public ones have a quarter of it, and OpenCASCADE takes twenty times as
much memory."""
STEP_END = 4096
"""Bytes at either end of a STEP file in which its first and last keyword stand: comments and blanks around them are
shorter. Chosen, not measured."""
STEP_MEMORY = 12 << 30
"""Bytes of memory that the tessellation of a STEP file may take: beyond, it fails with a message, not the machine.
Chosen, not measured."""
STEP_EDGES = 0.005
"""Largest distance of facets from surfaces, as a share of the size of edges: not a length, for what is fine for a watch
takes all memory for a ship (a ball of 10 m, at 0.01 mm, more than 20 GB)."""
STEP_STATED_TURN = 0.25
"""As STEP_TURN, where a deviation is stated: still 25 facets round a circle, for 12 are as few as fits know a cylinder
by."""


AGAIN = "export it again, as AP214 or AP242"
_PREFIXES = {b"$": "m", b".MILLI.": "mm", b".CENTI.": "cm", b".MICRO.": "um"}
_NAMED = {b"INCH": "in", b"FOOT": "ft"}
_COMMENT = re.compile(rb"/\*.*?\*/", re.DOTALL)
_LENGTH = re.compile(rb"\bLENGTH_UNIT\s*\(", re.IGNORECASE)
_SI = re.compile(rb"SI_UNIT\s*\(\s*(\$|\.[A-Z]+\.)\s*,\s*\.METRE\.\s*\)")
_CONVERSION = re.compile(rb"CONVERSION_BASED_UNIT\s*\(\s*'(INCH|FOOT)'", re.IGNORECASE)
_REFERENCE = re.compile(rb"(?<![A-Z0-9_])(?:DOCUMENT_FILE|DCMFL)(?![A-Z0-9_])", re.IGNORECASE)
"""The entity, by its name and its short name, without which OpenCASCADE opens no other file: it reads parts from those
that entities of it name, wherever they are."""
_FAILS = re.compile(r"Fails Count\s*:\s*(\d+)")
_SYNTAX = re.compile(r"Line (\d+):\s*(.*?)\s*\**\s*$", re.MULTILINE)
_SKIPPED = re.compile(r"skipped node '(.*?)' without geometry")


def read_step(data: bytes, path: Path, reading: Reading = AS_IT_IS) -> Scene:
    """The scene of a STEP file, tessellated as `reading` says. Raises MeshError."""
    _check_frame(data)
    glb, said = _converted(data, reading)
    faults = _SYNTAX.search(said)
    if faults is not None:
        message = f"is no STEP from there on: {faults[2][:100]}"
        raise MeshError([Fault(message, AGAIN, int(faults[1]))])
    fails = _FAILS.search(said)
    if fails is not None:
        many = counted(int(fails[1]), "entity", "entities")
        raise MeshError([Fault(f"has {many} that OpenCASCADE cannot read, and that would be left out", AGAIN)])
    if not glb:
        raise MeshError([Fault("holds no solid that OpenCASCADE can read", AGAIN)])
    try:
        scene = read_gltf(glb, path)
    except MeshError as error:
        message = f"holds what OpenCASCADE cannot read: the scene that it makes of it {error.faults[0].message}"
        raise MeshError([Fault(message, AGAIN)]) from None
    notes = [_deviation(reading)]
    empty = [in_quotes(name) for name in dict.fromkeys(_SKIPPED.findall(said))]
    if empty:
        notes.append(f"{first_names(empty)} of the file without geometry: left out")
    return replace(scene, notes=(*scene.notes, *notes), shown=_unit(data))


def _check_frame(data: bytes) -> None:
    """Whether a text begins and ends as STEP does: the native reader would take a part of one for all of it."""
    if data[:2] in (b"\x1f\x8b", b"PK"):
        raise MeshError([Fault("is compressed", "unpack it first")])
    if len(data) > STEP_BYTES:
        raise MeshError([Fault(f"has {len(data):,} bytes, and {STEP_BYTES:,} are the most", "divide it")])
    begin = _COMMENT.sub(b"", data[:STEP_END]).lstrip(b"\xef\xbb\xbf \t\r\n")
    if not begin.startswith(b"ISO-10303-21"):
        raise MeshError([Fault("is no STEP: it does not begin with ISO-10303-21", EXPORT, 1)])
    if b"END-ISO-10303-21" not in data[-STEP_END:]:
        last = data.rstrip().count(b"\n") + 1
        raise MeshError([Fault("is cut short: END-ISO-10303-21 is missing at its end", EXPORT, last)])
    reference = _REFERENCE.search(data)
    if reference is not None:
        line = data.count(b"\n", 0, reference.start()) + 1
        raise MeshError([Fault("refers to other files (DOCUMENT_FILE), which are not read",
                               "export all parts into one file", line)])  # fmt: skip
    if not _LENGTH.search(data):
        raise MeshError([Fault("states no unit of length (LENGTH_UNIT): its lengths could be of any", EXPORT)])


def _unit(data: bytes) -> str | None:
    """The unit of length in which the file is written, where it is one that kinform has."""
    named, si = _CONVERSION.search(data), _SI.search(data)
    if named is not None:
        return _NAMED[named[1].upper()]
    return None if si is None else _PREFIXES.get(si[1])


def _deviation(reading: Reading) -> str:
    """How finely it was tessellated, as a note."""
    if reading.deviation is not None:
        return (
            f"tessellated: facets lie at most {reading.deviation * 1e3:g} mm from the surfaces, "
            f"{STEP_STATED_TURN:g} rad from each other"
        )
    return (
        f"tessellated: facets turn by at most {STEP_TURN:g} rad, and lie at most {STEP_EDGES:.1%} of the edges' size "
        "from the surfaces (--deviation 0.01mm states a length)"
    )


def _converted(data: bytes, reading: Reading) -> tuple[bytes, str]:
    """A GLB, empty where nothing can be made of it, and what OpenCASCADE said."""
    try:
        import cascadio  # noqa: F401
    except ImportError:
        remedy = "pip install 'kinform[step]' (about 30 MB), or export GLB from the CAD program"
        raise MeshError([Fault("is STEP, and the package that reads it is not installed", remedy)]) from None
    try:
        return in_own_process(lambda: _in_the_fork(data, reading))
    except Crash as crash:
        remedy = f"{AGAIN}; or state a coarser --deviation, if it is very large"
        raise MeshError([Fault(f"cannot be read: OpenCASCADE ended by {crash.cause} on it", remedy)]) from None
    except MemoryError:
        remedy = "state a coarser --deviation, or divide it"
        raise MeshError([Fault("takes more memory to tessellate than there is", remedy)]) from None


def _in_the_fork(data: bytes, reading: Reading) -> tuple[bytes, str]:
    import faulthandler
    import os
    import tempfile

    import cascadio

    faulthandler.disable()  # an end by a signal is told as a problem of the file
    _bound_memory()
    stated = reading.deviation
    with tempfile.TemporaryFile() as said:
        for stream in (1, 2):
            os.dup2(said.fileno(), stream)
        os.chdir(os.sep)  # OpenCASCADE looks for its configuration in the working folder
        open_no_more_files()
        glb = cascadio.to_glb_bytes(
            data,
            cascadio.FileType.STEP,
            tol_linear=STEP_EDGES if stated is None else stated * 1e3,  # mm, whatever the unit of the file
            tol_angular=STEP_TURN if stated is None else STEP_STATED_TURN,
            tol_relative=stated is None,
            use_parallel=False,
        )
        said.seek(0)
        return bytes(glb), said.read().decode("utf-8", "replace")


def _bound_memory() -> None:
    """This process may not take more than its share: too fine a tessellation fails by itself then."""
    try:
        import resource
    except ImportError:
        return
    soft, hard = resource.getrlimit(resource.RLIMIT_AS)
    if soft == resource.RLIM_INFINITY or soft > STEP_MEMORY:
        resource.setrlimit(resource.RLIMIT_AS, (STEP_MEMORY, hard))
