"""CAD and scene files: meshes with names, poses and hierarchy."""
