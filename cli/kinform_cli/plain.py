"""`kinform run M.toml -o F.h5` without the machinery of the command line.

Importing what reads options and builds help takes a good part of a run that reuses nearly everything, and longer than to
see that nothing changed. So the plainest form of the command is understood here; whatever else is asked for is left to
the command itself.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from kinform_cli import console
from kinform_cli.choices import FindingsFormat, Severity

__all__ = ["try_plain"]

_NAMES = {"-o": "--output", "-f": "--format", "-q": "--quiet"}
_WITH_VALUE = ("--output", "--format", "--fail-on")


def try_plain(arguments: Sequence[str]) -> int | None:
    """The exit code of the run that these arguments ask for where they are of the plainest form; else None."""
    found = _understood(arguments)
    if found is None:
        return None
    manifest, given = found
    console.settings.quiet = "--quiet" in given
    format, fail_on = FindingsFormat(given.get("--format", "full")), Severity(given.get("--fail-on", "error"))
    from kinform.api import Outcome

    outcome = Outcome.unchanged(manifest, Path(given["--output"]))
    if outcome is not None:
        from kinform_cli.gate import show_run

        return show_run(outcome, format, fail_on, manifest.parent)
    from kinform_cli.running import execute

    return execute([manifest], Path(given["--output"]), manifest=True, format=format, fail_on=fail_on, changed=True)


def _understood(arguments: Sequence[str]) -> tuple[Path, dict[str, str]] | None:
    """The manifest, and the options by their long names; None unless all of it is plain and valid."""
    words = list(arguments)
    if not words or words.pop(0) != "run":
        return None
    given: dict[str, str] = {}
    places: list[str] = []
    while words:
        word = words.pop(0)
        name = _NAMES.get(word, word)
        if name in _WITH_VALUE and words and name not in given:
            given[name] = words.pop(0)
        elif name == "--quiet":
            given[name] = ""
        elif not word.startswith("-"):
            places.append(word)
        else:
            return None
    known = given.get("--format", "full") in set(FindingsFormat) and given.get("--fail-on", "error") in set(Severity)
    if len(places) != 1 or not places[0].lower().endswith(".toml") or "--output" not in given or not known:
        return None
    return Path(places[0]), given
