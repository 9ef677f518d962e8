"""The targets under atheris (libFuzzer): inputs are chosen by the coverage of our readers.

One target a process: libFuzzer never returns. It stops at the first finding, whose input it writes beside the corpus;
exceptions are told with their traceback.
"""

from __future__ import annotations

import contextlib
import sys
import time
from pathlib import Path

import counts

KEPT = 500
"""Files of a corpus that are kept, the smallest."""
NOTED = 10_000
"""Executions that are counted at once."""


def run(name: str, folder: Path, *, runs: int | None, seconds: float | None, seed: int) -> None:
    """Fuzz a target; does not return."""
    import atheris

    with atheris.instrument_imports(include=["kinform", "tomllib", "json"]):
        import kinform.catalog
        import kinform.changes
        import kinform.consistency
        import kinform.form.meshes.bodies
        import kinform.form.meshes.health
        import kinform.form.meshes.obj
        import kinform.form.meshes.stl
        import kinform.form.readers.assembly
        import kinform.results  # noqa: F401
    from targets import REFUSED, TARGETS

    target = TARGETS[name]
    corpus = folder / "corpus"
    corpus.mkdir(parents=True, exist_ok=True)
    for path in sorted(corpus.iterdir(), key=lambda p: (p.stat().st_size, p.name))[KEPT:]:
        path.unlink()
    given = folder / "seeds"
    given.mkdir(exist_ok=True)
    for number, data in enumerate(target.seeds()):
        (given / f"{number:03d}").write_bytes(data)
    words = folder / "words"
    quoted = ("".join(f"\\x{byte:02x}" for byte in word) for word in target.words)
    words.write_text("".join(f'"{word}"\n' for word in quoted))

    done, since = 0, time.process_time()

    def once(data: bytes) -> None:
        nonlocal done, since
        with contextlib.suppress(REFUSED):
            target.run(data)
        done += 1
        if done % NOTED == 0:  # libFuzzer ends the process itself
            now = time.process_time()
            counts.add(
                folder.parent, name, "atheris", executions=NOTED, refused=None, seconds=now - since, findings=0
            )  # fmt: skip
            since = now

    options = [
        f"-seed={seed + 1}",
        "-timeout=20",
        "-rss_limit_mb=4000",
        "-max_len=20000",
        f"-artifact_prefix={folder}/",
    ]
    if target.words:
        options.append(f"-dict={words}")
    if runs is not None:
        options.append(f"-runs={runs}")
    if seconds is not None:
        options.append(f"-max_total_time={int(seconds)}")
    atheris.Setup([sys.argv[0], *options, str(corpus), str(given)], once)
    atheris.Fuzz()
