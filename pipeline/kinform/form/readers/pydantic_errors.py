"""Pydantic's complaints about a manifest, in the user's words, each at the line of its key."""

from __future__ import annotations

import functools
from collections.abc import Callable, Iterable, Iterator, Sequence
from itertools import islice
from typing import Any

from pydantic import ValidationError

from kinform.form.constants import LARGEST_NUMBER, PROBLEMS_MOST, VALUE_LENGTH
from kinform.form.manifest import json_schema
from kinform.form.problems import Problems
from kinform.form.readers.places import Lines
from kinform.form.readers.toml_lines import Path
from kinform.foundation.name_hints import did_you_mean, first_names, in_quotes

_UNITS = 'lengths have no default unit: write units = "mm" (or m, cm, um, in, ft)'


def report(error: ValidationError, raw: dict[str, Any], lines: Lines, file: str, problems: Problems) -> None:
    """Add each of pydantic's errors to the problems."""
    schema = _schema()
    for item in islice(_one_a_union(error.errors(include_url=False), raw), PROBLEMS_MOST + 1):
        path = _real_path(item["loc"], raw)
        tagged = item["type"].startswith("union_tag")
        where = _label(path if item["type"] == "missing" or tagged else path[:-1], raw)
        key = (*path, item["ctx"]["discriminator"].strip("'")) if tagged else path
        node = _node(schema, item["loc"])
        owner = _node(schema, item["loc"][:-1])
        message, remedy = _words(item, path, where, node, owner)
        problems.add(message, lines.file(key) or file, lines.line(key), remedy)


def _one_a_union(errors: Sequence[Any], raw: dict[str, Any]) -> Iterator[Any]:
    """The errors, those of several types that a key may have as one: the deepest, else that it is none of them."""
    members: dict[Path, list[Any]] = {}
    for item in errors:
        members.setdefault(_union_of(item["loc"], raw), []).append(item)
    for union, items in members.items():
        if len({item["loc"][len(union) : len(union) + 1] for item in items}) < 2 or not union:
            yield from items
            continue
        deepest = max(len(_real_path(item["loc"], raw)) for item in items)
        if deepest > len(union):
            yield from (item for item in items if len(_real_path(item["loc"], raw)) == deepest)
        else:
            yield items[0] | {"type": "no_member", "loc": union}


def _union_of(loc: tuple[str | int, ...], raw: Any) -> Path:
    """The key whose value may have several types, one of which the location names; () where it names none."""
    value: Any = raw
    for i, step in enumerate(loc):
        if not _has(value, step):
            return () if isinstance(value, dict) else tuple(loc[:i])
        value = value[step]
    return ()


@functools.cache
def _schema() -> dict[str, Any]:
    """The JSON Schema of the manifest, which takes a tenth of a second to make."""
    return json_schema()


def _words(item: Any, path: Path, where: str, node: dict[str, Any], owner: dict[str, Any]) -> tuple[str, str]:
    """Message and remedy of an error at a path in the table `where`; `node` and `owner` are what the schema says of
    the key and of its table."""
    kind, context = item["type"], item.get("ctx", {})
    key = str(item["loc"][-1]) if item["loc"] else ""
    expected = node.get("description", "")
    if kind == "missing":
        remedy = _UNITS if key == "units" else f"add {key}: {expected}" if expected else f"add {key}"
        if key == "schema":
            remedy = "write schema = 1 as the first line"
        return f"{where}: {key} is missing", remedy
    if kind == "extra_forbidden":
        return f"{where}: unknown key {in_quotes(key)}", did_you_mean(key, owner.get("properties", {}), "the keys here")
    name = _shown_key(path)
    if kind in ("union_tag_not_found", "union_tag_invalid"):
        tag = context["discriminator"].strip("'")
        if kind == "union_tag_not_found":
            return (
                f"{where}: {tag} is missing",
                f"add {tag}: {first_names(sorted(node.get('discriminator', {}).get('mapping', {})))}",
            )
        choices = [c.strip("'") for c in context["expected_tags"].split(", ")]
        remedy = did_you_mean(str(context["tag"]), choices, f"the values of {tag}")
        return f"{where}: {tag} cannot be {in_quotes(context['tag'])}", remedy
    if kind == "no_member":
        return f"{where}: {name} cannot be {_value(item['input'])}", f"{name} is: {expected}"
    if kind == "literal_error":
        choices = node.get("enum") or [node.get("const", "")]
        remedy = did_you_mean(str(item["input"]), [str(c) for c in choices], "the choices")
        return f"{where}: {name} cannot be {_value(item['input'])}", remedy
    if kind == "string_pattern_mismatch":
        if "/" not in context.get("pattern", ""):
            return f"{where}: {name} {_value(item['input'])} contains a null character", "take another name"
        return (
            f'{where}: {name} {_value(item["input"])} contains "/" or a null character',
            'take another name: "/" separates sub-assemblies',
        )
    if kind == "string_too_long":
        most = context["max_length"]
        return f"{where}: {name} has {len(item['input'])} characters, and {most} are the most", f"shorten {name}"
    if key == "schema":
        return f"schema {_value(item['input'])} is not one that this version reads", "write schema = 1"
    wrong = item["msg"].replace("Input should be", "must be").replace(" after validation", "")
    wrong = wrong.replace("a valid list", "a list in brackets").replace(f"{LARGEST_NUMBER:.0f}", f"{LARGEST_NUMBER:g}")
    message = f"{where}: {name} {wrong[:1].lower()}{wrong[1:]}, not {_value(item['input'])}"
    if kind in ("too_short", "too_long"):
        bound = context.get("min_length", context.get("max_length"))
        exact = node.get("minItems") == node.get("maxItems")
        need = f"{bound}" if exact else f"at {'least' if kind == 'too_short' else 'most'} {bound}"
        message = f"{where}: {name} has {context['actual_length']} entries and needs {need}"
    return message, f"{name} is: {expected}" if expected else f"correct {name}"


