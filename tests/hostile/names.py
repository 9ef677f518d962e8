"""Names and designs that a stranger may write, and what no reader may find in what kinform writes of them."""

from __future__ import annotations

import json
import re
from pathlib import Path
from xml.sax.saxutils import quoteattr

NAMES = (
    "##[stop-commands]x",
    "a\n::error::A",
    "::stop-commands::token",
    "x ::set-env name=a::b",
    "##vso[task.setvariable variable=a]b",
    "\x1b[31mRED\x1b]0;title\x07\x9b2J",
    "ev\u202eil\u2066 \u200bzero\ufeff",
    "=cmd|'/c calc'!A0",
    "+1;=2",
    "-dash\t@tab",
    "<script>alert(1)</script>&lt;\"'><img src=x onerror=alert(2)>",
    "`|[a](javascript:alert(1))@everyone #1 <b> http://evil.example GH-1",
    'dot"; A -> B; \\"end',
    "vhdl -- \n; end entity; --",
    "modelica */ \\",
    "]]> --> <!--",
    "../../etc/pass\\wd",
    "con",
    ".hidden",
    "$(touch made-by-make)",
)
"""What terminals, runners, spreadsheets, browsers, Make, compilers and file systems would obey."""
IN_MANIFEST = tuple(name.replace("/", "|") for name in NAMES)
"""A slash in the name of a part separates sub-assemblies."""
FEW = tuple(IN_MANIFEST[k] for k in (0, 1, 2, 5, 6, 7, 10, 11, 12))
"""Of each kind of reader one, for tests that are to be quick."""
IN_XML = tuple(name for name in NAMES if not re.search(r"[\x00-\x08\x0b\x0c\x0e-\x1f]", name))


def manifest(names: tuple[str, ...] = IN_MANIFEST) -> str:
    """A base with an arm on a hinge for every name, all sticks, and two boxes that overlap."""
    base, quoted = json.dumps(names[0]), [json.dumps(name).replace("\x7f", "\\u007f") for name in names]
    lines = ["schema = 1", "[assembly]", f"name = {quoted[1]}", 'units = "mm"', f"ground = {base}"]
    for name in quoted:
        lines += ["[[part]]", f"name = {name}"]
    for k, name in enumerate(("box\n::error::1", "box ##[group]2")):
        lines += ["[[part]]", f"name = {json.dumps(name)}", 'shape = {type = "box", size = [20, 20, 4]}',
                  f"position = [500, 0, {k}]", f"material = {json.dumps('steel')}"]  # fmt: skip
    lines += ["[function]", f"mobility = {len(names)}"]
    for k, name in enumerate(quoted[1:]):
        lines += ["[[function.joint]]", f"name = {json.dumps('::warning::j' + names[k + 1])}", 'type = "revolute"',
                  f"between = [{base}, {name}]", "axis = [0, 0, 1]", f"point = [{20 * k}, 0, 0]"]  # fmt: skip
    lines += ["[[function.require]]", 'name = "::error file=x::y\\n::error::z"', 'kind = "mass"',
              'of = "box\\n::error::1"', "maximum = 0.0001"]  # fmt: skip
    return "\n".join(lines) + "\n"


def urdf(names: tuple[str, ...] = IN_XML) -> str:
    """A chain of links with these names, as far as XML carries them."""
    links = [f'<link name={quoteattr(name)}><inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1" ixy="0" '
             f'ixz="0" iyz="0"/></inertial></link>' for name in names]  # fmt: skip
    joints = [f'<joint name={quoteattr("j" + child)} type="revolute"><parent link={quoteattr(parent)}/>'
              f'<child link={quoteattr(child)}/><axis xyz="0 0 1"/><limit lower="-1" upper="1" effort="1" '
              f'velocity="1"/></joint>' for parent, child in zip(names, names[1:], strict=False)]  # fmt: skip
    return f"<robot name={quoteattr(names[1])}>{''.join(links + joints)}</robot>"


def mjcf(names: tuple[str, ...] = IN_XML) -> str:
    """The same as bodies on hinges."""
    bodies = "".join(f'<body name={quoteattr(name)}><joint name={quoteattr("j" + name)} type="hinge" axis="0 0 1"/>'
                     f'<inertial pos="0 0 0" mass="1" diaginertia="1 1 1"/></body>' for name in names)  # fmt: skip
    return f"<mujoco model={quoteattr(names[1])}><worldbody>{bodies}</worldbody></mujoco>"


def sdf(names: tuple[str, ...] = IN_XML) -> str:
    """The same as a model; "::" separates names there."""
    own = [name.replace("::", ":") for name in names]
    links = "".join(f"<link name={quoteattr(name)}/>" for name in own)
    return f'<sdf version="1.9"><model name={quoteattr(own[0])}>{links}</model></sdf>'


_COLOUR = re.compile(r"\x1b\[[0-9;]*m")
_RUNNER = re.compile(r"^\s*::|##\w*\[", re.MULTILINE)


def forbidden(text: str, *, colours: bool = False, commands: bool = True) -> list[str]:
    """What a terminal or a CI runner would obey, or people would be misled by: each with what stands around it."""
    plain = _COLOUR.sub("", text) if colours else text
    found = [plain[max(k - 20, 0) : k + 20] for k, c in enumerate(plain) if not (c.isprintable() or c in "\n\t")]
    return found + ([match[0] + plain[match.end() :][:20] for match in _RUNNER.finditer(plain)] if commands else [])


def write_all(folder: Path) -> dict[str, Path]:
    """The designs, by kind."""
    texts = {"m.toml": manifest(), "r.urdf": urdf(), "r.xml": mjcf(), "r.sdf": sdf()}
    for name, text in texts.items():
        (folder / name).write_text(text, encoding="utf-8")
    return {name: folder / name for name in texts}
