"""What a shell may complete to: codes of rules, parts and joints of a results file.

Nothing here raises or prints: where names cannot be had there are none.
"""

from __future__ import annotations

import re
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from kinform.design import Design

_PLAIN = re.compile(r"[\w./#~+@%:,=-]+(?: [\w./#~+@%:,=-]+)*")
"""Names that are offered: shells and their completion scripts put others into a command as they are, where quotes,
dollars, semicolons and line ends have a meaning."""


def codes(incomplete: str) -> list[str]:
    """Codes of rules, and words that are explained."""
    from kinform.consistency import RULES
    from kinform.consistency.glossary import GLOSSARY

    words = [word for word in GLOSSARY if incomplete and word.startswith(incomplete.casefold())]
    return [rule.code for rule in RULES if rule.code.startswith(incomplete.upper())] + words


def parts(ctx: Any, incomplete: str) -> list[str]:
    """Parts, groups and bodies in the results file that stands before."""
    return _named(ctx, incomplete, _parts)


def joints(ctx: Any, incomplete: str) -> list[str]:
    """Joints in the results file that stands before, by the designer's names too."""
    return _named(ctx, incomplete, _joints)


def _parts(design: Design) -> list[str]:
    names = [str(part.name) for part in design.assembly.parts] + [str(group.name) for group in design.assembly.groups]
    return names + ([] if design.kinematics is None else [str(body.name) for body in design.kinematics.bodies])


def _joints(design: Design) -> list[str]:
    names = [joint.name for joint in design.assembly.function.joints]
    return names + ([] if design.kinematics is None else [str(joint.name) for joint in design.kinematics.joints])


def _named(ctx: Any, incomplete: str, names: Callable[[Design], list[str]]) -> list[str]:
    from kinform import results
    from kinform.errors import KinformError

    # after an option that has no value yet nothing has been taken for an argument
    source = ctx.params.get("source") or next(iter(ctx.args), "")
    try:
        design = results.read(Path(source))
    except (KinformError, OSError):
        return []
    return sorted({name for name in names(design) if name.startswith(incomplete) and _PLAIN.fullmatch(name)})
