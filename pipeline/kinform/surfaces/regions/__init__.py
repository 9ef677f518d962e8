"""Which polygons are one surface: candidates, growth, partition, merging."""
