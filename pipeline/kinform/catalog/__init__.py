"""A catalog of designs: one SQLite file of what designs do, made from their results files.

It holds nothing that the results files do not say, and can be rebuilt from them at any time.
"""

from kinform.catalog.build import Refused, add, fill, rebuild
from kinform.catalog.entry import CatalogJoint, CatalogRequirement, Entry, entry_of
from kinform.catalog.search import Wanted, distance, find, joint_count, like, source_state
from kinform.catalog.store import SCHEMA, Catalog, is_recorded, read, write

__all__ = [
    "SCHEMA",
    "Catalog",
    "CatalogJoint",
    "CatalogRequirement",
    "Entry",
    "Refused",
    "Wanted",
    "add",
    "distance",
    "entry_of",
    "fill",
    "find",
    "is_recorded",
    "joint_count",
    "like",
    "read",
    "rebuild",
    "source_state",
    "write",
]
