"""Which polygons belong to which surface."""
