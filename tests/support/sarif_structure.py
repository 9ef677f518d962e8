"""What SARIF 2.1.0 demands of the objects that kinform writes: a reader written from the standard, not from the writer.

The schema of the standard is not part of this repository. Of each object the properties that exist and their kind,
which are required, and the conditions between properties that a schema cannot say.
"""

from __future__ import annotations

from urllib.parse import urlsplit

TEXT, WHOLE, BAG = str, int, dict

OBJECTS = {
    "log": ({"$schema": TEXT, "version": TEXT, "runs": ["run"]}, {"version", "runs"}),
    "run": ({"tool": "tool", "columnKind": TEXT, "results": ["result"], "properties": BAG}, {"tool"}),
    "tool": ({"driver": "component"}, {"driver"}),
    "component": ({"name": TEXT, "version": TEXT, "rules": ["descriptor"]}, {"name"}),
    "descriptor": (
        {"id": TEXT, "name": TEXT, "shortDescription": "message", "help": "message", "defaultConfiguration": "level"},
        {"id"},
    ),
    "level": ({"level": TEXT}, set()),
    "result": (
        {
            "ruleId": TEXT, "ruleIndex": WHOLE, "kind": TEXT, "level": TEXT, "message": "message",
            "locations": ["location"], "partialFingerprints": BAG, "properties": BAG,
            "suppressions": ["suppression"], "baselineState": TEXT,
        },
        {"message"},
    ),
    "suppression": ({"kind": TEXT, "status": TEXT, "justification": TEXT}, {"kind"}),
    "message": ({"text": TEXT}, {"text"}),
    "location": ({"physicalLocation": "physical", "logicalLocations": ["logical"]}, set()),
    "physical": ({"artifactLocation": "artifact", "region": "region"}, {"artifactLocation"}),
    "artifact": ({"uri": TEXT}, set()),
    "region": ({"startLine": WHOLE}, set()),
    "logical": ({"name": TEXT, "fullyQualifiedName": TEXT, "kind": TEXT}, set()),
}  # fmt: skip


def check(log: object) -> None:
    """AssertionError where the log is no SARIF."""
    _check(log, "log", "log")
    assert log["version"] == "2.1.0"
    for run in log["runs"]:
        rules = run["tool"]["driver"]["rules"]
        assert len({rule["id"] for rule in rules}) == len(rules)
        for rule in rules:
            assert rule.get("defaultConfiguration", {}).get("level", "note") in ("none", "note", "warning", "error")
        for result in run["results"]:
            _check_result(result, rules)
        compared = {"baselineState" in result for result in run["results"]}
        assert len(compared) < 2, "3.27.24: all results have a state, or none has"


def _check_result(result, rules):
    kind, level = result.get("kind", "fail"), result.get("level", "warning")
    assert kind in ("notApplicable", "pass", "fail", "review", "open", "informational")
    assert level in ("none", "note", "warning", "error")
    assert (kind == "fail") == (level != "none"), "3.27.10: only failures have a level"
    assert result.get("baselineState", "new") in ("new", "unchanged", "updated", "absent")
    for suppression in result.get("suppressions", ()):
        assert suppression["kind"] in ("inSource", "external")
        assert suppression.get("status", "accepted") in ("accepted", "underReview", "rejected")
    if "ruleIndex" in result:
        assert rules[result["ruleIndex"]]["id"] == result["ruleId"]
    assert all(isinstance(value, str) for value in result.get("partialFingerprints", {}).values())
    text = result["message"]["text"].replace("{{", "").replace("}}", "")
    assert "{" not in text and "}" not in text, "3.11.5: braces are doubled"
    for location in result.get("locations", ()):
        physical = location.get("physicalLocation")
        if physical is not None:
            uri = physical["artifactLocation"]["uri"]
            assert uri.isascii() and not any(c.isspace() for c in uri) and not urlsplit(uri).scheme
            assert physical.get("region", {}).get("startLine", 1) >= 1


def _check(value, kind, where):
    if isinstance(kind, list):
        assert isinstance(value, list), where
        for k, item in enumerate(value):
            _check(item, kind[0], f"{where}[{k}]")
    elif isinstance(kind, type):
        assert isinstance(value, kind) and not isinstance(value, bool), where
    else:
        known, required = OBJECTS[kind]
        assert isinstance(value, dict), where
        assert required <= set(value) <= set(known), f"{where}: {sorted(value)}"
        for name, item in value.items():
            _check(item, known[name], f"{where}.{name}")
