"""Two parts on a course: how far they are apart, whether they cross, how deep, and where they first do."""
