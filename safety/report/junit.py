"""JUnit XML for continuous integration: a suite for each kind of result, a test case for each result.

A campaign that is not as asked has a failure for each of its surprises.
"""

from __future__ import annotations

from xml.etree import ElementTree as ET

from safety.report.numbers import clean
from safety.report.results import Results
from safety.report.schema import JUDGED, Entry
from safety.report.standing import DISAGREE, INTERNAL, WORDS, Judged, judge


def junit(results: Results, timings: bool = False) -> str:
    """What is not as asked is a failure; disagreeing engines and internal errors are errors, they blame the tool."""
    root = ET.Element("testsuites", name="rightside")
    judged = list(judge(results))
    for section in JUDGED:
        cases = [it for it in judged if it.section == section]
        if cases:
            suite = ET.SubElement(root, "testsuite", {"name": section, **_counts(cases)})
            for case in cases:
                _case(suite, case, timings)
    for name in ("tests", "failures", "errors"):
        root.set(name, _counts(judged)[name])
    ET.indent(root)
    return '<?xml version="1.0" encoding="UTF-8"?>\n' + ET.tostring(root, encoding="unicode") + "\n"


def _counts(cases: list[Judged]) -> dict[str, str]:
    errors = sum(_is_error(case) for case in cases)
    failures = sum(bool(case.standing.code) for case in cases) - errors
    return {"tests": str(len(cases)), "failures": str(failures), "errors": str(errors), "skipped": "0"}


def _is_error(case: Judged) -> bool:
    return case.standing.code in (DISAGREE, INTERNAL)


def _case(suite: ET.Element, case: Judged, timings: bool) -> None:
    entry = case.entry
    classname = f"{case.section}.{entry.get('model') or entry.get('paper') or case.section}"
    element = ET.SubElement(suite, "testcase", classname=clean(classname), name=clean(entry["id"]))
    seconds = entry.get("seconds")
    if timings and isinstance(seconds, int | float):
        element.set("time", f"{seconds:.3f}")
    if case.standing.code:
        kind = "error" if _is_error(case) else "failure"
        surprises = entry.get("surprises") if kind == "failure" else None
        for reason in surprises or [case.standing.reason]:
            failure = ET.SubElement(element, kind, message=clean(reason), type=WORDS[case.standing.code])
            failure.text = clean(_story(entry))


def _story(entry: Entry) -> str:
    """What a reader of the CI page needs to go on."""
    lines = [str(entry.get("statement") or entry.get("quantity") or "")]
    trace = entry.get("counterexample")
    if trace and trace.get("values"):
        lines += [*(f"{name} = {value}" for name, value in trace["values"].items()), trace.get("replay") or ""]
    elif trace:
        lines += [
            f"faults: {'; '.join(trace.get('faults') or ['none'])}",
            f"violated at tick {trace['violated_at']}",
            trace.get("replay") or "",
        ]
    return "\n".join(line for line in lines if line)
