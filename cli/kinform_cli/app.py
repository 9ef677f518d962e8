"""The command line itself: which commands there are, and `--version`.

The module of a command is imported when the command is run or its help is asked: reading the options of all of them
would take longer than to see that nothing changed.
"""

from __future__ import annotations

import importlib
import keyword
from collections.abc import Iterator, Mapping
from functools import cache
from pathlib import Path
from typing import Annotated, Any

import typer

from kinform_cli import console
from kinform_cli.options import Command, Debug, Group, examples

PANELS = {
    "The whole way": ("run", "batch", "study"),
    "Stage by stage": ("import", "contacts", "joints", "mass", "simulate", "check"),
    "Look": ("show", "query", "report", "export", "catalog"),
    "Change": ("diff", "lock", "watch"),
    "Begin, and look up": ("init", "explain", "schema"),
}
"""The commands by the panels of the help where they stand.

The module `kinform_cli.commands.NAME` has either `app`, commands below this one, or a function of its own name and its
`EXAMPLES`.
"""

COMMANDS = {name: panel for panel, names in PANELS.items() for name in names}
"""The panel of each command."""


@cache
def _command(name: str) -> Any:
    """The command of this name, made from its module."""
    leaf = name + "_" if keyword.iskeyword(name) else name
    module = importlib.import_module(f"kinform_cli.commands.{leaf}")
    made = getattr(module, "app", None)
    if made is None:
        made = typer.Typer(add_completion=False)
        made.command(name, cls=Command, epilog=module.EXAMPLES)(getattr(module, leaf))
    command: Any = typer.main.get_command(made)
    command.rich_help_panel = COMMANDS[name]
    return command


class _Modules(Mapping[str, Any]):
    """All commands by name; only those that are asked for are made."""

    def __getitem__(self, name: str) -> Any:
        if name not in COMMANDS:
            raise KeyError(name)
        return _command(name)

    def __iter__(self) -> Iterator[str]:
        return iter(COMMANDS)

    def __len__(self) -> int:
        return len(COMMANDS)


class _Kinform(Group):
    """The command `kinform` itself."""

    def __init__(self, **settings: Any):
        super().__init__(**settings)
        self.commands = _Modules()  # type: ignore[assignment]

    def parse_args(self, ctx: Any, args: list[str]) -> list[str]:
        """As typer; `kinform .` and `kinform M.toml` run what they name."""
        if args and args[0] not in COMMANDS and not args[0].startswith("-") and Path(args[0]).exists():
            args = ["run", *args]
        return super().parse_args(ctx, args)

    def list_commands(self, ctx: Any) -> list[str]:
        """Their names, in the order of the help."""
        return list(COMMANDS)


app = typer.Typer(name="kinform", cls=_Kinform, context_settings={"help_option_names": ["--help", "-h"]})


def _print_version(wanted: bool) -> None:
    if wanted:
        from kinform.version import __version__

        console.emit(f"kinform {__version__}")
        raise typer.Exit


@app.callback(
    epilog=examples(
        "kinform init *.stl --units mm -o arm.toml   # a manifest to start from",
        "kinform run arm.toml -o arm.h5              # everything; exit code 0, 1 or 2",
        "kinform show arm.h5                         # what was derived",
    )
)
def _root(
    version: Annotated[
        bool, typer.Option("--version", callback=_print_version, is_eager=True, help="Print the version.")
    ] = False,
    debug: Debug = False,
) -> None:
    """Derive joints, mobility, mass and motion from meshes, and check them against the intended
    function.

    Exit codes: 0 written, or verified. 1 findings (check, run), differences (diff). 2 not written, or not verified.
    """
