"""The kernel: equations of motion and their integration in loops over numbers, compiled or not.

The functions are plain Python over tables of numbers. `compiled` gives the same functions through numba;
nothing else here knows of it. See `layout` for the tables.
"""
