"""The formats that kinform reads: what reads the bytes, what it starts from, which words it knows."""

from __future__ import annotations

import atexit
import contextlib
import functools
import os
import shutil
import tempfile
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np

import descriptions
import kinform
import seeds
from kinform.errors import KinformError
from kinform.form.meshes.raw import MeshError
from structure import Grammar, words_of

REFUSED = (KinformError, MeshError)
"""What a reader raises on purpose."""


@dataclass(frozen=True)
class Target:
    """A format."""

    name: str
    run: Callable[[bytes], None]
    """Reads the bytes; raises one of REFUSED, or returns."""
    seeds: Callable[[], list[bytes]]
    words: tuple[bytes, ...] = ()
    """Words of the format."""
    share: float = 1.0
    """Of the time that all targets have."""
    grammar: Grammar | None = None


_TOP = Path(tempfile.mkdtemp(prefix="kinform-fuzz-", dir="/dev/shm" if Path("/dev/shm").is_dir() else None))
_FOLDER = _TOP / "design"
"""Where the files lie that readers are given by name; below a folder of nothing else, for readers look there."""
_FOLDER.mkdir()
_MAKER = os.getpid()


@atexit.register
def _sweep() -> None:
    """Take the files away again; not in a fork."""
    if os.getpid() == _MAKER:
        shutil.rmtree(_TOP, ignore_errors=True)


@functools.cache
def cheaper() -> None:
    """Remember what the same files give each time: where paths lead, hulls and meshes (no target moves a file); and
    give primitives fewer facets."""
    from kinform.form.meshes import health, primitives
    from kinform.formats.description import coverage

    def of_mesh(raw, *given, **named):
        divided = tuple(item.names for item in raw.labellings) if raw.labellings else ()
        numbers = (raw.vertices.tobytes(), raw.vertices.dtype, raw.faces.tobytes(), raw.written, raw.colour)
        return (*numbers, divided, *given, *named.values())

    primitives.ROUND_FACETS = 12
    os.path.realpath = _remembered(os.path.realpath, lambda path, *, strict=False: (os.fspath(path), strict))
    coverage.hull_of = _remembered(coverage.hull_of, lambda points: (points.shape, points.tobytes()))
    health.build_mesh = _remembered(health.build_mesh, of_mesh)


_REMEMBERED = 1024
"""Answers."""


def _remembered(function, key):
    answers: dict[object, object] = {}

    def asked(*given, **named):
        place = key(*given, **named)
        if place not in answers:
            if len(answers) >= _REMEMBERED:
                answers.clear()
            answers[place] = function(*given, **named)
        return answers[place]

    return asked


def _mesh(raw) -> None:
    from kinform.form.meshes.bodies import named_bodies, shell_bodies
    from kinform.form.meshes.health import build_mesh

    for body in (raw, *named_bodies(raw).values(), *shell_bodies(raw).values()):
        with contextlib.suppress(MeshError):
            mesh = build_mesh(body, 1e-3, None, path="m", body=None, solid=False)
            assert np.isfinite(mesh.vertices).all()
            assert mesh.faces.min() >= 0 and mesh.faces.max() < len(mesh.vertices)
            assert np.isfinite(mesh.health.volume)


def _stl(data: bytes) -> None:
    from kinform.form.meshes.stl import read_stl

    _mesh(read_stl(data))


def _obj(data: bytes) -> None:
    from kinform.form.meshes.obj import read_obj

    _mesh(read_obj(data))


def _manifest(data: bytes) -> None:
    from kinform import form

    _beside()
    (_FOLDER / "m.toml").write_bytes(data)
    _kept(form.load(_FOLDER / "m.toml"), data)


