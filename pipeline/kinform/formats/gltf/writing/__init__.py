"""Writer of GLB: `writer.export` writes shapes with their motion."""
