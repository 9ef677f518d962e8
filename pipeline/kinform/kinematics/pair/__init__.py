"""The joint of a pair of bodies, from the contact between them."""