@functools.cache
def _beside() -> None:
    """Write what a manifest may name; no reader writes."""
    files = {"below.toml": seeds.BELOW.encode(), "a.stl": seeds.stl()[0], "a.obj": seeds.obj()[0]}
    files |= {"t.csv": seeds.LAW, "p.csv": seeds.PATH}
    files |= {name: text.encode() for name, text in descriptions.BESIDE.items()}
    for name, content in files.items():
        (_FOLDER / name).parent.mkdir(exist_ok=True)
        (_FOLDER / name).write_bytes(content)


_WITH_TABLES = """schema = 1
[assembly]
name = "x"
units = "mm"
[[part]]
name = "a"
[[part]]
name = "b"
[[function.joint]]
name = "j"
between = ["a", "b"]
type = "prismatic"
axis = [0, 0, 1]
[[function.drive]]
joint = "j"
kind = "motion"
law = {type = "table", file = "table.csv"}
[[function.require]]
name = "f"
kind = "follow"
part = "b"
point = [0, 0, 0]
path = "table.csv"
tolerance = 1
"""


@dataclass
class _Place:
    """What a reader of tables needs of a manifest: where problems go, and a frame."""

    problems: object
    X_WF: np.ndarray

    def point(self, values: list[float]) -> np.ndarray:
        return self.X_WF[:3, :3] @ np.array(values) + self.X_WF[:3, 3]


_TURNED = np.array([[0.0, -1.0, 0.0, 1.0], [1.0, 0.0, 0.0, 2.0], [0.0, 0.0, 1.0, 3.0], [0.0, 0.0, 0.0, 1.0]])


def _csv(data: bytes) -> None:
    """Reads a law and a path; what is good as either, in a manifest too."""
    from kinform import form
    from kinform.form.problems import Problems
    from kinform.form.readers.csv_tables import law_rows, path_rows

    path = _FOLDER / "table.csv"
    path.write_bytes(data)
    laws, paths = Problems(), Problems()
    times, values = law_rows(_Place(laws, _TURNED), path, "table.csv")
    assert np.isfinite([*times, *values]).all()
    assert np.isfinite([number for row in path_rows(_Place(paths, _TURNED), path, "table.csv") for number in row]).all()
    if laws and paths:
        laws.raise_if_any()
    (_FOLDER / "with_tables.toml").write_text(_WITH_TABLES)
    form.load(_FOLDER / "with_tables.toml")


def _text(data: bytes) -> str:
    from kinform.foundation.texts import read_text
    from kinform_cli.commands.check import JSON_BYTES

    (_FOLDER / "text").write_bytes(data)
    return read_text(_FOLDER / "text", JSON_BYTES, "a text")


def _baseline(data: bytes) -> None:
    from kinform.consistency import read_baseline, with_baseline

    baseline = read_baseline(_text(data), "b.json")
    report, gone = with_baseline(seeds.design().report, baseline)
    assert len(report.findings) + len(report.ignored) >= len(seeds.design().report.findings)
    assert len(gone) <= len(baseline.keys)


def _lock(data: bytes) -> None:
    from kinform.changes import read_lock, with_lock

    with_lock(seeds.design().report, seeds.design(), read_lock(_text(data), "l.json"))


def _catalog(data: bytes) -> None:
    from kinform.catalog import Wanted, find, read, write

    path = _FOLDER / "c.db"
    path.write_bytes(data)
    found = read(path)
    find(path, Wanted(joints=(("revolute", 1, None),), text=("a",), verified=True))
    write(found, _FOLDER / "again.db")


_WHOLE = 16
"""One of so many edited results files is read, used and written as a whole; of the others what the edits can change."""
_FIELDS = {"joints": "kinematics", "constraints": "kinematics", "mobility": "kinematics", "findings": "report"}
"""Of a design: what a group holds, where that has not its name."""


def _results(data: bytes) -> None:
    import edits
    from kinform import results

    made, path = edits.edited(seeds.results_images(), data), _FOLDER / "r.h5"
    path.write_bytes(made.image)
    inside = all("/" in name for name in made.names)
    if inside and sum(data) % _WHOLE:
        _part(path, seeds.results_designs()[made.which], made.names)
    else:
        _use(results.read(path))


