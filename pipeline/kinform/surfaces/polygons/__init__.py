"""Facets, edges, noise, and the coplanar polygons that surfaces are recovered over."""
