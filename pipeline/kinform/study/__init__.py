"""What happens when numbers of a design vary: samples of its manifest, each a design of its own, told as one table.

`plan` is what a STUDY.toml says, `sampling` draws the samples, `work` makes one design and measures it, `session` has a
crew of workers do all of them and goes on where it stopped, `statistics` says what follows, `table` writes it. What a
sample shares with the design as it stands is taken over from there, stage by stage, as `kinform.reuse` does.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from kinform.foundation.lazy_imports import lazy_attributes

if TYPE_CHECKING:
    from kinform.study.plan import Plan, read_plan
    from kinform.study.session import Outcome, run

__all__ = ["Outcome", "Plan", "read_plan", "run"]

__getattr__ = lazy_attributes(__name__, {"Plan": "plan", "read_plan": "plan", "Outcome": "session", "run": "session"})