def _part(path: Path, pristine, names: frozenset[str]) -> None:
    """Read and write the groups that were edited, after the checks of all groups that refer to them; use the design
    that they give with the others, which are as they were."""
    from dataclasses import replace

    import h5py

    import edits
    from kinform.results.conformity import check_group
    from kinform.results.file import NONSENSE, Earlier, write_groups
    from kinform.results.replacement import refuse

    touched = {name.partition("/")[0] for name in names}
    with Earlier(path) as found:
        fields = {field: getattr(found, field) for field in {_FIELDS.get(name, name) for name in touched}}
        for name in sorted(edits.groups_to_check(names) - touched):
            if name in found.file:
                try:
                    check_group(found.file, name)
                except NONSENSE as error:
                    raise refuse(path, str(error), "") from error
    design = replace(pristine, **fields)
    with h5py.File("again", "w", driver="core", backing_store=False) as file:
        write_groups(file, design, touched)
    _show(design)


def _use(design) -> None:
    """What the commands do with a design that was read."""
    from kinform.results.file import to_bytes

    to_bytes(design)
    _show(design)


def _show(design) -> None:
    """What the commands make of a design."""
    from kinform import reports
    from kinform.catalog import entry_of
    from kinform.changes import snapshot, write_lock
    from kinform.errors import StageError
    from kinform.exports import export

    steps = (
        lambda: reports.summary_json(design, None),
        lambda: write_lock(snapshot(design)) if design.kinematics is not None else None,
        lambda: entry_of(design, "r.h5", "0" * 64),
        lambda: export(design, "mjcf"),
        lambda: export(design, "dot"),
    )
    for step in steps:
        with contextlib.suppress(StageError):
            step()


def _source(suffix: str) -> Callable[[bytes], None]:
    """Reads a description of a robot, whose mesh lies beside it; or a CAD or scene file."""

    def run(data: bytes) -> None:
        from kinform import form

        _beside()
        (_FOLDER / f"robot{suffix}").write_bytes(data)
        _kept(form.load(_FOLDER / f"robot{suffix}"), data)

    return run


def _xacro(data: bytes) -> None:
    """Reads a xacro file; one of `_WHOLE` expands it in a process of its own, as kinform does, the others here."""
    read = _source(".urdf.xacro")
    if sum(data) % _WHOLE == 0:
        read(data)
        return
    from kinform.formats.urdf.reading import xacro

    own_process, xacro.confined = xacro.confined, _here
    try:
        read(data)
    finally:
        xacro.confined = own_process


def _here(function, answer, prepare, **limits):
    """As `confined`, without the process."""
    prepare()
    return function(answer)


def _kept(assembly, data: bytes) -> None:
    """Write what was read into results, and read those: of one of `_WHOLE` inputs."""
    if sum(data) % _WHOLE != 1:
        return
    from kinform import results
    from kinform.design import Design
    from kinform.errors import ResultsError

    results.write(Design(assembly), _FOLDER / "kept.h5")
    try:
        results.read(_FOLDER / "kept.h5")
    except ResultsError as error:
        raise AssertionError(f"written and not read: {error}") from error


def _scene(data: bytes) -> None:
    """Reads a PLY or an OFF as either; refused where both are."""
    from kinform.form.meshes.by_trimesh import read_by_trimesh

    try:
        _mesh(read_by_trimesh(data, "ply"))
    except MeshError:
        _mesh(read_by_trimesh(data, "off"))
    else:
        with contextlib.suppress(MeshError):
            _mesh(read_by_trimesh(data, "off"))


def _threemf(data: bytes) -> None:
    """Reads the model in an archive, at whose check sums every mutation of its bytes would stop."""
    (_FOLDER / "a.3mf").write_bytes(seeds.archive(data))
    _load("a.3mf")


