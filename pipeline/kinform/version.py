"""The version of kinform; nothing else.

It follows SemVer. The interface consists of commands with their options and exit codes, JSON, the layout of results
files (HDF5), keys of manifests, codes and names of rules, and `kinform.__all__`. Major: something of it is removed or
means something else. Minor: something is added, or results of the same input change beyond tolerance. Patch: neither.
Before 1.0.0 a minor version may do what a major one may. `CONTRIBUTING.md` has the details.
"""

__version__ = "0.1.0"
