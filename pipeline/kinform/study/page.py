"""The page of a study: what follows from it, and pictures of its samples, in one file that needs no other."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from kinform.foundation.escapes import html
from kinform.foundation.words import number
from kinform.study.pictures import histogram, scatter
from kinform.study.plan import Measure
from kinform.study.session import Outcome
from kinform.study.statistics import Statistics, statistics, whole_yield

_STYLE = """
:root{color-scheme:light dark;--line:#8886;--ink:#1668c4}
body{font:15px/1.5 system-ui,sans-serif;max-width:64rem;margin:2rem auto;padding:0 1rem}
h1,p{overflow-wrap:anywhere}.table{overflow-x:auto;margin:.5rem 0 1.5rem}table{border-collapse:collapse}
th,td{padding:.2rem .8rem .2rem 0;text-align:right;
border-bottom:1px solid var(--line)}th:first-child,td:first-child{text-align:left}
figure{display:inline-block;margin:.5rem 1rem 1rem 0;max-width:320px;vertical-align:top}figcaption{font-size:.85rem}
svg{background:#8881;max-width:100%;height:auto}svg rect,svg circle{fill:var(--ink)}svg .limit{stroke:#c33}
svg path{stroke:currentColor;fill:none}svg text{font-size:11px;fill:currentColor}
@media(prefers-color-scheme:dark){:root{--ink:#6cb0ff}}
"""


def page_html(outcome: Outcome) -> str:
    """The page."""
    study = outcome.plan.study
    failed = sum(bool(why) for why in outcome.failures)
    head = f"{html(study.design)}: {len(outcome.samples)} samples, {study.method}"
    blocks = [f"<h1>Study of {html(study.design)}</h1><p>{head}; {failed} failed.</p>"]
    whole = whole_yield(outcome)
    if whole is not None:
        good, n, (share, low, high) = whole
        blocks.append(f"<p><b>Yield {_percent(share)}</b> ({good} of {n}); 95 % interval {_percent(low)} to "
                      f"{_percent(high)}.</p>")  # fmt: skip
    found = statistics(outcome)
    blocks.append(_varies(outcome))
    blocks += [_table(("measure", "unit", "nominal", "mean", "95 %", "deviation", "lowest", "highest", "yield"),
                      [_row(one, _unit(outcome, k)) for k, one in enumerate(found)])]  # fmt: skip
    blocks += [_measure(outcome, k, one) for k, one in enumerate(found)]
    wrong = [f"<li>sample {k}: {html(why)}</li>" for k, why in enumerate(outcome.failures) if why]
    if wrong:
        blocks.append(f"<h2>Failed</h2><ul>{''.join(wrong[:20])}</ul>")
    body = "\n".join(blocks)
    title = f"kinform study: {html(study.design)}"
    return (
        f'<!doctype html>\n<html lang="en"><head><meta charset="utf-8"><title>{title}</title>'
        f'<meta name="viewport" content="width=device-width"><style>{_STYLE}</style></head>\n'
        f"<body>{body}</body></html>\n"
    )


def _row(one: Statistics, unit: str) -> tuple[str, ...]:
    interval = "" if one.mean_low is None else f"{_n(one.mean_low)} … {_n(one.mean_high)}"
    share = "" if one.share is None else _percent(one.share[0])
    return (
        one.name,
        unit,
        _n(one.nominal),
        _n(one.mean),
        interval,
        _n(one.deviation),
        _n(one.lowest),
        _n(one.highest),
        share,
    )


def _measure(outcome: Outcome, k: int, one: Statistics) -> str:
    """One measure: its histogram, a picture against each of what varies, sensitivities, the worst."""
    values = np.array([math.nan if row[k] is None else row[k] for row in outcome.measured], dtype=float)
    measure = outcome.plan.measures[k]
    limits = [value for value in (measure.least, measure.most) if value is not None]
    label = _titled(one.name, _unit(outcome, k))
    out = [f"<h2>{html(one.name)}</h2><p><code>{html(measure.value)}</code>{_between(measure, outcome, k)}</p>"]
    if np.isfinite(values).sum() > 1:
        out.append(histogram(label, values[np.isfinite(values)], limits))
        for j, axis in enumerate(outcome.plan.axes):
            column = [row[j] for row in outcome.samples]
            if all(isinstance(value, int | float) for value in column):
                given = np.array(column, float)
                out.append(scatter(_titled(axis.name, axis.unit), label, given, values, limits))
    rows = [(s.axis, _n(s.rank), "" if s.index is None else f"{_n(s.index)} ({_n(s.index_low)} … {_n(s.index_high)})")
            for s in one.sensitivities]  # fmt: skip
    out.append(_table(("what varies", "rank correlation", "first-order index (95 %)"), rows))
    names = [_titled(axis.name, axis.unit) for axis in outcome.plan.axes]
    worst = [(str(i), *(_n(v) for v in outcome.samples[i]), _n(outcome.measured[i][k])) for i in one.worst]
    out.append(_table(("worst samples", *names, label), worst))
    return "\n".join(out)


def _unit(outcome: Outcome, k: int) -> str:
    return outcome.units[k] if outcome.units else ""


def _titled(name: str, unit: str) -> str:
    return f"{name} ({unit})" if unit else name


def _between(measure: Measure, outcome: Outcome, k: int) -> str:
    """Its limits, in words."""
    unit = f" {html(_unit(outcome, k))}" if _unit(outcome, k) else ""
    told = [
        f"{word} {_n(value)}{unit}" for word, value in (("at least", measure.least), ("at most", measure.most))
        if value is not None
    ]  # fmt: skip
    return f"; good: {', '.join(told)}" if told else ""


def _varies(outcome: Outcome) -> str:
    """What varies, and how."""
    rows = []
    for axis in outcome.plan.axes:
        path = "a command" if axis.steps is None else ".".join(axis.steps)
        if axis.values is not None:
            how = f"one of {len(axis.values)} values" if len(axis.values) > 8 else ", ".join(map(_n, axis.values))
        else:
            sigma = ", ±3σ" if axis.distribution == "normal" else ""
            how = f"{axis.distribution}, {_n(axis.low)} to {_n(axis.high)}{sigma}"
        rows.append((axis.name, path, how, axis.unit or "as in the manifest"))
    return _table(("what varies", "path", "how", "unit"), rows)


def _table(head: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    top = "".join(f"<th>{html(text)}</th>" for text in head)
    lines = "".join("<tr>" + "".join(f"<td>{html(text)}</td>" for text in row) + "</tr>" for row in rows)
    table = f"<table><thead><tr>{top}</tr></thead><tbody>{lines}</tbody></table>"
    return f'<div class="table" role="group" tabindex="0" aria-label="table: {html(head[0])}">{table}</div>'


def _n(value: object) -> str:
    return "" if value is None else number(float(value), 5) if isinstance(value, int | float) else str(value)


def _percent(share: float) -> str:
    return f"{number(100 * share, 4)} %"
