"""The page of a study: what follows from it, and pictures of its samples, in one file that needs no other."""

from __future__ import annotations

import math
from collections.abc import Sequence
from html import escape

import numpy as np

from kinform.foundation.words import number
from kinform.study.session import Outcome
from kinform.study.statistics import Statistics, statistics, whole_yield

_STYLE = """
:root{color-scheme:light dark;--line:#8886;--ink:#1668c4}
body{font:15px/1.5 system-ui,sans-serif;max-width:64rem;margin:2rem auto;padding:0 1rem}
h1,p{overflow-wrap:anywhere}.table{overflow-x:auto;margin:.5rem 0 1.5rem}table{border-collapse:collapse}
th,td{padding:.2rem .8rem .2rem 0;text-align:right;
border-bottom:1px solid var(--line)}th:first-child,td:first-child{text-align:left}
figure{display:inline-block;margin:.5rem 1rem 1rem 0}figcaption{font-size:.85rem}
svg{background:#8881}svg rect,svg circle{fill:var(--ink)}svg line{stroke:#c33}svg text{font-size:11px;fill:currentColor}
@media(prefers-color-scheme:dark){:root{--ink:#6cb0ff}}
"""
_WIDTH, _HEIGHT, _MARGIN = 300, 170, 22


def page_html(outcome: Outcome) -> str:
    """The page."""
    study = outcome.plan.study
    failed = sum(bool(why) for why in outcome.failures)
    head = f"{escape(study.design)}: {len(outcome.samples)} samples, {study.method}"
    blocks = [f"<h1>Study of {escape(study.design)}</h1><p>{head}; {failed} failed.</p>"]
    whole = whole_yield(outcome)
    if whole is not None:
        good, n, (share, low, high) = whole
        blocks.append(f"<p><b>Yield {_percent(share)}</b> ({good} of {n}); 95 % interval {_percent(low)} to "
                      f"{_percent(high)}.</p>")  # fmt: skip
    found = statistics(outcome)
    blocks += [_table(("measure", "nominal", "mean", "95 %", "deviation", "lowest", "highest", "yield"),
                      [_row(one) for one in found])]  # fmt: skip
    blocks += [_measure(outcome, k, one) for k, one in enumerate(found)]
    wrong = [f"<li>sample {k}: {escape(why)}</li>" for k, why in enumerate(outcome.failures) if why]
    if wrong:
        blocks.append(f"<h2>Failed</h2><ul>{''.join(wrong[:20])}</ul>")
    body = "\n".join(blocks)
    title = f"kinform study: {escape(study.design)}"
    return (
        f'<!doctype html>\n<html lang="en"><head><meta charset="utf-8"><title>{title}</title>'
        f'<meta name="viewport" content="width=device-width"><style>{_STYLE}</style></head>\n'
        f"<body>{body}</body></html>\n"
    )


