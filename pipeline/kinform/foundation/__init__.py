"""What all stages share, and nothing of any stage.

Sub-packages; each imports only those above it:

- `algebra`: vectors, rotations, displacements, screws, splines
- `graphs`: components, blocks and cycles, without physics
- `meshes`: edges, shells, boxes, nearest and facing facets, probes, FCL

Beside them: `rounding` (four levels), `constants`, `sorting`, `equal_rows`, `concatenation` for arrays; `processes`,
`current_work`, `parent_death`, `interpreters`, `git`, `memory`, `lockstep` for how work is run; `confined` for code
that is not trusted, `no_more_files` for native code; `boundary`, `user_folders`, `provenance`, `texts`, `escapes`,
`regular_files`, `xml_root`, `name_hints`, `words`, `units` for files and messages.
"""

__all__ = ["CODE_VERSION"]

CODE_VERSION: int = 3
"""Changes whenever a result changes; results of other versions are computed again."""
