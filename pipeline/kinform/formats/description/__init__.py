"""What formats of robot descriptions share.

Every reader makes a `robot.Robot`; `elements`, `poses`, `inertials`, `tree` and `mesh_files` help readers of XML.
`tables` makes the tables of a manifest of a robot. `facts` and `coverage` are what rules ask about a description
besides.

Sub-packages; each imports only those above it:

- `writing`: what writers share, and descriptions written back
"""
