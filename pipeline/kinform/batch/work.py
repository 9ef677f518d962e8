"""What a worker does for one design."""

from __future__ import annotations

import hashlib
import os
import pickle
from collections import Counter
from pathlib import Path
from typing import Any

from kinform import method, results, stages
from kinform.consistency import verdict_of
from kinform.design import Design
from kinform.errors import InputError, Problem
from kinform.form.sources import Reading
from kinform.foundation.boundary import OUTSIDE, OUTSIDE_REMEDY, leads_out
from kinform.model.findings import SEVERITIES


def refuse_outside(source: str, *, allow_outside: bool) -> None:
    """Raise InputError for a design that is a link out of its folder: it was found, not named."""
    if not allow_outside and leads_out(source):
        raise InputError([Problem(f"is a link, and {OUTSIDE}", source, None, OUTSIDE_REMEDY)])


def run(
    source: str, output: str, *, allow_outside: bool = False, allow_xacro: bool = False, trust_results: bool = False
) -> dict[str, Any]:
    """Run the design at `source`, with its results at `output`; gives the fields of its row."""
    said: list[str] = []
    os.makedirs(os.path.dirname(output), exist_ok=True)
    refuse_outside(source, allow_outside=allow_outside)
    done = method.run(
        source, output, allow_outside=allow_outside, say=said.append, reading=Reading(allow_xacro=allow_xacro),
        trust_results=trust_results,
    )  # fmt: skip
    gist = results.read_gist(output, recorded=done.gist.recorded)
    return summary_of(gist, Path(output).read_bytes(), said)


def files_of(source: str, *, allow_outside: bool = False, allow_xacro: bool = False) -> dict[str, str]:
    """SHA-256 (hex) of every file that the readers open for the design at `source`, relative to its folder, and of the
    list of each folder that they look through, with "/" at its end; {} where these do not say all that counts."""
    from kinform.form.readers.assembly import load_with_contents

    refuse_outside(source, allow_outside=allow_outside)
    return load_with_contents(source, allow_outside=allow_outside, reading=Reading(allow_xacro=allow_xacro))[1]


def imported(source: str, *, allow_outside: bool = False, allow_xacro: bool = False) -> bytes:
    """The imported design, as bytes to be sent to a worker that sees none of its files."""
    refuse_outside(source, allow_outside=allow_outside)
    design = stages.import_(source, allow_outside=allow_outside, reading=Reading(allow_xacro=allow_xacro))
    return pickle.dumps(design, protocol=pickle.HIGHEST_PROTOCOL)


def derive(design: bytes) -> tuple[bytes, list[str]]:
    """The results file of an imported design, as bytes, and what was said."""
    said: list[str] = []
    whole, _ = method.completed(pickle.loads(design), say=said.append)
    return results.to_bytes(whole), said


def summary_of(gist: Design, data: bytes, said: list[str]) -> dict[str, Any]:
    """The fields of the row of a design, from the gist of its results and their bytes."""
    report, kinematics = gist.report, gist.kinematics
    assert report is not None and kinematics is not None
    verdicts = {severity: verdict_of(report, severity) for severity in SEVERITIES}
    return {
        "assembly": gist.assembly.name,
        "mobility": kinematics.mobility.effective,
        "counts": dict(Counter(finding.severity for finding in report.findings)),
        "ran": report.ran,
        "inconclusive": report.inconclusive,
        "ignored": len(report.ignored),
        "unselected": len(report.unselected),
        "verdicts": {fail_on: (one.kind, one.line) for fail_on, one in verdicts.items()},
        "coverage": verdicts["error"].coverage,
        "open": verdicts["error"].open,
        "notes": tuple(said),
        "lineage": gist.fingerprints.lineage.get("findings", ""),
        "files": dict(gist.fingerprints.files),
        "recorded": gist.recorded,
        "seal": results.digest_in(data),
        "digest": hashlib.sha256(data).hexdigest(),
    }
