"""Facets: edges, shells, boxes, nearness, FCL, what few triangles meet, parity of rays."""
