"""`kinform show`: what is in a results file."""

from __future__ import annotations

from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from kinform_cli import completion, console, files
from kinform_cli.designs import looked_at
from kinform_cli.errors import refuse
from kinform_cli.options import LookedAt, PrintedTable, TableFormat, argument, examples, option

if TYPE_CHECKING:
    from kinform.design import Design


EXAMPLES = examples(
    "kinform show arm.h5",
    "kinform show arm.h5 joints",
    "kinform show arm.h5 joints --format json | jq '.joints[].type'",
    "kinform show arm.h5 joints --joint base~shoulder",
    "COLUMNS=200 kinform show arm.h5 contacts | grep shoulder    # wider than 80",
    "kinform show arm.h5 mobility --graph arm.svg",
)


class Topic(StrEnum):
    """What can be shown."""

    assembly = "assembly"
    contacts = "contacts"
    joints = "joints"
    bodies = "bodies"
    mobility = "mobility"
    mass = "mass"
    behaviour = "behaviour"
    simulation = "simulation"
    findings = "findings"


def show(
    source: LookedAt,
    topic: Annotated[
        Topic | None,
        argument("TOPIC", f"What to show: {', '.join(Topic)}; without it an overview.", show_choices=False),
    ] = None,
    format: PrintedTable = TableFormat.table,
    joint: Annotated[
        str | None,
        option(
            "--joint",
            "NAME",
            "All the evidence of this joint, by its name here or in the function, and what would make it another.",
            autocompletion=completion.joints,
        ),
    ] = None,
    graph: Annotated[
        Path | None,
        option(
            "--graph", "FILE", "Draw bodies, joints and loops instead, for mobility or joints: FILE.svg or FILE.dot."
        ),
    ] = None,
) -> None:
    """Show what a results file holds: tables for people, or JSON."""
    if joint is not None and topic not in (None, Topic.joints):
        raise typer.BadParameter("goes with joints, as in: kinform show F.h5 joints --joint NAME", param_hint="--joint")
    if graph is not None:
        _draw(source, topic, graph)
        return
    design = looked_at(source, at_need=True)
    from kinform import reports
    from kinform_cli.views import topics

    if joint is not None:
        _print_joint(design, joint, source, format)
        return

    name = None if topic is None else topic.value
    with files.needing(source):
        if format is TableFormat.json:
            console.emit(reports.summary_json(design, name))
        else:
            console.out(topics.render(design, name, source))


def _print_joint(design: Design, joint: str, source: Path, format: TableFormat) -> None:
    """The evidence of one joint."""
    from kinform import reports
    from kinform_cli.views import topics

    try:
        with files.needing(source):
            joint = _derived(design, joint, source)
            if format is TableFormat.json:
                console.emit(reports.joint_json(design, joint))
            else:
                console.out(topics.render_joint(design, joint))
    except KeyError as error:
        raise refuse(str(error.args[0]), file=source) from None


def _derived(design: Design, name: str, source: Path) -> str:
    """The name of the derived joint that the function, or kinform, calls so. An error where there is none."""
    if design.kinematics is None:
        return name
    from kinform.foundation.name_hints import did_you_mean
    from kinform.function import resolve_joint

    found = resolve_joint(design.assembly, design.kinematics, name)
    if found.joint is not None:
        return found.joint.name
    if found.intended is not None:
        raise refuse(f"the joint {name!r} of the function is none here: {found.reason}", file=source)
    intended = [joint.name for joint in design.assembly.function.joints]
    known = did_you_mean(name, [*intended, *(str(joint.name) for joint in design.kinematics.joints)], "the joints")
    raise refuse(f"no joint is named {name!r}: {known}", file=source)


def _draw(source: Path, topic: Topic | None, path: Path) -> None:
    """Write the kinematic graph to `path`."""
    if topic not in (Topic.mobility, Topic.joints):
        raise typer.BadParameter(
            "draws mobility or joints: kinform show F.h5 mobility --graph OUT.svg", param_hint="--graph"
        )
    if path.suffix not in (".svg", ".dot"):
        raise typer.BadParameter(f"{path.name!r} ends neither in .svg nor in .dot", param_hint="--graph")
    files.check_text_output(path, inputs=[source])
    design = looked_at(source, at_need=True)
    from kinform.errors import StageError
    from kinform.exports.graph.drawing import graph_dot, graph_svg

    with files.needing(source):
        if design.kinematics is None:
            raise StageError("`kinform show --graph`", "joints")
        files.write_text(path, (graph_svg if path.suffix == ".svg" else graph_dot)(design.kinematics))
