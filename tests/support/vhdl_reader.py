"""Reads the VHDL-AMS that kinform writes, as a tool would: entities, ports, generics, statements, flattened."""

from __future__ import annotations

import re
from dataclasses import dataclass, field


@dataclass
class Entity:
    """An entity with its architecture."""

    name: str
    generics: dict[str, str | None] = field(default_factory=dict)
    inputs: list[str] = field(default_factory=list)
    outputs: dict[str, str] = field(default_factory=dict)
    terminals: dict[str, str] = field(default_factory=dict)
    branches: list[tuple[str | None, str, str]] = field(default_factory=list)
    """(across, through, terminal)."""
    quantities: dict[str, str] = field(default_factory=dict)
    inner: dict[str, str] = field(default_factory=dict)
    """Terminals declared inside."""
    parts: list[tuple[str, str, dict[str, str], dict[str, str]]] = field(default_factory=list)
    """(label, entity, generic map, port map)."""
    statements: list[str] = field(default_factory=list)
    breaks: list[str] = field(default_factory=list)
    stated: int | None = None
    """Equations that the comment above it states."""


SIZES = {"real": 1, "vector3": 3, "quaternion": 4}


def read(texts):
    """(entities by name, functions by name) of files in order."""
    entities, functions = {}, {}
    for text in texts:
        for name, arguments, body in re.findall(
            r"function (\w+) \(([^)]*)\) return \w+ is\s*begin\s*return (.*?);\s*end function", text, re.S
        ):
            names = [n.strip() for group in arguments.split(";") for n in group.split(":")[0].split(",")]
            functions[name] = names, " ".join(body.split())
        for name, body in re.findall(r"entity (\w+) is\n(.*?)end entity;", text, re.S):
            entity = entities[name] = Entity(name)
            above = text[: text.index(f"entity {name} is\n")].rsplit("end architecture;", 1)[-1]
            counted = re.search(r"-- (\d+) equations? for (\d+) unknowns?\n", above)
            if counted:
                assert counted[1] == counted[2]
                entity.stated = int(counted[1])
            _interface(entity, re.sub(r"--.*", "", body))
            architecture = re.search(rf"architecture \w+ of {name} is\n(.*?)end architecture;", text, re.S)
            _architecture(entity, re.sub(r"--.*", "", architecture[1]))
    return entities, functions


def _interface(entity, body):
    generics = re.search(r"generic \((.*?)\n  \);", body, re.S)
    for row in generics[1].split(";") if generics else []:
        names, rest = row.split(":", 1)
        default = rest.split(":=")[1].strip() if ":=" in rest else None
        entity.generics.update({name.strip(): default for name in names.split(",")})
    ports = re.search(r"port \((.*?)\n  \);", body, re.S)
    for row in ports[1].split(";") if ports else []:
        kind, names, rest = re.fullmatch(r"\s*(terminal|quantity) ([^:]+):(.*)", row, re.S).groups()
        for name in (n.strip() for n in names.split(",")):
            if kind == "terminal":
                entity.terminals[name] = rest.strip()
            elif rest.split()[0] == "in":
                entity.inputs.append(name)
            else:
                entity.outputs[name] = rest.split()[1]


def _architecture(entity, body):
    declared, statements = body.split("begin\n", 1)
    for row in (row.strip() for row in declared.split(";") if row.strip()):
        branch = re.fullmatch(r"quantity (?:(\w+) across )?(\w+) through (\w+) to \w+_ref", row)
        if branch:
            entity.branches.append(branch.groups())
            continue
        kind, names, type = re.fullmatch(r"(terminal|quantity) ([^:]+) : (\w+)", row, re.S).groups()
        into = entity.inner if kind == "terminal" else entity.quantities
        into.update({name.strip(): type for name in names.split(",")})
    for row in _rows(statements):
        part = re.fullmatch(r"(\w+) : entity work\.(\w+)(.*)", row, re.S)
        if part:
            generics, _, ports = part[3].partition("port map")
            entity.parts.append((part[1], part[2], _map(generics), _map(ports)))
        elif row.startswith("break"):
            entity.breaks.append(row)
        else:
            entity.statements.append(row)


def _rows(text):
    """Statements; an `if … use` is one."""
    rows, depth, row = [], 0, ""
    for piece in text.split(";"):
        row += piece
        depth += len(re.findall(r"\bif\b(?!.*\bend\b)", piece)) - len(re.findall(r"\bend use\b", piece))
        if depth > 0:
            row += ";"
            continue
        if row.strip():
            rows.append(row.strip())
        row = ""
    return rows


def _map(text):
    """Formals and actuals of a map in parentheses."""
    if "(" not in text:
        return {}
    out, depth, row = {}, 0, ""
    for c in text[text.index("(") + 1 : text.rindex(")")] + ",":
        depth += (c == "(") - (c == ")")
        if c == "," and depth == 0:
            formal, actual = row.split("=>")
            out[formal.strip()] = actual.strip()
            row = ""
        else:
            row += c
    return out


class Flat:
    """A system flattened: one entry an instance of an entity without parts, and the equations of structures."""

    def __init__(self, entities, functions, top, starts=None):
        self.entities, self.functions = entities, functions
        self.leaves = []
        """(path, entity, values of generics by name, actual of each port)."""
        self.equations = []
        """(path, entity, statement, actual of each name)."""
        self.nets = {}
        """Terminals: list of (instance, through) at each."""
        self._expand(top, "", dict(starts or {}), {})

    def _expand(self, name, path, generics, ports):
        entity = self.entities[name]
        constants = {**{g: v for g, v in entity.generics.items() if v is not None}, **generics}
        assert set(constants) == set(entity.generics), f"{path}: generics without a value"
        assert set(ports) == {*entity.terminals, *entity.inputs, *entity.outputs}, f"{path}: ports without an actual"
        if not entity.parts and not entity.inner:
            self.leaves.append((path, entity, constants, ports))
            return
        scope = {**ports, **{n: f"{path}{n}" for n in (*entity.inner, *entity.quantities)}}
        for label, kind, generic_map, port_map in entity.parts:
            given = {formal: constants.get(actual, actual) for formal, actual in generic_map.items()}
            actual = {formal: scope[name] for formal, name in port_map.items()}
            self._expand(kind, f"{path}{label}/", given, actual)
        for statement in entity.statements:
            self.equations.append((path, statement, scope))
