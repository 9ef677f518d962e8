"""MJCF, the model format of MuJoCo.

Sub-packages; each imports only those above it:

- `reading`: a file as a `Robot`
- `writing`: an export model as a file; edits of a file that was read
"""
