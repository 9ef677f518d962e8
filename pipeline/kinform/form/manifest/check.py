"""`[check]`: which rules run, how severe their findings are, and what is ignored."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field, StringConstraints

from kinform.form.tables import Reference, Table


class IgnoreTable(Table):
    """`[[check.ignore]]`: findings that are accepted."""

    code: Reference = Field(description="code or name of a rule, such as KF303")
    subject: Reference | None = Field(
        None, description="part, joint or requirement that the finding is about; default all of the rule"
    )
    reason: Annotated[str, StringConstraints(min_length=1, strip_whitespace=True)] = Field(
        description="why it is accepted"
    )


class CheckTable(Table):
    """`[check]`: how the rules are applied."""

    select: list[Reference] = Field(
        [], description="rules to run: codes, names, or beginnings such as KF2; default all"
    )
    severity: dict[str, Literal["note", "warning", "error"]] = Field(
        {}, description="severity of the findings of a rule, by its code or name"
    )
    profile: Literal["design", "description"] | None = Field(
        None, description="which severities findings have; default description where a robot description is read"
    )
    ignore: list[IgnoreTable] = Field([], description="findings that are accepted, each with a reason")
