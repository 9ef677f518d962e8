"""The first crossings of many pairs along a run, the earliest of them: where thousands of pairs run into each other, as
they do when a whole mechanism goes where it should not, those that come later say nothing more."""

from __future__ import annotations

from bisect import insort
from collections.abc import Sequence

from kinform.collisions.pair.advancement import First, first_crossing
from kinform.collisions.pair.posed_pairs import Moving
from kinform.foundation.progress import Progress


class FirstCrossings:
    """What pairs meet until `end` (s), which draws near as more of them do."""

    def __init__(self, pairs: Sequence[Moving], end: float, fine: float, progress: Progress | None = None) -> None:
        """Crossings are found to within `fine` (s)."""
        self._pairs, self._last, self._fine, self._progress = pairs, end, fine, progress
        self._order = sorted(range(len(pairs)), key=lambda k: (pairs[k].free, k))
        self._known: dict[int, First] = {}
        """What was found of a pair that was followed until it crossed, or to the end of the run."""
        self._given: set[int] = set()
        self.end = end

    @property
    def left_out(self) -> list[int]:
        """The pairs that were not followed until they cross, or to the end of the run."""
        return [k for k in range(len(self._pairs)) if k not in self._given]

    def up_to(self, most: int) -> list[tuple[int, First]]:
        """What pairs meet, by their places, that was not given before: all up to the time by when so many have
        crossed."""
        hits = sorted(first.hit for first in self._known.values() if first.hit is not None)
        self.end = hits[most - 1] if len(hits) >= most else self._last
        for done, k in enumerate(self._order):
            if self._progress is not None:
                self._progress(done, len(self._order))
            pair, end = self._pairs[k], self.end
            if k in self._known or pair.free > end:
                continue
            first = first_crossing(pair.test, pair.course, end, self._fine, start=pair.free)
            if first.hit is not None:
                insort(hits, first.hit)
                self.end = hits[most - 1] if len(hits) >= most else end
            if first.hit is not None or end >= self._last:
                self._known[k] = first
        fresh = [k for k in sorted(self._known.keys() - self._given) if (self._known[k].hit or 0.0) <= self.end]
        self._given |= set(fresh)
        return [(k, self._known[k]) for k in fresh]
