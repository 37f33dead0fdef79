"""What the evidence does not show: every open end of a results document, worst first.

A report that hides these is worthless to an assessor: they stand first in the HTML, and a group is named even where it
is empty.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from fractions import Fraction
from typing import Any, NamedTuple

from safety.report.assumed import assumed_mode, mark, rests_on_assumed
from safety.report.figures import word
from safety.report.numbers import faults_text, number, tags_of
from safety.report.schema import Entry
from safety.report.standing import WORST_FIRST, judge

Results = Mapping[str, Any]


class Item(NamedTuple):
    """One open end, and the entry at which to read on."""

    label: str
    text: str
    section: str = ""
    entry: Entry | None = None


class Gap(NamedTuple):
    """Open ends of one kind; grave ones speak against the equipment or the evidence itself."""

    title: str
    meaning: str
    items: list[Item]
    grave: bool = False


LIMITS = (
    "A proof is about the model and the fault kinds named with the claim. "
    "That the model is the equipment as built is not shown here.",
    "Faults outside the named kinds, in wiring, software of other units, operation and maintenance, are not covered.",
    "Between two steps of a model's clock nothing is modelled.",
    "Rates are inputs: their uncertainty is carried through, their truth is not checked.",
)


def gaps(results: Results) -> list[Gap]:
    """All groups, the empty ones included."""
    return [
        Gap(
            "Not as asked",
            "The result is not what its author expects. Nothing may rest on it.",
            list(_not_as_asked(results)),
            grave=True,
        ),
        Gap(
            "Known defeats",
            "Refuted, as expected: here the equipment, as modelled, does not do what the sentence says.",
            _claims(
                results,
                lambda c: (
                    c["verdict"] == "refuted"
                    and c["expect"] == "refuted"
                    and _role(c) in ("claim", "defeat", "refinement")
                ),
            ),
            grave=True,
        ),
        Gap(
            "Faults that are dangerous and not detected",
            "Single entries of the failure-mode tables; the equipment goes on without a brake demand or an alarm.",
            list(_dangerous(results)),
            grave=True,
        ),
        Gap(
            "Undecided",
            "Neither proved nor refuted within the effort spent.",
            _claims(results, lambda c: c["verdict"] == "undecided"),
            grave=True,
        ),
        Gap(
            "Bounded",
            "Holds for the given number of steps from power-up; later is open.",
            _claims(results, lambda c: c["verdict"] == "bounded"),
        ),
        Gap(
            "Vacuous",
            "The premise cannot happen, or was not shown to happen: the claim says nothing yet.",
            _claims(results, lambda c: c["verdict"] == "vacuous" or _premise_unreached(c)),
        ),
        Gap(
            "Sampled",
            "A share of all injections, or of what inputs may be, was drawn; the figures are estimates.",
            list(_sampled(results)),
        ),
        Gap("Requirements without evidence", "No claim names them.", list(_unclaimed(results))),
        Gap(
            "User lemmas",
            "The proof uses lemmas written by hand. Each is proved itself, none is taken on trust.",
            list(_lemmas(results)),
        ),
        Gap("One engine only", "Proved, and no second solver family has agreed so far.", _claims(results, _lonely)),
        Gap("Assumed inputs [A]", "Values and conditions that no source gives.", list(_tagged(results, "A"))),
        Gap("Reconstructed inputs [R]", "Read out of a damaged or incomplete source.", list(_tagged(results, "R"))),
        Gap(
            "Published figures not confirmed",
            "Recomputed from the source's own data: a misprint, a contradiction, or not enough data.",
            list(_figures(results)),
        ),
        Gap(
            "Limits of trees and rates",
            "Bounds instead of values, cut sets not replayed, missing targets.",
            list(_numeric(results)),
        ),
        Gap(
            "Limits of the method",
            "True of every report of this kind.",
            [Item("", text) for text in (*results.get("limits", ()), *LIMITS)],
        ),
    ]


def _claims(results: Results, chosen: Any) -> list[Item]:
    return [Item(c["id"], _sentence(c), "claims", c) for c in results.get("claims", ()) if chosen(c)]


def _sentence(claim: Entry) -> str:
    steps = (claim.get("strength") or {}).get("steps")
    bound = f"{steps} steps: " if claim["verdict"] == "bounded" and steps is not None else ""
    faults = f" Faults: {faults_text(claim['faults'])}." if claim.get("faults") else ""
    why = f" Why: {claim['why']}." if claim.get("why") else ""
    return f"{bound}{claim.get('statement') or 'no statement in words'}{faults}{why}"


def _role(claim: Entry) -> str:
    return str(claim.get("role") or "claim")


def _premise_unreached(claim: Entry) -> bool:
    vacuity = claim.get("vacuity")
    return claim["verdict"] in ("proved", "bounded") and vacuity is not None and vacuity["premise_reached_at"] is None


def _lonely(claim: Entry) -> bool:
    return claim["verdict"] == "proved" and _role(claim) != "cover" and len(claim.get("agreed_by") or ()) < 2


def _not_as_asked(results: Results) -> Iterator[Item]:
    if results.get("interrupted"):
        yield Item("interrupted", "The run was stopped; what follows is a part.")
    for section, entry, judged in sorted(judge(results), key=lambda it: WORST_FIRST.index(it.standing.code)):
        if judged.code:
            yield Item(entry["id"], f"{judged.reason}. {entry.get('statement') or ''}".strip(), section, entry)


def _dangerous(results: Results) -> Iterator[Item]:
    for campaign in results.get("campaigns", ()):
        total = campaign["classes"]["dangerous_undetected"]
        rows = [row for row in campaign.get("fmeda", ()) if row.get("dangerous_undetected")]
        for row in rows:
            rate = (
                f" at {number(row['rate_per_h'])} /h{mark(assumed_mode(row))}"
                if row.get("rate_per_h") is not None
                else ""
            )
            count = f"{row['dangerous_undetected']} of {row.get('faults', '?')} faults"
            yield Item(f"{row['part']}: {row['mode']}", f"{count}{rate} ({campaign['id']})", "campaigns", campaign)
        if total and not rows:
            yield Item(
                campaign["id"], f"{number(total)} of {number(campaign['injections'])} injections", "campaigns", campaign
            )


def _sampled(results: Results) -> Iterator[Item]:
    for campaign in results.get("campaigns", ()):
        if not campaign["exhaustive"]:
            yield Item(
                campaign["id"],
                f"{number(campaign['injections'])} injections. {campaign.get('faults') or ''}",
                "campaigns",
                campaign,
            )
    for tree in results.get("trees", ()):
        if found := tree.get("uncertainty"):
            yield Item(tree["id"], f"{number(found['samples'])} samples of its uncertain inputs", "trees", tree)
    for tree in results.get("event_trees", ()):
        if found := next((one["uncertainty"] for one in tree["sequences"] if one.get("uncertainty")), None):
            yield Item(tree["id"], f"{number(found['samples'])} samples of its uncertain inputs", "event_trees", tree)


def _unclaimed(results: Results) -> Iterator[Item]:
    named = {claim.get("requirement") for claim in results.get("claims", ())}
    for requirement in results.get("requirements", ()):
        if requirement["id"] not in named:
            yield Item(requirement["id"], str(requirement.get("text", "")))


def _lemmas(results: Results) -> Iterator[Item]:
    for claim in results.get("claims", ()):
        lemmas = claim.get("user_lemmas")
        if lemmas:
            yield Item(
                claim["id"], ", ".join(lemmas) if isinstance(lemmas, list) else f"{lemmas} lemmas", "claims", claim
            )


def _tagged(results: Results, tag: str) -> Iterator[Item]:
    """Everything that carries the tag; a premise once, with all the claims that rest on it."""
    yield from _inputs([entry for entry in parameters(results) if entry.get("tag") == tag])
    resting: dict[str, list[Entry]] = {}
    for claim in results.get("claims", ()):
        for text in claim.get("assumptions", ()):
            if tag in tags_of(text):
                resting.setdefault(text, []).append(claim)
    for text, claims in resting.items():
        yield Item(", ".join(claim["id"] for claim in claims), text, "claims", claims[0])
    for campaign in results.get("campaigns", ()):
        modes = [f"{row['part']}: {row['mode']}" for row in campaign.get("fmeda", ()) if row.get("tag") == tag]
        if modes:
            yield Item(campaign["id"], f"failure rates of {'; '.join(modes)}", "campaigns", campaign)
    for tree in results.get("trees", ()):
        events = (tree.get("structure") or {}).get("basic_events", ())
        names = [event["name"] for event in events if event.get("source") == tag]
        if names:
            yield Item(tree["id"], f"basic events {', '.join(names)}", "trees", tree)
    for tree in results.get("event_trees", ()):
        rows = (row for one in tree["sequences"] for row in one.get("importance", ()) if row.get("source") == tag)
        if names := list(dict.fromkeys(row["event"] for row in rows)):
            yield Item(tree["id"], f"basic events {', '.join(names)}", "event_trees", tree)
        if named := [one["id"] for one in tree["sequences"] if tag == "A" and one["assumed"]]:
            yield Item(tree["id"], f"figures of the sequences {', '.join(named)}", "event_trees", tree)
    for rate in results.get("rates", ()):
        if tag in tags_of(rate.get("source") or ""):
            yield Item(rate["id"], str(rate["source"]), "rates", rate)
    for figure in results.get("figures", ()):
        if tag == "A" and figure.get("assumed"):
            yield Item(figure["id"], "; ".join(figure["assumed"]), "figures", figure)
    for exhibit in results.get("exhibits", ()):
        texts = [text for text in exhibit.get("assumed", ()) if tag in tags_of(text)]
        if texts:
            yield Item(exhibit["id"], "; ".join(texts), "exhibits", exhibit)


def _inputs(entries: list[Entry]) -> Iterator[Item]:
    """Parameters; those of one name, value and source once, with the models and parts that have them."""
    alike: dict[tuple[Any, ...], list[Entry]] = {}
    for entry in entries:
        name = entry["id"].rpartition(".")[2]
        note = " ".join((entry.get("note") or "").split())
        alike.setdefault((name, _value(entry.get("value")), entry.get("unit") or "", note), []).append(entry)
    for (name, _, unit, note), found in alike.items():
        value = f"{number(found[0].get('value'))} {unit}".rstrip() + (f": {note}" if note else "")
        places = sorted({_place(entry) for entry in found} - {""})
        where = f" (in {', '.join(places)})" if places else ""
        yield Item(name if len(found) > 1 else found[0]["id"], value + where, "parameters", found[0])


def _place(parameter: Entry) -> str:
    """Model and part of a parameter: `Ts7.a` for `a.window` of Ts7."""
    return ".".join(filter(None, (parameter.get("model"), parameter["id"].rpartition(".")[0])))


def _value(value: Any) -> Any:
    """A value to compare: 0.5 and "1/2" are the same."""
    try:
        return value if isinstance(value, bool) else float(Fraction(value))
    except (TypeError, ValueError, ZeroDivisionError, OverflowError):
        return str(value)


def _figures(results: Results) -> Iterator[Item]:
    for figure in results.get("figures", ()):
        expected = ("confirmed", "rounding") if figure.get("published", True) else ("confirmed", "rounding", "assumed")
        if figure["verdict"] not in expected:
            meant = f", printed {figure['printed']} for {figure['mended']}" if figure.get("mended") else ""
            note = f": {figure['note']}" if figure.get("note") else ""
            yield Item(figure["id"], f"{word(figure)}{meant}{note}", "figures", figure)


def parameters(results: Results) -> list[Entry]:
    """All parameters: those of the document, then those that only a claim names; one entry a model and name."""
    found = {(entry.get("model") or "", entry["id"]): entry for entry in results.get("parameters", ())}
    for claim in results.get("claims", ()):
        for used in claim.get("parameters", ()):
            tag = next(iter(sorted(tags_of(used.get("source", "")))), "")
            entry = {**used, "id": used["name"], "model": claim["model"], "tag": tag, "note": used.get("source", "")}
            found.setdefault((claim["model"], used["name"]), entry)
    return [found[place] for place in sorted(found)]


def _cut_sets(tree: Entry) -> list[Entry]:
    return [*(tree.get("minimal_cut_sets") or {}).get("sets", ()), *tree.get("cut_sets", ())]


def _numeric(results: Results) -> Iterator[Item]:
    for tree in results.get("trees", ()):
        candidates = sum(cut.get("status") == "candidate" for cut in _cut_sets(tree))
        if candidates:
            yield Item(tree["id"], f"cut sets not replayed on the model, candidates only: {candidates}", "trees", tree)
        if tree.get("complete_at_all_orders") is False:
            yield Item(
                tree["id"], f"cut sets are complete up to order {tree.get('complete_to_order')} only", "trees", tree
            )
        low, high = tree.get("probability_low"), tree.get("probability_high")
        if tree.get("probability") is None and low is None and high is None:
            yield Item(tree["id"], "no probability: not every basic event has one", "trees", tree)
        elif tree.get("probability") is None:
            enclosed = f"{number(low)} to {number(high)}{mark(rests_on_assumed('trees', tree))}"
            yield Item(tree["id"], f"the probability is only enclosed: {enclosed}", "trees", tree)
    for rate in results.get("rates", ()):
        if rate.get("target") is None:
            yield Item(rate["id"], f"{rate['quantity']}: no target is given", "rates", rate)
