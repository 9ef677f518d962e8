"""Groups of the results file, one a module."""
