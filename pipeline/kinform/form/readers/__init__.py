"""From the tables of a manifest to the assembly of the model: SI, world axes, full names."""
