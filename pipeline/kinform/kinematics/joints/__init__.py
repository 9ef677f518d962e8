"""Joints between bodies, from the contacts between their parts.

Sub-packages; each imports only those above it:

- `pair`: the joint of two bodies, from the contact between them
- `bodies`: which parts are one body, and which bodies have a joint
- `axes`: axes made consistent across the assembly
"""
