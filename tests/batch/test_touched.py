"""What a commit touches."""

from __future__ import annotations

import subprocess
from pathlib import Path

import pytest
from support.command_line import ran_here

from kinform.batch import touched as module
from kinform.batch.desk import do
from kinform.batch.discovery import discover
from kinform.batch.touched import changed_since
from kinform.errors import InputError


def git(folder: Path, *words: str) -> None:
    name = ("-c", "user.name=t", "-c", "user.email=t@example.org", "-c", "commit.gpgsign=false")
    subprocess.run(["git", "-C", str(folder), *name, *words], check=True, capture_output=True)


def manifest(*lines: str) -> str:
    return "\n".join(['schema = 1\n[assembly]\nname = "a"\nunits = "mm"', *lines])


def solid(size: float) -> str:
    """A tetrahedron, as STL."""
    points = [(0, 0, 0), (size, 0, 0), (0, size, 0), (0, 0, size)]
    faces = [[points[k] for k in face] for face in ((0, 2, 1), (0, 1, 3), (0, 3, 2), (1, 2, 3))]
    loops = ["\n".join(f"vertex {x} {y} {z}" for x, y, z in face) for face in faces]
    return (
        "solid s\n"
        + "".join(f"facet normal 0 0 0\nouter loop\n{one}\nendloop\nendfacet\n" for one in loops)
        + ("endsolid s\n")
    )


PART = ("[[part]]", "name='p'")
URDF = '<robot name="arm"><link name="l"><visual><geometry><mesh filename="package://arm/meshes/link.stl"/>'
URDF += '</geometry></visual><inertial><mass value="1"/></inertial></link></robot>'
FILES = {
    "top.toml": manifest("[[subassembly]]", 'name = "m"', 'file = "sub/motor.toml"'),
    "sub/motor.toml": manifest(*PART, "mesh = 'parts/rotor.stl'"),
    "sub/parts/rotor.stl": solid(3), "alone.toml": manifest(*PART, '"m\\u0065sh"="alone.stl"'),
    "alone.stl": solid(4), "ros/arm/urdf/arm.urdf": URDF, "ros/arm/meshes/link.stl": solid(5),
    "arm/meshes/link.stl": solid(6), "other.txt": "nothing",
}  # fmt: skip


@pytest.fixture(autouse=True)
def read_here(request, monkeypatch):
    """Designs are read in this process, which takes less time than to start another; the command is tested as it is."""
    if "command" not in request.node.name:
        monkeypatch.setattr(module, "perform", do)


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


def touched(repository: Path, revision: str = "HEAD") -> list[str]:
    return [one.name for one in changed_since(discover([repository]), revision)]


@pytest.mark.parametrize(
    ("changed", "designs"),
    [
        ("sub/parts/rotor.stl", ["sub/motor.toml", "top.toml"]),
        ("sub/motor.toml", ["sub/motor.toml", "top.toml"]),
        ("top.toml", ["top.toml"]),
        ("alone.stl", ["alone.toml"]),
        ("ros/arm/meshes/link.stl", ["ros/arm/urdf/arm.urdf"]),
        ("arm/meshes/link.stl", []),
        ("other.txt", []),
    ],
)
def test_a_changed_file_touches_what_names_it_in_any_depth(repository, changed, designs):
    (repository / changed).write_text(FILES[changed] + " ")
    assert touched(repository) == sorted(designs)


def test_what_a_link_points_to_touches_and_another_link_touches_all(repository):
    (repository / "linked.toml").write_text(manifest(*PART, 'mesh="other.stl"'))
    (repository / "other.stl").symlink_to("alone.stl")
    git(repository, "add", ".")
    git(repository, "commit", "-qm", "a link")
    assert touched(repository) == []
    (repository / "alone.stl").write_text(solid(9))
    assert touched(repository) == ["alone.toml", "linked.toml"]
    git(repository, "checkout", "alone.stl")
    (repository / "other.stl").unlink()
    (repository / "other.stl").symlink_to("sub/parts/rotor.stl")
    assert touched(repository) == [one.name for one in discover([repository])]


def test_a_file_that_is_gone_touches_what_opens_another_of_its_name_instead(repository):
    (repository / "ros/arm/meshes/link.stl").unlink()
    git(repository, "commit", "-qam", "gone")
    assert touched(repository, "HEAD~1") == ["ros/arm/urdf/arm.urdf"]
    assert touched(repository) == []


def test_another_package_touches_all(repository):
    (repository / "ros/arm/package.xml").write_text("<package><name>arm</name></package>")
    git(repository, "add", ".")
    assert len(touched(repository)) == len(discover([repository]))


