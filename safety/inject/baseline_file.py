"""Baseline files: the records of campaigns, read with care and refused where they are of another campaign."""

from __future__ import annotations

import json
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from safety.inject.baseline import SETS, identity
from safety.inject.number_sets import from_text
from safety.inject.space import CampaignError

if TYPE_CHECKING:
    from safety.inject.campaign import Campaign

SCHEMA = "rightside/baseline/1"
SHAPE = {
    "model": str, "faults": str, "space": str, "injections": int,
    "classes": dict, "detected_by": dict, "by_fault": dict,
}  # fmt: skip
KINDS = {str: "a text", int: "a number", dict: "an object"}


def dumps(records: Mapping[str, Mapping[str, Any]]) -> str:
    """The text of a baseline file: records by campaign, in a fixed order."""
    return json.dumps({"schema": SCHEMA, "campaigns": records}, indent=1, sort_keys=True, ensure_ascii=False) + "\n"


def loads(text: str, name: str) -> dict[str, dict[str, Any]]:
    """The records of a baseline file by campaign; `name` stands in messages for the file.

    Raises `CampaignError` with the place and what was expected there.
    """
    try:
        document = json.loads(text)
    except json.JSONDecodeError as bad:
        raise CampaignError(
            f"{name}:{bad.lineno}: no JSON: {bad.msg}; give a file of `rightside inject --write-baseline`"
        ) from None
    if not isinstance(document, dict) or document.get("schema") != SCHEMA:
        raise CampaignError(f'{name}:1: no baseline: it has no "schema": "{SCHEMA}"; give a file of --write-baseline')
    records = document.get("campaigns")
    if not isinstance(records, dict):
        raise CampaignError(f'{name}:1: "campaigns" is no object; write it anew with --write-baseline')
    for campaign, record in records.items():
        wrong = _wrong(record)
        if wrong:
            line = next((n for n, row in enumerate(text.splitlines(), 1) if f"{json.dumps(campaign)}:" in row), 1)
            raise CampaignError(f"{name}:{line}: campaign {campaign!r}: {wrong}; write it anew with --write-baseline")
    return records


def _wrong(record: Any) -> str:
    """What keeps a record from being one, or nothing."""
    if not isinstance(record, dict):
        return "it is no object"
    for key, kind in SHAPE.items():
        if not isinstance(record.get(key), kind):
            return f"{key!r} is {record.get(key)!r}, expected {KINDS[kind]}"
    sets = {"dangerous_undetected": record.get("dangerous_undetected", 0), **record["detected_by"]}
    for name, text in sets.items():
        try:
            if text is not None:
                from_text(text, record["injections"])
        except (AttributeError, ValueError) as bad:
            return f"{name!r} is no set of injections: {bad}"
    for name in SETS:
        listed = record["by_fault"].get(name)
        if listed is not None and not _is_by_fault(listed):
            return f"'by_fault' has {name!r}, but not a number and a digest for each fault"
    if record["dangerous_undetected"] is None and "dangerous_undetected" not in record["by_fault"]:
        return "'by_fault' lacks 'dangerous_undetected', which is left out"
    if None in record["detected_by"].values() and "detected" not in record["by_fault"]:
        return "'by_fault' lacks 'detected', of which something is left out"
    return ""


def _is_by_fault(listed: Any) -> bool:
    return isinstance(listed, dict) and all(
        isinstance(one, list) and len(one) == 2 and isinstance(one[0], int) for one in listed.values()
    )


def same_campaign(record: Mapping[str, Any], campaign: Campaign, file: str) -> None:
    """Refuse a record of another campaign.  Raises `CampaignError` with what differs and what to do."""
    now = identity(campaign)
    differs = [
        f"its {what} was {record[what]!r}, is {now[what]!r}"
        for what in ("model", "faults")
        if record[what] != now[what]
    ]
    if not differs and any(record[key] != value for key, value in now.items()):
        differs = [f"{now['faults']} as before, but other ones, or others at other times"]
    if differs:
        raise CampaignError(
            f"{file}: campaign {campaign.id!r} is another one: {'; '.join(differs)}; look at its results, then accept "
            f"them with `rightside inject -k {campaign.id} --write-baseline {file}`"
        )
