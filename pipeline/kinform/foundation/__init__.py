"""The ground floor: what all stages share, and nothing of any stage."""

__all__ = ["CODE_VERSION"]

CODE_VERSION: int = 2
"""Changes whenever a result changes; results of other versions are computed again."""