def _dae(data: bytes) -> None:
    """Reads a COLLADA as an assembly, and as the mesh of a part."""
    from kinform.form.scenes.dae import read_dae_mesh

    (_FOLDER / "a.dae").write_bytes(data)
    with contextlib.suppress(*REFUSED):
        _load("a.dae")
    _mesh(read_dae_mesh(data))


def _load(name: str) -> None:
    from kinform import form

    form.load(_FOLDER / name)


def _text_error(run: Callable[[bytes], None]) -> Callable[[bytes], None]:
    """Also lets pass what a text that is none is refused with where the command reads it."""
    from kinform.foundation.texts import TextError

    def lenient(data: bytes) -> None:
        with contextlib.suppress(TextError):
            run(data)

    return lenient


_TOML_WORDS = (
    b"[[part]]\n", b"[[group]]\n", b"[function]\n", b"[[function.joint]]\n", b"= ", b'"""', b"'''", b".", b"true", b"[",
    b"]", b"{", b"}", b"mesh", b"name", b"position", b"mass", b"range", b'"../a.stl"', b'"m.toml"', b'"below.toml"',
    b"\\u0000",
    b"\\U0010ffff", b"1979-05-27T07:32:00Z",
)  # fmt: skip
_NAMES = (
    "p",
    "b",
    "c",
    "g",
    "s/p",
    "j",
    "k",
    "a.stl",
    "a.obj",
    "below.toml",
    "m.toml",
    "t.csv",
    "p.csv",
    "mm",
    "in",
    "KF2",
)
"""Of the seeds of manifests."""
_JSON_WORDS = (
    b"null",
    b"true",
    b"{}",
    b"[]",
    b'""',
    b"NaN",
    b"Infinity",
    b"\\ud800",
    b'"count"',
    b'"schema"',
    b"1e999",
    b",",
)
_SDF_WORDS = (
    b"relative_to='a'", b"<include><uri>robot.sdf</uri></include>", b"<include><uri>model://r</uri></include>", b"::",
    b"placement_frame='b'", b"<capsule><radius>1</radius><length>2</length></capsule>", b"expressed_in='f'",
    b"<frame name='f'/>", b"<model name='m'/>", b"world", b"inf",
)  # fmt: skip
_GLTF_WORDS = (b'"children":[0]', b'"mesh":0', b'"matrix":[', b"glTF", *_JSON_WORDS)
_XML_WORDS = (
    b"<link name='x'/>", b"<body>", b"</", b"/>", b"<!ENTITY a 'b'>", b"&#0;", b"&a;", b"<![CDATA[", b"xmlns:a='b'",
    b"name=", b"rpy=", b"${1/0}", b"${[0]*9}", b"<xacro:include filename='robot.urdf.xacro'/>", b"<freejoint/>",
    b"<!--", b"<?x?>", b"<attach model='m' prefix='a'/>", b"<model name='m' file='robot.xml'/>", b"body='palm'",
)  # fmt: skip
_STEP_WORDS = (
    b"#1", b"$", b"*", b"(", b"()", b";", b"'", b"/*", b"ENDSEC;", b"CARTESIAN_POINT", b"1.E400", b"-0.", b".T.",
    b"NEXT_ASSEMBLY_USAGE_OCCURRENCE", b"SI_UNIT($,.METRE.)", b"\\X2\\D800\\X0\\",
)  # fmt: skip
_STL_WORDS = (b"solid", b"endsolid", b"facet normal", b"outer loop", b"vertex", b"endloop", b"endfacet", b"\n", b" ")
_OBJ_WORDS = (
    b"v ",
    b"f ",
    b"o ",
    b"g ",
    b"#",
    b"/",
    b"//",
    b"\\\n",
    b"\nf 1 2 3\n",
    b"vt",
    b"curv",
    b"l 1 2",
    b"-1",
    b"\n",
)

_READERS = Path(kinform.__file__).parent
_FORMATS = _READERS / "formats"


