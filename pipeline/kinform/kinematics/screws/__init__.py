"""Spaces of screws: one basis for each, and words for it.

`canonical_basis` gives a space of twists the same basis however it was computed; `wording` names the motions of a space
of twists, and the forces and moments of a space of wrenches. Neither knows bodies or contact.
"""
