"""SARIF 2.1.0 (OASIS Standard) of campaigns: what code-scanning pages and reviews of changes show.

Each dangerous undetected injection, each detection that a baseline had and the run has not, and each missed target is a
result at the line where its campaign is declared.  Its fingerprint is made of the campaign's and the injection's id, so
it is the same in every run, whatever else is injected.
"""

from __future__ import annotations

import hashlib
import json
import re
import shlex
from collections.abc import Iterator, Mapping
from typing import Any, NamedTuple
from urllib.parse import quote

from safety.report.numbers import clean
from safety.report.results import Results
from safety.report.schema import Entry
from safety.report.standing import standing

SCHEMA = "https://docs.oasis-open.org/sarif/sarif/v2.1.0/errata01/os/schemas/sarif-schema-2.1.0.json"
MOST = 5000  # results of a campaign; what is left out is said
FINGERPRINT = "rightside/v1"
ROOT = "%SRCROOT%"
_CHANGED = re.compile(r"(.*): \d+ (.+) before, \d+ now", re.DOTALL)  # a change of a fault, see `safety.inject.baseline`

RULES = {
    "dangerous-undetected": "A fault leads to the wrong side and nothing detects it",
    "lost-detection": "A fault that the baseline has as detected is not detected any more",
    "changed-set": "The injections of a fault came out otherwise than in the baseline, which does not list them",
    "coverage-below-target": "The lower bound of the diagnostic coverage is below its target",
    "not-as-declared": "A campaign came out otherwise than its declaration says",
}


class Finding(NamedTuple):
    """One result: rule, what it is about, what is said of it, and how it stands to the baseline."""

    rule: str
    subject: str  # the injection's id, or the campaign's
    text: str
    replay: str = ""
    state: str = ""  # new, unchanged or absent where there is a baseline
    aspect: str = ""  # what of the subject, where there may be several


def sarif(results: Results) -> str:
    """The log of all campaigns in a results document, as JSON text."""
    found: list[dict[str, Any]] = []
    notes: list[dict[str, Any]] = []
    for entry in results.get("campaigns", ()):
        findings = list(_findings(entry))
        found += [_result(entry, finding) for finding in findings[:MOST]]
        left_out = max(len(findings) - MOST, 0) + max(entry.get("replay_of", 0) - len(entry.get("replay", ())), 0)
        if left_out:
            notes.append(_note(f"{entry['id']}: up to {left_out} more results are left out", "warning"))
        target = entry.get("target_coverage") or {}
        if target.get("met", True) is None:
            notes.append(_note(f"{entry['id']}: {target['told']}", "warning"))
        if entry.get("error"):
            notes.append(_note(f"{entry['id']}: {entry['error']}", "error"))
    whole = not (results.get("interrupted") or any(note["level"] == "error" for note in notes))
    invocation = {"executionSuccessful": whole, "toolExecutionNotifications": notes}
    run = {
        "tool": {"driver": {**_driver(results), "rules": [_rule(name) for name in RULES]}},
        "columnKind": "unicodeCodePoints",
        "invocations": [invocation],
        "originalUriBaseIds": {ROOT: {"description": {"text": "The project's folder."}}},
        "results": found,
    }
    return json.dumps({"$schema": SCHEMA, "version": "2.1.0", "runs": [run]}, indent=1, ensure_ascii=False) + "\n"


def replay_command(of: str) -> str:
    """The command that shows an injection again; `of` is CAMPAIGN::INJECTION."""
    return f"rightside replay {shlex.quote(of)}"


def _findings(entry: Entry) -> Iterator[Finding]:
    """The results of a campaign, the gravest first."""
    baseline = entry.get("baseline") or {}
    new = baseline.get("new", {})
    listed = (line.partition("::")[2] for line in entry.get("replay", ()))
    for injection in dict.fromkeys([*new, *listed]):  # the results list only the first: a new one may not be among them
        state = ("new" if injection in new else "unchanged") if baseline else ""
        was = f" (in the baseline: {new[injection]})" if injection in new else ""
        text = f"{injection} is dangerous and undetected{was}."
        yield Finding("dangerous-undetected", injection, text, f"{entry['id']}::{injection}", state)
    for injection, now in baseline.get("lost", {}).items():
        text = f"{injection} was detected, and is {now.replace('_', ' ')} now."
        yield Finding("lost-detection", injection, text, f"{entry['id']}::{injection}", "new")
    for what, injection in baseline.get("unclear", {}).items():
        told = _CHANGED.fullmatch(what)
        fault, of = told.groups() if told else (what, "")
        yield Finding("changed-set", fault, f"{what}.", f"{entry['id']}::{injection}", "new", of)
    target = entry.get("target_coverage") or {}
    if target.get("met") is False:
        yield Finding("coverage-below-target", entry["id"], f"{target['told']}.")
    elsewhere = {*baseline.get("told", ()), target.get("told")}
    declared = [text for text in entry.get("surprises", ()) if text not in elsewhere]
    if declared or (entry.get("as_expected") is False and not (elsewhere - {None})):
        yield Finding("not-as-declared", entry["id"], f"{'; '.join(declared) or standing('campaigns', entry).reason}.")


def _result(entry: Entry, finding: Finding) -> dict[str, Any]:
    rules = list(RULES)
    replay = f" Replay: {replay_command(finding.replay)}" if finding.replay else ""
    found: dict[str, Any] = {
        "ruleId": finding.rule,
        "ruleIndex": rules.index(finding.rule),
        "level": "error",
        "message": {"text": clean(f"{entry['id']}: {finding.text}{replay}")},
        "locations": [_location(entry, finding)],
        "partialFingerprints": {FINGERPRINT: _fingerprint(entry, finding)},
    }
    if finding.state:
        found["baselineState"] = finding.state
    if finding.replay:
        found["properties"] = {"replay": clean(replay_command(finding.replay))}
    return found


def _location(entry: Entry, finding: Finding) -> dict[str, Any]:
    place: Mapping[str, Any] = entry.get("declared") or {}
    name = entry["id"] if finding.subject == entry["id"] else f"{entry['id']}::{finding.subject}"
    location: dict[str, Any] = {"logicalLocations": [{"fullyQualifiedName": clean(name), "kind": "member"}]}
    if place:
        artifact = {"uri": quote(place["file"]), "uriBaseId": ROOT}
        location["physicalLocation"] = {"artifactLocation": artifact, "region": {"startLine": place["line"]}}
    return location


def _fingerprint(entry: Entry, finding: Finding) -> str:
    parts = filter(None, (finding.rule, entry["id"], finding.subject, finding.aspect))
    return hashlib.sha256("\0".join(parts).encode("utf-8", "surrogatepass")).hexdigest()


def _driver(results: Results) -> dict[str, Any]:
    version = results.get("tool", {}).get("rightside")
    return {"name": "rightside", **({"version": str(version)} if version else {})}


def _rule(name: str) -> dict[str, Any]:
    short = "".join(word.title() for word in name.split("-"))
    return {
        "id": name,
        "name": short,
        "shortDescription": {"text": f"{RULES[name]}."},
        "defaultConfiguration": {"level": "error"},
    }


def _note(text: str, level: str) -> dict[str, Any]:
    return {"level": level, "message": {"text": clean(text)}}
