"""The kernel: equations of motion and their integration in loops over numbers, compiled or not.

The functions are plain Python over tables of numbers, which they read and write by row and column in two steps
(`table[i][j]`) and never grow: so that tables may be lists of rows, which plain functions are fastest on, or bare
memory. `compiled` gives the same functions through numba; nothing else here knows of it. See `layout` for the tables.
"""
