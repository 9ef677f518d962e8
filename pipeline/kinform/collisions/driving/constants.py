"""Numbers that several modules of `collisions.driving` share."""

from __future__ import annotations

from kinform.foundation.rounding import SINGLE

MEETING_MARGIN = SINGLE
"""Share of the size: facets whose swept profiles come no nearer than this never meet, but for rounding of files in
single precision."""
