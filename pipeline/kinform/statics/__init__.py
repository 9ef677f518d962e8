"""Forces in contacts: what pushing alone can carry, and where reactions would pull contacts apart."""

__all__ = ["CODE_VERSION"]

CODE_VERSION: int = 5
"""Changes whenever a result changes; results of other versions are computed again."""