def without_errors(error: ValidationError, raw: dict[str, Any]) -> tuple[dict[str, Any], set[Path]]:
    """The raw manifest less what pydantic refused, so that the rest can be checked as well; and what was refused.

    An unknown key goes alone; another error takes its table (`[[part]]`, a material, a joint) with it.
    """
    drop: set[Path] = set()
    for item in error.errors(include_url=False):
        path = _real_path(item["loc"], raw)
        drop.add(path if item["type"] == "extra_forbidden" else _unit_of(path))
    kept: dict[str, Any] = _pruned(raw, (), drop)
    kept.setdefault("schema", 1)
    assembly = kept.setdefault("assembly", {})
    if isinstance(assembly, dict):
        assembly.setdefault("name", "?")
        assembly.setdefault("units", "m")
    return kept, drop


def names_of(paths: Iterable[Path], raw: Any) -> Iterator[str]:
    """The names of those of the tables that have one."""
    for path in paths:
        value = raw
        for step in path:
            value = _entry(value, step)
        if isinstance(value, dict) and isinstance(value.get("name"), str):
            yield value["name"]


def _unit_of(path: Path) -> Path:
    """The table that an error invalidates: down to the first list index or the second key."""
    for i, step in enumerate(path):
        if isinstance(step, int):
            return path[: i + 1]
    return path[:2]


def _pruned(value: Any, path: Path, drop: set[Path]) -> Any:
    if isinstance(value, dict):
        return {k: _pruned(v, (*path, k), drop) for k, v in value.items() if (*path, k) not in drop}
    if isinstance(value, list):
        return [_pruned(v, (*path, i), drop) for i, v in enumerate(value) if (*path, i) not in drop]
    return value


def _real_path(loc: tuple[str | int, ...], raw: Any) -> Path:
    """Pydantic's location without the tags of unions, which are not keys of the file."""
    path: list[str | int] = []
    value: Any = raw
    for i, step in enumerate(loc):
        if _has(value, step):
            value = value[step]
            path.append(step)
        elif i == len(loc) - 1:
            break
    return tuple(path)


def _label(path: Path, raw: Any) -> str:
    """The table around a key as the file shows it: `[assembly]`, `[[part]] "base"`."""
    keys: list[str] = []
    name, value, listed_table = "", raw, False
    for step in path:
        value = _entry(value, step)
        if isinstance(step, str):
            keys.append(step)
            listed_table = False
        elif isinstance(value, dict):
            listed_table = True
        if isinstance(value, dict) and isinstance(value.get("name"), str):
            name = value["name"]
    if not keys:
        return "the manifest"
    label = f"[[{'.'.join(keys)}]]" if listed_table else f"[{'.'.join(keys)}]"
    return f"{label} {in_quotes(name)}" if name and keys[0] != "assembly" else label


def _entry(value: Any, step: str | int) -> Any:
    return value[step] if _has(value, step) else None


def _has(value: Any, step: str | int) -> bool:
    if isinstance(value, dict):
        return step in value
    return isinstance(value, list) and isinstance(step, int) and step < len(value)


def _shown_key(path: Path) -> str:
    text = ""
    for step in reversed(path):
        text = f"[{step + 1}]{text}" if isinstance(step, int) else f"{step}{text}"
        if isinstance(step, str):
            break
    return text or "the manifest"


def _value(value: Any) -> str:
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, str):
        return in_quotes(value)
    if isinstance(value, dict):
        return "a table"
    if isinstance(value, int) and abs(value) >= 10**VALUE_LENGTH:
        return "a number of very many digits"
    return str(value) if len(str(value)) <= VALUE_LENGTH else f"{str(value)[: VALUE_LENGTH - 3]}…"


def _node(schema: dict[str, Any], loc: tuple[str | int, ...]) -> dict[str, Any]:
    """The part of the JSON Schema that a location stands for; {} where there is none."""
    node = schema
    for step in loc:
        node = _below(_resolved(node, schema), step)
        if not node:
            return {}
    return _resolved(node, schema)


def _below(node: dict[str, Any], step: str | int) -> dict[str, Any]:
    tags = node.get("discriminator", {}).get("mapping", {})
    if step in tags:
        return {"$ref": tags[step]}
    if isinstance(step, int):
        items: dict[str, Any] = node.get("items", {})
        return {"description": node["description"], **items} if "description" in node else items
    for source in (node.get("properties", {}).get(step), node.get("additionalProperties")):
        if isinstance(source, dict):
            return source
    return {}


def _resolved(node: dict[str, Any], schema: dict[str, Any]) -> dict[str, Any]:
    """The node without $ref and without the null alternative of an optional key."""
    follow: Callable[[dict[str, Any]], dict[str, Any]] = lambda n: schema["$defs"][n["$ref"].rpartition("/")[2]]
    direct = {k: v for k, v in node.items() if k not in ("anyOf", "$ref")}
    if "$ref" in node:
        return {**_resolved(follow(node), schema), **direct}
    options = [o for o in node.get("anyOf", []) if o.get("type") != "null"]
    if len(options) == 1:
        return {**_resolved(options[0], schema), **direct}
    return node
