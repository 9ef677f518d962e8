"""`kinform schema`: the JSON Schema of the manifest."""

from __future__ import annotations

import json

from kinform_cli import console
from kinform_cli.options import examples

EXAMPLES = examples(
    "kinform schema > kinform.schema.json", "#:schema ./kinform.schema.json   # first line of a manifest, for editors"
)


def schema() -> None:
    """Print the JSON Schema of the manifest, for editors."""
    from kinform import form

    described = form.schema()
    console.emit(described if isinstance(described, str) else json.dumps(described, indent=2))
