"""Plain data of a YAML file for xacro: PyYAML's safe loader, with units of length and angle, and without growth.

Aliases make one object stand in many places, which whoever looks through it has to bound; merge keys (`<<`) copy, and
are bounded here.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

from kinform.formats.urdf.reading.expressions import NotAllowed

BYTES = 256 << 10
"""Of a YAML file, of which PyYAML reads some 100 kB in a second. The largest of a public robot has 30 kB."""
MERGED = 10_000
"""Keys of a mapping after merging."""
DEPTH = 100
"""Brackets inside each other, which PyYAML reads in square time."""


def load_plain(data: bytes, units: Mapping[str, float], evaluate: Callable[[str], Any]) -> Any:
    """The content; a value with the tag of one of the `units`, as in `!degrees 90`, is evaluated and multiplied."""
    import yaml

    if len(data) > BYTES:
        raise NotAllowed(f"loads a YAML file of more than {BYTES:,} bytes", "split it")

    class Loader(yaml.SafeLoader):  # type: ignore[misc]
        def fetch_flow_collection_start(self, kind: Any) -> None:
            if self.flow_level >= DEPTH:
                raise NotAllowed(f"loads YAML with more than {DEPTH} brackets inside each other", "nest it less")
            super().fetch_flow_collection_start(kind)

        def flatten_mapping(self, node: Any) -> None:
            super().flatten_mapping(node)
            if len(node.value) > MERGED:
                raise NotAllowed(f"merges more than {MERGED:,} keys of YAML into one mapping", "write fewer aliases")

    def measured(factor: float) -> Callable[[Any, Any], float]:
        def construct(loader: Any, node: Any) -> float:
            return float(evaluate(loader.construct_scalar(node))) * factor

        return construct

    for tag, factor in units.items():
        Loader.add_constructor(tag, measured(factor))
    return yaml.load(data.decode("utf-8"), Loader)
