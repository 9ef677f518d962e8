"""The version of kinform; nothing else."""

__version__ = "0.1.0"
