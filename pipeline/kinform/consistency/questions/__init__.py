"""Questions about the kinematics that only rules ask: rolling elements, captive parts, motion through intermediate
bodies, near motions, mobility of sub-assemblies."""
