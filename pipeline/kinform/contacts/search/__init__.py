"""Where parts come near each other.

Whether a mate that is proposed there holds is judged here too: `narrow_phase.verify` asks facet by facet.
"""
