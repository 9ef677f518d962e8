"""`kinform explain`: what a finding's code means."""

from __future__ import annotations

from typing import Annotated

from kinform_cli import completion, console
from kinform_cli.options import argument, examples
from kinform_cli.text import wrapped

EXAMPLES = examples("kinform explain", "kinform explain KF203", "kinform explain KF4        # all rules about function")


def explain(
    code: Annotated[
        str | None,
        argument(
            "CODE",
            "Code or name of a rule, or how codes begin; without it all are listed.",
            autocompletion=completion.codes,
        ),
    ] = None,
) -> None:
    """Explain a finding by its code: what it means, why it matters, what to do."""
    from kinform import consistency

    if code is not None:
        console.emit(wrapped(consistency.explain(code), console.columns()))
        return
    from kinform_cli.tables import Rows

    rows = Rows("code", "rule", "severity")
    for rule in consistency.RULES:
        rows.add(rule.code, rule.name, rule.severity)
    console.out(rows)
