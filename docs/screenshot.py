"""Takes the picture at the head of the README again, with Chromium: `python docs/screenshot.py`."""

from __future__ import annotations

import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
sys.path.insert(0, str(ROOT / "tests"))

DESIGN = ROOT / "fixtures" / "broken" / "seeker_gimbal_overlaps" / "seeker_gimbal_overlaps.toml"
WIDTH, HEIGHT = 1280, 720


def main() -> None:
    """The first screen of the page of a design with an overlap, its finding chosen."""
    from support.browser import Browser

    import kinform
    from kinform.reports.page import page_html

    with tempfile.TemporaryDirectory() as folder:
        page = Path(folder) / "page.html"
        page.write_text(page_html(kinform.run(DESIGN).design), encoding="utf-8")
        browser = Browser(WIDTH, HEIGHT)
        try:
            browser.open(page)
            browser.run("document.querySelector('button[data-finding]').click()")
            browser.run("document.querySelector('.finding .more').open = true")
            browser.settle()
            browser.picture(ROOT / "docs" / "page.png")
        finally:
            browser.close()


if __name__ == "__main__":
    main()
