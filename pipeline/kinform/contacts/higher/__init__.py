"""Points and lines of contact, where parts share no surface."""
