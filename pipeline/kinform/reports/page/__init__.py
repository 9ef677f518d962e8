"""One self-contained page about a design, pictures of it, and a summary for pull requests.

`page_html` gives the HTML, `page_pictures` the PNG files by name, `page_summary` the Markdown that embeds them. Nothing
is written here, and nothing depends on clock, host or paths.
"""

from __future__ import annotations

from kinform.reports.page.html import page_html
from kinform.reports.page.pictures import Artist
from kinform.reports.page.pull_request import page_pictures, page_summary
from kinform.reports.page.scene import Scene

__all__ = ["Artist", "Scene", "page_html", "page_pictures", "page_summary"]
