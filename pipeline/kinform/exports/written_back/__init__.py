"""Numbers written into the XML of a description, a module for each format."""
