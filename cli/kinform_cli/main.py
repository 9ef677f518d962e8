"""The entry of the command: whatever happens, it ends with the exit code that is due.

Imports nothing but the standard library before it is ready to catch what goes wrong: a broken
installation must not end with 1, which would read as findings.
"""

from __future__ import annotations

import faulthandler
import gc
import os
import sys
import traceback
from collections.abc import Sequence
from typing import NoReturn


def main(arguments: Sequence[str]) -> int:
    """Run the command with these arguments; returns its exit code."""
    from kinform_cli import console, errors

    # small matrices: threads of BLAS cost more than they give, and `--jobs` shares the work between processes
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
    # to look for plugins of pydantic among all packages that are installed takes longer than to read a manifest
    os.environ.setdefault("PYDANTIC_DISABLE_PLUGINS", "1")
    console.settings.quiet, console.settings.cut = False, None
    console.settings.debug = bool(os.environ.get("KINFORM_DEBUG"))
    try:
        import typer

        from kinform_cli.app import app

        command = typer.main.get_command(app)
        code = command.main(args=list(arguments) or ["--help"], prog_name="kinform", standalone_mode=False)
        console.flush()
        code = errors.from_typer(code) if arguments else errors.NOT_VERIFIED
    except SystemExit as stop:  # completion; and typer's help when its reader left
        code = errors.OK if not stop.code and not isinstance(stop.__context__, OSError) else errors.NOT_VERIFIED
    except (Exception, KeyboardInterrupt) as error:
        return errors.report(error)
    return errors.of_output(code)


def entry() -> NoReturn:
    """The console script."""
    code = 2  # as `errors.NOT_VERIFIED`, which may be what cannot be imported
    try:
        from kinform_cli import working_folder

        working_folder.forget()
        from kinform_cli import console, interrupts, supervision

        supervision.divide()
        interrupts.listen()
        from kinform.foundation import current_work

        current_work.board = supervision.board
        if os.environ.get("KINFORM_DEBUG"):
            faulthandler.enable()
        # nearly all that is made stays until the end: looking for garbage often finds none
        gc.set_threshold(500_000, 20, 20)
        console.tolerate_any_character()
        console.write_whole()
        code = main(sys.argv[1:])
        console.give_up()
    except BaseException:  # not even an error could be reported; or Ctrl-C again while it was
        _last_words()
    # all files are closed and all streams flushed: to take a large design apart object by object would only cost time
    os._exit(code)


def _last_words() -> None:
    try:
        if isinstance(sys.exc_info()[1], KeyboardInterrupt):
            sys.stderr.write("kinform: error: interrupted\n")
        else:
            traceback.print_exc()
        sys.stderr.flush()
    except BaseException:  # there is nobody to tell
        os._exit(2)
