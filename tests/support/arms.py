"""Arms from outside the repository, whose joints several files of tests ask for."""

from __future__ import annotations

import shutil
from pathlib import Path
from typing import Any

from kinform import stages
from kinform.design import Design
from support.once import common, once


def joints_of_arm(tmp_path_factory: Any, manifest: Path) -> Design:
    """The design of a manifest up to its joints, from a copy of its folder, computed once a session."""

    def made() -> Design:
        folder = tmp_path_factory.mktemp("arm") / manifest.parent.name
        shutil.copytree(manifest.parent, folder)
        return stages.joints(stages.contacts(stages.import_(folder / manifest.name), jobs=2))

    return once(common(tmp_path_factory), f"joints of {manifest}", made)
