"""The ground floor: what all stages share, and nothing of any stage.

Sub-packages; each imports only those above it:

- `algebra`: vectors, rotations, displacements, screws, splines
- `graphs`: components, blocks and cycles, without physics
- `meshes`: edges, shells, boxes, nearness, probes, FCL
"""

__all__ = ["CODE_VERSION"]

CODE_VERSION: int = 2
"""Changes whenever a result changes; results of other versions are computed again."""
