"""Facets, edges and coplanar polygons of a mesh."""