def _row(one: Statistics) -> tuple[str, ...]:
    interval = "" if one.mean_low is None else f"{_n(one.mean_low)} … {_n(one.mean_high)}"
    share = "" if one.share is None else _percent(one.share[0])
    return (
        one.name,
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
    out = [f"<h2>{escape(one.name)}</h2>"]
    if np.isfinite(values).sum() > 1:
        out.append(_figure(f"how often which {one.name}", _histogram(values[np.isfinite(values)], limits)))
        for j, axis in enumerate(outcome.plan.axes):
            column = [row[j] for row in outcome.samples]
            if all(isinstance(value, int | float) for value in column):
                out.append(_figure(f"{one.name} over {axis.name}", _scatter(np.array(column, float), values, limits)))
    rows = [(s.axis, _n(s.rank), "" if s.index is None else f"{_n(s.index)} ({_n(s.index_low)} … {_n(s.index_high)})")
            for s in one.sensitivities]  # fmt: skip
    out.append(_table(("what varies", "rank correlation", "first-order index (95 %)"), rows))
    names = [axis.name for axis in outcome.plan.axes]
    worst = [(str(i), *(_n(v) for v in outcome.samples[i]), _n(outcome.measured[i][k])) for i in one.worst]
    out.append(_table(("worst samples", *names, one.name), worst))
    return "\n".join(out)


def _histogram(values: np.ndarray[tuple[int], np.dtype[np.float64]], limits: Sequence[float]) -> str:
    ends = [*limits, float(values.min()), float(values.max())]
    low, high = min(ends), max(ends)
    high = high if high > low else low + 1.0
    counts, _ = np.histogram(values, bins=30, range=(low, high))
    step = (_WIDTH - 2 * _MARGIN) / len(counts)
    bars = [
        f'<rect x="{_MARGIN + i * step:.1f}" y="{_y(c / counts.max()):.1f}" width="{step * 0.9:.1f}" '
        f'height="{_y(0) - _y(c / counts.max()):.1f}"/>'
        for i, c in enumerate(counts)
        if c
    ]
    lines = [_line((v - low) / (high - low), True) for v in limits]
    return "".join(bars + lines) + _ends(low, high)


def _scatter(
    given: np.ndarray[tuple[int], np.dtype[np.float64]], values: np.ndarray[tuple[int], np.dtype[np.float64]],
    limits: Sequence[float],
) -> str:  # fmt: skip
    kept = np.flatnonzero(np.isfinite(values))[:2000]
    ends = [*limits, float(np.nanmin(values)), float(np.nanmax(values))]
    low, high = min(ends), max(ends)
    left, right = float(given.min()), float(given.max())
    high, right = (high if high > low else low + 1.0), (right if right > left else left + 1.0)
    points = [
        f'<circle cx="{_x((given[i] - left) / (right - left)):.1f}" cy="{_y((values[i] - low) / (high - low)):.1f}" '
        'r="1.5"/>'
        for i in kept
    ]
    lines = [_line((v - low) / (high - low), False) for v in limits]
    return "".join(points + lines) + _ends(left, right)


def _x(share: float) -> float:
    return _MARGIN + share * (_WIDTH - 2 * _MARGIN)


def _y(share: float) -> float:
    return _HEIGHT - _MARGIN - share * (_HEIGHT - 2 * _MARGIN)


def _line(share: float, upright: bool) -> str:
    if upright:
        return f'<line x1="{_x(share):.1f}" x2="{_x(share):.1f}" y1="{_y(0)}" y2="{_y(1)}"/>'
    return f'<line x1="{_x(0)}" x2="{_x(1)}" y1="{_y(share):.1f}" y2="{_y(share):.1f}"/>'


def _ends(low: float, high: float) -> str:
    at = _HEIGHT - 6
    return f'<text x="{_x(0)}" y="{at}">{_n(low)}</text><text x="{_x(1)}" y="{at}" text-anchor="end">{_n(high)}</text>'


def _figure(caption: str, drawing: str) -> str:
    text = escape(caption, quote=True)
    svg = f'<svg role="img" aria-label="{text}" width="{_WIDTH}" height="{_HEIGHT}">{drawing}</svg>'
    return f"<figure>{svg}<figcaption>{text}</figcaption></figure>"


def _table(head: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    top = "".join(f"<th>{escape(text)}</th>" for text in head)
    lines = "".join("<tr>" + "".join(f"<td>{escape(text)}</td>" for text in row) + "</tr>" for row in rows)
    table = f"<table><thead><tr>{top}</tr></thead><tbody>{lines}</tbody></table>"
    return f'<div class="table" role="group" tabindex="0" aria-label="table: {escape(head[0])}">{table}</div>'


def _n(value: object) -> str:
    return "" if value is None else number(float(value), 5) if isinstance(value, int | float) else str(value)


def _percent(share: float) -> str:
    return f"{number(100 * share, 4)} %"
