"""`kinform explain`: what a finding's code means, or a word that results are told in."""

from __future__ import annotations

from typing import Annotated

from kinform_cli import completion, console
from kinform_cli.options import argument, examples
from kinform_cli.text import hanging, wrapped

EXAMPLES = examples(
    "kinform explain",
    "kinform explain KF203",
    "kinform explain KF4        # all rules about function",
    "kinform explain ambiguous  # a status, an answer, a type of joint, …",
)


def explain(
    code: Annotated[
        str | None,
        argument(
            "CODE",
            "Code or name of a rule, how codes begin, or a word of results; without it all are listed.",
            autocompletion=completion.codes,
        ),
    ] = None,
) -> None:
    """Explain a finding by its code, or a word: what it means, why it matters, what to do."""
    from kinform import consistency

    if code is not None:
        console.emit(wrapped(consistency.explain(code), console.columns()))
        return
    from rich.text import Text

    from kinform.consistency.glossary import GLOSSARY
    from kinform_cli.tables import Rows, stacked

    rows = Rows("code", "rule", "severity")
    for rule in consistency.RULES:
        rows.add(rule.code, rule.name, rule.severities)
    words: dict[str, list[str]] = {}
    for word, (about, _) in GLOSSARY.items():
        words.setdefault(about, []).append(word)
    lines = [Text(hanging(f"{about}: {', '.join(told)}", console.columns())) for about, told in words.items()]
    console.out(stacked(rows, "\nWords", *lines))
