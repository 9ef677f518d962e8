"""Pictures by file name, and the Markdown summary for a pull request that embeds them."""

from __future__ import annotations

from kinform.design import Design
from kinform.exports.names import FILES
from kinform.foundation.escapes import lines as safe_lines
from kinform.foundation.progress import Progress
from kinform.reports.markdown import escaped
from kinform.reports.page import agreement, facts
from kinform.reports.page.pictures import Artist

MOST_PICTURE_FILES = 40
"""Findings that the summary tells, the worst first; errors and warnings among them get a picture. Chosen,
not measured."""


def page_pictures(artist: Artist, notes: bool = False, progress: Progress | None = None) -> dict[str, bytes]:
    """PNG files by name: overview.png, and finding-01-KF403.png and so on, the worst first; of `notes` where they are
    asked for. `progress` is told how many are drawn, and of how many."""
    pictured = [(name, finding) for name, finding in _told(artist.scene.design, notes) if name]
    out = {"overview.png": artist.overview()}
    for name, finding in pictured:
        if progress is not None:
            progress(len(out), len(pictured) + 1)
        out[name] = artist.finding(finding.index)
    return out


def _told(design: Design, notes: bool) -> list[tuple[str, facts.FindingFacts]]:
    """The findings that the summary tells, the worst first, each with the name of its picture; empty: it has none."""
    found = facts.findings(design)[:MOST_PICTURE_FILES]
    return [
        (f"finding-{n:02d}-{FILES.spell(f.code)}.png" if notes or f.severity != "note" else "", f)
        for n, f in enumerate(found, 1)
    ]


def page_summary(design: Design, notes: bool = False) -> str:
    """Markdown: verdict, overview, what disagrees, each finding; their pictures, those of `notes` where they are asked
    for, are beside it."""
    verdict = facts.verdict_of(design)
    name = escaped(design.assembly.name)
    lines = [
        f"# {name}: {verdict.sign} {escaped(verdict.line)}",
        "",
        *([escaped(verdict.coverage), ""] if verdict.coverage else []),
        escaped(verdict.counts),
        "",
        f"![{name}](overview.png)",
        "",
    ]
    rows = agreement.rows(design)
    if rows:
        lines += ["| about | form | behaviour | function | verdict |", "|---|---|---|---|---|"]
        for row in rows:
            codes = "".join(f" {design.report.findings[k].code}" for k in row.findings) if design.report else ""
            cells = (
                row.name,
                row.form or "–",
                row.behaviour or "–",
                row.function or "–",
                f"{row.sign} {row.mark}{codes}",
            )
            lines.append("| " + " | ".join(map(escaped, cells)) + " |")
        lines.append("")
    told = _told(design, notes)
    for file, finding in told:
        lines += [
            f"## {finding.sign} {finding.severity} {finding.code}: {escaped(finding.rule)}: {escaped(finding.subject)}",
            "",
            escaped(finding.message),
            "",
        ]
        lines += [f"- {key}: {escaped(value)}" for key, value in finding.facts]
        lines += [f"- remedy: {escaped(finding.remedy)}"] if finding.remedy else []
        lines += ["", f"![{finding.code}]({file})", ""] if file else [""]
    left = len(design.report.findings) - len(told) if design.report else 0
    lines += [f"{left} more findings are in the report.", ""] if left > 0 else []
    undecided = [rule for rule in facts.rules(design) if rule.outcome == "inconclusive"]
    if undecided:
        lines += ["## Not decided", "", *(f"- {r.code} {escaped(r.rule)}: {escaped(r.reason)}" for r in undecided), ""]
    return safe_lines("\n".join(lines))
