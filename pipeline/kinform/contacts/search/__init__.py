"""Where parts come near each other."""
