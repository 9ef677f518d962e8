"""One version: of the package, of what is cited, and of what has changed; and the files that go with it."""

from __future__ import annotations

import re
import tomllib

import pytest
from support.places import ROOT

from kinform import __version__

PAGES = ("README.md", "CONTRIBUTING.md", "CHANGELOG.md", "SECURITY.md", "CITATION.cff", "LICENSE")


def test_the_version_is_one_of_semver():
    assert re.fullmatch(r"\d+\.\d+\.\d+(-[0-9A-Za-z.-]+)?", __version__)


def test_the_citation_has_the_version_and_the_date_of_the_changelog():
    cited = dict(re.findall(r"^([\w-]+): (.+)$", (ROOT / "CITATION.cff").read_text(encoding="utf-8"), re.MULTILINE))
    assert cited["version"] == __version__
    versions = re.findall(
        r"^## \[(.+?)\](?: - (\S+))?$", (ROOT / "CHANGELOG.md").read_text(encoding="utf-8"), re.MULTILINE
    )
    assert versions[:2] == [("Unreleased", ""), (__version__, cited["date-released"])]


@pytest.mark.parametrize("page", PAGES)
def test_the_source_distribution_has_every_page(page: str):
    hatch = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["tool"]["hatch"]
    assert f"/{page}" in hatch["build"]["targets"]["sdist"]["include"]
    assert (ROOT / page).is_file()
