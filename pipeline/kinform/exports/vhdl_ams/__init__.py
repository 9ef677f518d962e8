"""VHDL-AMS: `writer.export` fills the templates with the structure of the system (`structure`) and its drives."""
