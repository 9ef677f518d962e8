"""Modelica: `writer.export` fills the template `package.mo.j2`."""
