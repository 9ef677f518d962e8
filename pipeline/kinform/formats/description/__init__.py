"""Robot descriptions: URDF, xacro, MJCF, each a module that makes a `robot.Robot`; `tables` makes a manifest of it."""
