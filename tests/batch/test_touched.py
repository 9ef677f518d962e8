"""What a commit touches."""

from __future__ import annotations

import subprocess
from pathlib import Path

import pytest
from support.command_line import ran_here

from kinform.batch import touched as module
from kinform.batch.discovery import discover
from kinform.errors import InputError

pytest.importorskip("pathspec")


def git(folder: Path, *words: str) -> None:
    name = ("-c", "user.name=t", "-c", "user.email=t@example.org", "-c", "commit.gpgsign=false")
    subprocess.run(["git", "-C", str(folder), *name, *words], check=True, capture_output=True)


def manifest(*lines: str) -> str:
    return "\n".join(['schema = 1\n[assembly]\nname = "a"\nunits = "mm"', *lines])


FILES = {
    "top.toml": manifest("[[subassembly]]", 'name = "m"', 'file = "sub/motor.toml"'),
    "sub/motor.toml": manifest("[[part]]", "name='p'", "mesh = 'parts/rotor.stl'"),
    "sub/parts/rotor.stl": "solid a", "alone.toml": manifest("[[part]]", "name='p'", 'mesh="alone.stl"'),
    "alone.stl": "solid b",
    "ros/urdf/arm.urdf.xacro": '<robot name="arm"><xacro:include filename="$(find arm)/urdf/links.xacro"/></robot>',
    "ros/urdf/links.xacro": '<robot><mesh filename="package://arm/meshes/${part}.stl"/></robot>',
    "ros/meshes/link.stl": "solid c", "ros/meshes/link.dae": "<COLLADA/>", "other.txt": "nothing",
}  # fmt: skip


@pytest.fixture
def repository(tmp_path: Path) -> Path:
    """Designs in a repository with one commit."""
    for name, text in FILES.items():
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).write_text(text)
    git(tmp_path, "init", "-q")
    git(tmp_path, "add", ".")
    git(tmp_path, "commit", "-qm", "all")
    return tmp_path


def touched(repository: Path) -> list[str]:
    for cached in (module._names, module._files, module._root):
        cached.cache_clear()
    return [one.name for one in module.changed_since(discover([repository]), "HEAD")]


def by_name(repository: Path) -> list[str]:
    """Without the one that any mesh may touch."""
    return [name for name in touched(repository) if name != "ros/urdf/arm.urdf.xacro"]


@pytest.mark.parametrize(
    ("changed", "designs"),
    [
        ("sub/parts/rotor.stl", ["sub/motor.toml", "top.toml"]),
        ("sub/motor.toml", ["sub/motor.toml", "top.toml"]),
        ("top.toml", ["top.toml"]),
        ("alone.stl", ["alone.toml"]),
        ("ros/urdf/links.xacro", ["ros/urdf/arm.urdf.xacro"]),
        ("ros/meshes/link.stl", ["ros/urdf/arm.urdf.xacro"]),
        ("other.txt", []),
    ],
)
def test_a_changed_file_touches_what_names_it_in_any_depth(repository, changed, designs):
    (repository / changed).write_text(FILES[changed] + " ")
    wildcards = ["ros/urdf/arm.urdf.xacro"] if changed.endswith(".stl") else []
    assert touched(repository) == sorted({*designs, *wildcards})


def test_what_a_link_points_to_and_where_a_link_points_touch(repository):
    (repository / "linked.toml").write_text(manifest("[[part]]", 'name="p"', 'mesh="other.stl"'))
    (repository / "other.stl").symlink_to("alone.stl")
    git(repository, "add", ".")
    git(repository, "commit", "-qm", "a link")
    (repository / "alone.stl").write_text("solid changed")
    assert by_name(repository) == ["alone.toml", "linked.toml"]
    git(repository, "checkout", "alone.stl")
    (repository / "other.stl").unlink()
    (repository / "other.stl").symlink_to("sub/parts/rotor.stl")
    assert by_name(repository) == ["linked.toml"]


@pytest.mark.parametrize(
    ("file", "text", "mesh"),
    [
        ("a.urdf", '<robot name="a"><mesh filename="a&amp;b.stl"/></robot>', "a&b.stl"),
        ("a.toml", manifest("[[part]]", 'name="p"', r'mesh="\u00fc.stl"'), "ü.stl"),
        ("a.toml", manifest("[[subassembly]]", 'name="p"', 'file="x.GLTF"'), "my buffer.bin"),
    ],
)
def test_names_that_are_written_with_escapes_are_understood(repository, file, text, mesh):
    (repository / file).write_text(text)
    (repository / mesh).write_text("1")
    (repository / "x.GLTF").write_text('{"buffers": [{"uri": "my%20buffer.bin"}]}')
    git(repository, "add", ".")
    git(repository, "commit", "-qm", "escapes")
    (repository / mesh).write_text("2")
    assert by_name(repository) == [file]


def test_a_submodule_at_another_commit_touches_what_names_its_files(repository, tmp_path_factory):
    inner = tmp_path_factory.mktemp("inner")
    (inner / "leg.stl").write_text("1")
    git(inner, "init", "-q")
    git(inner, "add", ".")
    git(inner, "commit", "-qm", "one")
    git(repository, "-c", "protocol.file.allow=always", "submodule", "add", "-q", str(inner), "meshes")
    (repository / "leg.toml").write_text(manifest("[[part]]", 'name="p"', 'mesh="meshes/leg.stl"'))
    git(repository, "add", ".")
    git(repository, "commit", "-qm", "a submodule")
    assert touched(repository) == []
    (repository / "meshes" / "leg.stl").write_text("2")
    git(repository / "meshes", "commit", "-qam", "two")
    assert by_name(repository) == ["leg.toml"]


def test_nothing_changed_touches_nothing(repository):
    assert touched(repository) == []


def test_a_mesh_that_is_gone_and_one_that_is_new_touch(repository):
    (repository / "alone.stl").unlink()
    assert "alone.toml" in touched(repository)
    (repository / "new.toml").write_text(manifest())
    assert "new.toml" in touched(repository)


def test_commits_count_as_changes_that_are_not_committed_do(repository):
    (repository / "sub/parts/rotor.stl").write_text("solid other")
    git(repository, "commit", "-qam", "rotor")
    found = discover([repository])
    assert module.changed_since(found, "HEAD") == ()
    assert {one.name for one in module.changed_since(found, "HEAD~1")} >= {"sub/motor.toml", "top.toml"}


def test_a_revision_that_is_none_is_refused(repository):
    with pytest.raises(InputError) as caught:
        module.changed_since(discover([repository]), "--help")
    assert "--help" in caught.value.problems[0].message


def test_the_command_says_how_much_is_touched_and_refuses_what_is_no_revision(repository):
    (repository / "other.txt").write_text("something")
    words = ("batch", ".", "-o", "results", "--changed-since")
    ran = ran_here(*words, "HEAD", cwd=repository)
    assert ran.returncode == 0 and {"0", "4"} <= set(ran.stderr.split()), ran.stderr
    ran = ran_here(*words, "no_such", cwd=repository)
    assert ran.returncode == 2 and "no_such" in ran.stderr, ran.stderr
