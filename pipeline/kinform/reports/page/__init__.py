"""One self-contained page about a design, pictures of it, and a summary for pull requests.

`page` gives the HTML, `pictures` the PNG files by name, `summary` the Markdown that embeds them. Nothing is
written here, and nothing depends on clock, host or paths.
"""

from __future__ import annotations

from kinform.reports.page.render import page
from kinform.reports.page.scene import Scene
from kinform.reports.page.summary import pictures, summary

__all__ = ["Scene", "page", "pictures", "summary"]
