"""The kinematic graph as a drawing."""
