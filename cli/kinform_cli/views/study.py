"""What follows from a study, as tables."""

from __future__ import annotations

from typing import TYPE_CHECKING

from rich.console import Group

from kinform.foundation.words import counted, number
from kinform_cli.tables import Rows, stacked
from kinform_cli.text import NONE

if TYPE_CHECKING:
    from kinform.study import Outcome

_MEASURES = ("measure", "nominal", "mean", "±95 %", "deviation", "lowest", "highest", "yield")
_SENSITIVE = ("measure", "varies", "rank", "index", "95 %")


def render(outcome: Outcome) -> Group:
    """Yield, measures, sensitivities, the worst sample of each, and failures."""
    from kinform.study.statistics import statistics, whole_yield

    found = statistics(outcome)
    measures = Rows(*_MEASURES, right=_MEASURES[1:], names=["measure"])
    sensitive = Rows(*_SENSITIVE, right=_SENSITIVE[2:], names=["measure", "varies"])
    for one in found:
        half = None if one.mean_high is None or one.mean is None else one.mean_high - one.mean
        share = NONE if one.share is None else _percent(one.share[0])
        measures.add(one.name, *map(_n, (one.nominal, one.mean, half, one.deviation, one.lowest, one.highest)), share)
        for each in one.sensitivities:
            ends = NONE if each.index_low is None else f"{_n(each.index_low)} … {_n(each.index_high)}"
            sensitive.add(one.name, each.axis, _n(each.rank), _n(each.index), ends)
    lines = [f"{counted(len(outcome.samples), 'sample')}, {outcome.plan.study.method}"]
    whole = whole_yield(outcome)
    if whole is not None:
        good, n, (share_all, low, high) = whole
        lines.append(f"yield {_percent(share_all)} ({good} of {n}), 95 %: {_percent(low)} to {_percent(high)}")
    failures = [(k, why) for k, why in enumerate(outcome.failures) if why]
    all_of_them = "all of " if len(failures) == len(outcome.samples) else ""
    first = f", the first ({failures[0][0]}): {failures[0][1]}" if failures else ""
    told = [f"{all_of_them}{counted(len(failures), 'sample')} failed{first}"] if failures else []
    told += [f"{one.name}: not known of any sample" for one in found if one.lowest is None and not all_of_them]
    worst = [_worst(outcome, k, one.worst[0]) for k, one in enumerate(found) if one.worst]
    return stacked(*lines, measures, "", sensitive, "", *worst, *told)


def _worst(outcome: Outcome, k: int, i: int) -> str:
    """The value of a measure in a sample, and what the sample is."""
    given = zip(outcome.plan.axes, outcome.samples[i], strict=True)
    sample = ", ".join(f"{axis.name} {_n(value)}" for axis, value in given)
    return f"worst {outcome.plan.measures[k].name}: {_n(outcome.measured[i][k])} of sample {i}: {sample}"


def _n(value: object) -> str:
    return NONE if value is None else number(float(value)) if isinstance(value, int | float) else str(value)


def _percent(share: float) -> str:
    return f"{number(100 * share, 4)} %"
