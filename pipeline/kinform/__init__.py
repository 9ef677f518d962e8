"""kinform: form, behaviour and function of mechanical assemblies, kept consistent."""

from kinform._version import __version__

__all__ = ["__version__"]