def _xml(*modules: str, values: tuple[str, ...] = ()) -> Grammar:
    return Grammar("xml", words_of(_READERS / module for module in modules), values)


_EXPRESSIONS = (
    "${1/0}", "${[0]*9}", "${pi}", "${-1}", "${'a'*99}", "${x}", "${name}", "$(arg side)", "$(arg x)", "$(eval 1+1)",
    "$(find design)", "$(find x)", "$(env HOME)", "$(optenv X y)", "$(cwd)", "$(dirname)", "$${1}", "${{}}", "${[]}",
    "${dict(a=1)}", "${[i for i in range(9)]}", "${lambda: 1}", "${''.join(['a'])}", "${1 if True else 0}",
    "${10**400}",
    "${2**-1}", "${'a' in 'abc'}", "${'%s' % 1}", "${'{}'.format(1)}", "${xacro.load_yaml('values.yaml')}", "${None}",
    "${(1, 2)[0]}", "${len('a')}", "${int('1')}", "${float('nan')}", "${math.inf}", "${~1}", "${not x}", "${1 < 2 < 3}",
    "${xacro.arg('side')}", "${python.sorted([2, 1])}", "a:=1 *b **c", "a:=^|1 b:=^", "a:='x y' b", "*b", "**c",
    "d['b'][0]",
    "more.xacro", "$(find design)/more.xacro", "*.xacro", "true", "${True}", "parent", "global",
)  # fmt: skip


TARGETS = {
    target.name: target
    for target in (
        Target("stl", _stl, seeds.stl, _STL_WORDS),
        Target("obj", _obj, seeds.obj, _OBJ_WORDS),
        Target(
            "manifest",
            _manifest,
            seeds.manifests,
            _TOML_WORDS,
            2.0,
            Grammar("toml", words_of([_READERS / "form" / "manifest"]), _NAMES),
        ),
        Target("csv", _csv, seeds.csv, (b",", b"\n", b'"', b";")),
        Target("baseline", _text_error(_baseline), seeds.baselines, _JSON_WORDS, 0.5),
        Target("lock", _text_error(_lock), seeds.locks, _JSON_WORDS),
        Target("catalog", _catalog, seeds.catalogs, (b"CREATE TABLE", b"SELECT", b"joints")),
        Target("urdf", _source(".urdf"), descriptions.urdf, _XML_WORDS, grammar=_xml("formats/urdf/reading/reader.py")),
        Target(
            "sdf", _source(".sdf"), descriptions.sdf, (*_XML_WORDS, *_SDF_WORDS), grammar=_xml("formats/sdf/reading")
        ),
        Target("mjcf", _source(".xml"), descriptions.mjcf, _XML_WORDS, grammar=_xml("formats/mjcf/reading")),
        Target(
            "xacro", _xacro, descriptions.xacro, _XML_WORDS, grammar=_xml("formats/urdf/reading", values=_EXPRESSIONS)
        ),
        Target("scene", _scene, seeds.scenes, (b"element vertex", b"property list", b"OFF", b"\n"), 0.5),
        Target(
            "glb", _source(".glb"), seeds.glb, (b'"children":[0]', b'"mesh":0', b'"matrix":[', b"glTF", *_JSON_WORDS)
        ),
        Target(
            "3mf",
            _threemf,
            seeds.threemf,
            (*_XML_WORDS, b"transform='1 0 0'", b"unit='inch'", b"objectid='1'"),
            grammar=_xml("form/scenes/threemf.py"),
        ),
        Target(
            "dae",
            _dae,
            seeds.dae,
            (*_XML_WORDS, b"<instance_node url='#a'/>", b"<matrix>", b"Y_UP", b"meter='0'"),
            grammar=Grammar("xml", descriptions.COLLADA),
        ),
        Target("step", _source(".step"), seeds.step, _STEP_WORDS, 0.5),
        Target("results", _results, seeds.edits, (), 2.0),
    )
}
"""By name."""
