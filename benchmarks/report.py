"""Size of a page, time to make it, and time until a headless Chromium shows its view.

usage: report.py F.h5 [F.h5 …]
"""

from __future__ import annotations

import sys
import tempfile
import time
from pathlib import Path

from kinform import results
from kinform.reports.page import page_html

sys.path.insert(0, str(Path(__file__).resolve().parent.parent / "tests"))


def opened(text: str) -> float:
    """Seconds from asking for the page until its first picture is drawn; nan without a browser."""
    from support.browser import Browser, program

    if program() is None:
        return float("nan")
    browser = Browser()
    try:
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / "page.html"
            path.write_text(text, encoding="utf-8")
            browser.open(path)
        if browser.run("document.body.dataset.viewer") != "ready":
            return float("nan")
        return float(str(browser.run("performance.getEntriesByName('viewer ready')[0].startTime"))) / 1e3
    finally:
        browser.close()


def main(paths: list[str]) -> None:
    """One row a file."""
    print(f"{'file':<28}{'facets':>10}{'MB':>8}{'made s':>9}{'open s':>9}")
    for name in paths:
        design = results.read(Path(name))
        start = time.perf_counter()
        text = page_html(design)
        made = time.perf_counter() - start
        facets = sum(len(p.mesh.faces) for p in design.assembly.parts if p.mesh is not None)
        print(f"{Path(name).name:<28}{facets:>10}{len(text.encode()) / 1e6:>8.2f}{made:>9.1f}{opened(text):>9.2f}")


if __name__ == "__main__":
    main(sys.argv[1:])
