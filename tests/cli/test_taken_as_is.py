"""Plain values of the command line: the same as typer gives, without what typer imports for it."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any

import pytest
import typer
from support.command_line import modules_after

from kinform_cli.options import Command, FailOn, Jobs, Severity

GIVEN = [
    ["one.stl"],
    ["one.stl", "two words.stl", "-o", "out.h5", "--fail-on", "note", "--word", "a", "--word", "[b]", "--jobs", "3"],
    ["", "--word", ""],
    ["one.stl", "--fail-on", "Note"],
    ["one.stl", "--jobs", "0"],
    ["one.stl", "--jobs", "many"],
    [],
]


def _taken(command_class: Any, arguments: list[str]) -> Any:
    """What a command is given, or how the usage error reads."""
    given: list[Any] = []

    def takes(
        sources: Annotated[list[Path], typer.Argument()],
        output: Annotated[Path | None, typer.Option("-o")] = None,
        word: Annotated[list[str] | None, typer.Option("--word")] = None,
        fail_on: FailOn = Severity.error,
        jobs: Jobs = None,
    ) -> None:
        given.append((sources, output, word, fail_on, jobs))

    app = typer.Typer(add_completion=False)
    app.command(cls=command_class)(takes)
    try:
        typer.main.get_command(app).main(args=arguments, prog_name="takes", standalone_mode=False)
    except Exception as error:
        return type(error), str(error)
    return given


@pytest.mark.parametrize("arguments", GIVEN, ids=" ".join)
def test_values_and_errors_are_those_of_typer(arguments: list[str]) -> None:
    assert _taken(Command, arguments) == _taken(typer.core.TyperCommand, arguments)


def test_a_typer_that_is_not_known_is_left_as_it_is(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(typer, "__version__", "0.30.0")
    for arguments in GIVEN:
        assert _taken(Command, arguments) == _taken(typer.core.TyperCommand, arguments)


def test_looking_at_results_imports_no_pydantic(tmp_path: Path) -> None:
    assert "pydantic" not in modules_after(["show", str(tmp_path / "none.h5"), "joints", "--format", "json"], 2)
