"""`/assembly/check`: how the rules are to be applied."""

from __future__ import annotations

from kinform.model.checks import CheckSettings
from kinform.results.layout import Layout, Row, Table, Texts

CHECK = Layout(
    CheckSettings, Row("header", "file", "line", "profile"), Texts("select"), Table("severity"), Table("ignore")
)
