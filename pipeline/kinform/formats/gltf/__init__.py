"""glTF 2.0: binary (GLB) or JSON.

Sub-packages; each imports only those above it:

- `reading`: a file as a `Scene`
- `writing`: shapes and their motion as a GLB
"""
