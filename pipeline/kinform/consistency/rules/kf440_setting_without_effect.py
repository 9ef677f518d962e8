"""An entry of `[check]` in the manifest has no effect.

An ignore that ignores nothing, or a severity or a selection of a rule that does not exist.

Why it matters: an ignore that outlives its finding hides the next one that looks like it. A misspelt code does
not do what was meant.

What to do: remove the entry, or correct the code or the subject. `docs/rules.md` lists all rules.

Example: `[[check.ignore]]` with `code = "KF303"` after the redundant hinge has been removed.
"""

from __future__ import annotations

from kinform.consistency.context import Context
from kinform.consistency.outcome import Outcome, decided, skipped
from kinform.consistency.rule import Rule
from kinform.foundation.words import counted
from kinform.model.assembly import Source


def check(context: Context) -> Outcome:
    """Entries that changed nothing."""
    settings = context.assembly.check
    entries = len(settings.select) + len(settings.severity) + len(settings.ignore)
    if context.unused_settings is None or not entries:
        return skipped("the manifest has no [check]")
    whole = Source(settings.file or context.assembly.source.file, settings.line)
    findings = [
        RULE.finding(
            [item.name] if item.ignore is None or item.ignore.subject is None else [item.name, item.ignore.subject],
            item.message,
            found="no effect",
            intended="an entry that changes something",
            declared=item.ignore or whole,
            remedy="Remove the entry, or correct its code or subject.",
        )
        for item in context.unused_settings
    ]
    return decided(findings, f"{counted(entries, 'entry', 'entries')} of [check]")


RULE = Rule("KF440", "setting-without-effect", "warning", __doc__, check)
