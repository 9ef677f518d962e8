"""Facets: edges, shells, boxes, nearness, FCL, parity of rays."""