def test_ends_of_lines_and_pointers_of_lfs_touch_nothing(repository):
    import hashlib

    data = solid(4).encode()
    pointer = f"version https://git-lfs.github.com/spec/v1\noid sha256:{hashlib.sha256(data).hexdigest()}\nsize 1\n"
    (repository / "alone.stl").write_text(pointer)
    git(repository, "commit", "-qam", "a pointer")
    (repository / "alone.stl").write_bytes(data)
    (repository / "top.toml").write_bytes(FILES["top.toml"].replace("\n", "\r\n").encode())
    assert touched(repository) == []


def test_what_git_could_run_is_not_run(repository):
    marker = repository.parent / f"{repository.name}_ran"
    script = repository.parent / f"{repository.name}.sh"
    script.write_text(f"#!/bin/sh\ntouch '{marker}'\ncat\n")
    script.chmod(0o755)
    for name in ("core.fsmonitor", "diff.external", "diff.d.textconv", "filter.f.clean", "filter.f.smudge",
                 "diff.d.command", "core.pager", "core.sshCommand", "core.alternateRefsCommand"):  # fmt: skip
        git(repository, "config", name, str(script))
    (repository / ".git" / "hooks").mkdir(exist_ok=True)
    for name in ("post-index-change", "fsmonitor-watchman", "reference-transaction"):
        (repository / ".git" / "hooks" / name).symlink_to(script)
    (repository / ".gitattributes").write_text("* filter=f diff=d\n")
    (repository / "alone.stl").write_text(solid(9))
    assert touched(repository) == ["alone.toml"]
    assert not marker.exists()


def test_a_design_in_a_submodule_is_compared_with_what_the_outer_repository_had(
    repository, tmp_path_factory, monkeypatch
):
    inner = tmp_path_factory.mktemp("inner")
    for name in ("alone.toml", "alone.stl"):
        (inner / name).write_text(FILES[name] + " ")
    git(inner, "init", "-q", "-b", "main")
    git(inner, "add", ".")
    git(inner, "commit", "-qm", "a design that the outer repository never had")
    git(repository, "branch", "main")
    git(repository, "checkout", "-q", "-b", "request")
    git(repository, "rm", "-q", "-r", "sub")
    git(repository, "-c", "protocol.file.allow=always", "submodule", "add", "-q", str(inner), "sub")
    git(repository, "commit", "-qm", "the folder is a submodule")
    assert "sub/alone.toml" in touched(repository, "main")
    monkeypatch.chdir(repository)
    assert "sub/alone.toml" in touched(repository, "main")
    monkeypatch.chdir(repository / "sub")
    assert touched(repository / "sub", "main") == []


def test_a_submodule_at_another_commit_touches_what_names_its_files(repository, tmp_path_factory):
    inner = tmp_path_factory.mktemp("inner")
    (inner / "leg.stl").write_text(solid(1))
    git(inner, "init", "-q")
    git(inner, "add", ".")
    git(inner, "commit", "-qm", "one")
    git(repository, "-c", "protocol.file.allow=always", "submodule", "add", "-q", str(inner), "meshes")
    (repository / "leg.toml").write_text(manifest(*PART, 'mesh="meshes/leg.stl"'))
    git(repository, "add", ".")
    git(repository, "commit", "-qm", "a submodule")
    assert touched(repository) == []
    (repository / "meshes" / "leg.stl").write_text(solid(2))
    git(repository / "meshes", "commit", "-qam", "two")
    assert touched(repository) == ["leg.toml"]


def test_nothing_changed_touches_nothing(repository):
    assert touched(repository) == []


def test_a_mesh_that_is_gone_and_one_that_is_new_touch(repository):
    (repository / "alone.stl").unlink()
    assert "alone.toml" in touched(repository)
    (repository / "new.toml").write_text(manifest())
    assert "new.toml" in touched(repository)


def test_commits_count_as_changes_that_are_not_committed_do(repository):
    (repository / "sub/parts/rotor.stl").write_text(solid(8))
    git(repository, "commit", "-qam", "rotor")
    assert touched(repository) == []
    assert touched(repository, "HEAD~1") == ["sub/motor.toml", "top.toml"]


def test_a_revision_that_is_none_is_refused(repository):
    with pytest.raises(InputError) as caught:
        changed_since(discover([repository]), "--help")
    assert "--help" in caught.value.problems[0].message


def test_the_command_says_how_much_is_touched_and_refuses_what_is_no_revision(repository):
    (repository / "other.txt").write_text("something")
    words = ("batch", ".", "-o", "results", "--changed-since")
    ran = ran_here(*words, "HEAD", cwd=repository)
    assert ran.returncode == 0 and {"0", "4"} <= set(ran.stderr.split()), ran.stderr
    ran = ran_here(*words, "no_such", cwd=repository)
    assert ran.returncode == 2 and "no_such" in ran.stderr, ran.stderr
