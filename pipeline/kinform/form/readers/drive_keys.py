"""What the keys of a drive, or of a coupling, say about each other."""

from __future__ import annotations

from typing import Any

from kinform.form.readers.open_manifest import Scope
from kinform.foundation.words import listed
from kinform.model.function import ARMS, friction_arms


def efficiencies(scope: Scope, table: Any, *path: str | int) -> tuple[float, float]:
    """Of a coupling of two joints, from the first to the second and back."""
    for key in ("efficiency", "efficiency_back"):
        if len(table.joints) > 2 and getattr(table, key) not in (None, 1.0):
            remedy = "state what is lost as friction on the shafts where it is lost"
            scope.complain(f"{key} is of couplings of two joints", remedy, *path, key)
    back = 2.0 - 1.0 / table.efficiency if table.efficiency_back is None else table.efficiency_back
    return table.efficiency, back


def complain_of_drive(scope: Scope, table: Any, law: bool, joint: str | None, *path: str | int) -> None:
    """Problems of a `[[function.drive]]`, with a law or without, on a joint that is stated to be of this type."""
    if table.kind in ("servo", "dc_motor"):
        _complain_of_controller(scope, table, *path)
    if table.kind == "dc_motor":
        _complain_of_motor(scope, table, law, *path)
    if table.kind == "friction":
        _complain_of_friction(scope, table, *path)
        _complain_of_arms(scope, table, joint, *path)


def _complain_of_friction(scope: Scope, table: Any, *path: str | int) -> None:
    """Problems of what the keys of a friction say about each other."""
    for rest, motion in (("static", "coefficient"), ("static_effort", "effort")):
        lesser, greater = getattr(table, rest), getattr(table, motion)
        if lesser is not None and greater is not None and lesser < greater:
            wrong = (
                f"friction at rest ({rest} = {lesser:g}) cannot be less than that in motion ({motion} = {greater:g})"
            )
            scope.complain(wrong, f"give {rest} ≥ {motion}", *path, rest)


def _complain_of_arms(scope: Scope, table: Any, joint: str | None, *path: str | int) -> None:
    """Problems of radii and lengths that cannot act: without a coefficient, or on another type of joint."""
    by_load = table.coefficient is not None or table.static is not None
    if not by_load and (table.effort is not None or table.static_effort is not None):
        for key in sorted((ARMS | {"least_reactions"}) & table.model_fields_set):
            wrong = f"{key} does nothing: friction of an effort alone does not depend on what presses"
            scope.complain(wrong, "state a coefficient too, or remove it", *path, key)
        return
    acting = ARMS if joint is None else friction_arms(joint, table.freedom or "")
    for key in sorted((ARMS & table.model_fields_set) - acting):
        which = f"the {table.freedom} of a" if table.freedom else "a"
        takes = f"remove it: friction there has {listed(sorted(acting))}" if acting else "remove it"
        scope.complain(f"{key} does nothing in the friction on {which} {joint} joint", takes, *path, key)


def _complain_of_controller(scope: Scope, table: Any, *path: str | int) -> None:
    """Problems of what the keys of a controller say about each other."""
    cascade, pid = table.position_gain is not None, table.kp is not None
    of = {"kp": ("ki", "kd"), "position_gain": ("speed_gain", "speed_integral", "speed_limit")}
    if cascade and pid:
        remedy = "give kp, ki and kd, or position_gain, speed_gain, speed_integral and speed_limit"
        scope.complain("kp and position_gain are of different controllers", remedy, *path, "position_gain")
        return
    for gain, keys in of.items():
        for key in keys if getattr(table, gain) is None else ():
            if getattr(table, key):
                scope.complain(f"{key} is of a controller, which has no {gain}", f"give {gain} too", *path, key)
    if cascade and (table.speed_gain is None or table.speed_limit is None):
        missing = "speed_gain" if table.speed_gain is None else "speed_limit"
        scope.complain(f"position_gain without {missing}", f"give {missing} too", *path, "position_gain")
    if not cascade and not pid and table.kind == "servo":
        scope.complain("the servo has no gain", "give kp, or position_gain with its loop of speed", *path)


def _complain_of_motor(scope: Scope, table: Any, law: bool, *path: str | int) -> None:
    """Problems of what the keys of a dc_motor say about each other."""
    controlled = table.kp is not None or table.position_gain is not None
    if not controlled and table.limit:
        scope.complain("limit is of a controller, which has no kp", "give kp too", *path, "limit")
    if controlled and table.gear < 0.0:
        remedy = "give the gear as positive: motor and controller count their senses alike then"
        scope.complain("a controller with a negative gear drives the joint away", remedy, *path, "gear")
    if controlled and (table.voltage is not None or not law):
        scope.complain("a controlled dc_motor needs a law, its target, and no voltage", "see kp", *path)
    elif law == (table.voltage is not None):
        scope.complain("a dc_motor needs either voltage or law", "give one of them", *path)
    if table.gear == 0.0:
        scope.complain("the gear of a dc_motor is zero", "give motor turns a turn", *path, "gear")
