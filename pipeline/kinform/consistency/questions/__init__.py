"""Questions about the kinematics that only rules ask: rolling elements, captive parts, motion through intermediate
bodies, near motions, stated joints that do not move, mobility of sub-assemblies."""
