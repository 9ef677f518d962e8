"""Robot descriptions: URDF, MJCF, SDF, each a module that makes a `robot.Robot`; `tables` makes a manifest of it."""
