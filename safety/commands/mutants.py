"""`rightside prove --mutants`: would the chosen claims notice if a model said something else?"""

from __future__ import annotations

import functools
import hashlib
import sys
import time
from argparse import Namespace
from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from contextlib import closing
from pathlib import Path
from typing import TYPE_CHECKING, Any

from safety.commands import INPUT_ERROR, INTERRUPTED, CommandError, memory
from safety.commands.evaluate import Entry, Order, find
from safety.commands.options import cores
from safety.commands.output import probe, write_plain
from safety.commands.recall import folder, key_of
from safety.commands.screen import Screen
from safety.commands.selection import Item, items, select
from safety.commands.workers import Workers
from safety.project import Project, open_project
from safety.prove.cache import Cache
from safety.report.standing import NOTHING, UNDECIDED, WEAKER

if TYPE_CHECKING:
    from safety.prove.claims import Claim
    from safety.prove.mutants import Fate
    from safety.prove.mutation import Mutant, Mutants
    from safety.prove.mutation_case import Subject

AT_ONCE = 256  # mutants in one piece of work: a run costs nearly the same for one as for all of them
SCHEMA = "rightside/mutants/2"
ELSEWHERE = "elsewhere"  # not examined here: another model's claims notice the same change of the same line
PROOF_LOST = "proof lost"
LEFT = (PROOF_LOST, "slack", "undecided", "unclaimed")
NOT_SHOWN = "proof lost: not killed; it is not shown whether a claim would notice"
TIMEOUT = 20.0  # seconds for one question, as usual


def run(args: Namespace) -> int:
    """Carry out the verb with this option; returns the exit code."""
    if args.settings:
        raise CommandError("--mutants takes the models as written; leave --set out")
    if args.json:
        probe(Path(args.json))
    project = open_project(Path(args.project) if args.project else None)
    project.load_proofs()
    last = memory.last(project.root) if args.lf else {}
    ids = [item.id for item in select(items(project, ["claims"]), args, last) if not item.is_bound]
    work = _Work([find(project.claims, name) for name in ids], project.root, Screen(not args.no_progress))
    if not work.models:
        print("nothing selected: no claim that must be proved fits", file=sys.stderr)
        return NOTHING
    order = Order(args.timeout or TIMEOUT, traceback=args.traceback, cache=args.cache)
    began = time.monotonic()
    try:
        with work.screen, Workers(project, order, args.jobs or project.config.jobs or cores()) as workers:
            work.gather(workers)
    except KeyboardInterrupt:
        work.interrupted = True
    return work.end(args.json, round(time.monotonic() - began, 3))


def examined(project: Project, item: Item, order: Order) -> Entry:
    """A worker's answer to one piece of work: the fate of each of its mutants, or what an earlier run has found."""
    from safety.prove.mutants import examine
    from safety.prove.mutation_kept import Kills

    began = time.perf_counter()
    numbers = [int(number) for number in item.expect.split()]
    subject = _subject(tuple(item.statement.split()), order.timeout)
    cache = Cache(folder(project.root), lambda text: print(text, file=sys.stderr)) if order.cache else None
    key = _key(subject, numbers) if cache is not None else None
    found = cache.get(key) if cache is not None and key else None
    if found is None:
        fates = examine(subject, numbers, Kills(cache, subject.mutants))
        found = [_entry(project.root, item.model, subject.mutants, fate) for fate in fates]
        if cache is not None and key:
            cache.put(key, found)
    return {"id": item.id, "mutants": found, "seconds": round(time.perf_counter() - began, 3)}


def _key(subject: Subject, numbers: Sequence[int]) -> str | None:
    """What the fates of some mutants rest on: the claims' problems, the prover, the mutants, the time; None without."""
    from safety.prove.outcome import Limits

    limits = Limits(subject.timeout)
    keys = {case.claim.id: key_of(case.as_written, limits) for case in (*subject.proved, *subject.refuted)}
    asked = [f"{number} {subject.mutants[number]}" for number in numbers]
    if None in keys.values():
        return None
    return hashlib.sha256(repr((SCHEMA, keys, asked, subject.timeout)).encode()).hexdigest()


@functools.lru_cache(maxsize=1)  # pieces of one model come in a row
def _subject(ids: tuple[str, ...], timeout: float) -> Subject:
    from safety.prove.claims import registered
    from safety.prove.mutation_case import Subject

    return Subject([claim for claim in registered() if claim.id in ids], timeout)


def _entry(root: Path, model: str, mutants: Mutants, fate: Fate) -> Entry:
    found = {"verdict": fate.kind, "claim": fate.claim or None, "how": fate.how}
    return _told(root, model, mutants, fate.mutant) | found


def _told(root: Path, model: str, mutants: Mutants, mutant: Mutant) -> Entry:
    place = mutant.place
    file = Path(place.file) if place else None
    if file is not None and file.is_relative_to(root):
        file = file.relative_to(root)
    where = {"file": file.as_posix() if file else None, "line": place.line if place else None}
    said = {"was": mutant.was, "written": mutants.as_in_its_part(mutant), "change": mutant.change}
    return {"model": model, "number": mutant.number, **where, **said}


class _Work:
    """The mutants of some models, the smaller model first, and what became of them.

    A change of a line, or of a term of it, that is killed wherever it was made in one model is not made again in a
    greater one: whoever changes the text changes both.  One that is equivalent in the smaller model may show in the
    greater, and is made again.
    """

    def __init__(self, claims: Sequence[Claim], root: Path, screen: Screen) -> None:
        from safety.prove.claims import REFUTED
        from safety.prove.mutation_case import judged, mutants_for

        self.root, self.screen, self.interrupted, self.failed = root, screen, False, False
        by_model: dict[type, list[Claim]] = {}
        for claim in judged(claims):
            by_model.setdefault(claim.model, []).append(claim)
        told = [some for some in by_model.values() if any(claim.expect != REFUTED for claim in some)]
        found = [(mutants_for(some), some) for some in told]
        sizes = {some[0].model: len(mutants.mutants) for mutants, some in found}
        found.sort(key=lambda pair: _order(pair[1][0].model, sizes))
        self.models = [(mutants, [claim.id for claim in some], some[0].model.__name__) for mutants, some in found]
        self.entries: list[Entry] = []
        self.summaries: list[Entry] = []
        self.missing: list[Entry] = []  # mutants without a result, of which nothing may be taken for granted

    def gather(self, workers: Workers) -> None:
        """Take the answers as they come."""
        for mutants, ids, name in self.models:
            known = killed_on([*self.entries, *self.missing])
            every = [_told(self.root, name, mutants, mutant) for mutant in mutants.mutants]
            skipped = [e | _skipped(model) for e in every if (model := noticed_on(e, known))]
            numbers = [str(e["number"]) for e in every if not noticed_on(e, known)]
            self.summaries.append(
                {"id": name, "claims": len(ids), "mutants": len(every), "folded_away": mutants.trivial}
                | {"elsewhere": len(skipped)}
            )
            self.entries += skipped
            chunks = [numbers[k : k + AT_ONCE] for k in range(0, len(numbers), AT_ONCE)]
            pieces = [
                Item("mutants", f"{name} {chunk[0]}-{chunk[-1]}", name, statement=" ".join(ids), expect=" ".join(chunk))
                for chunk in chunks
            ]
            self._gather(workers, pieces)
            met = {each["number"] for each in self.entries if each["model"] == name}
            self.missing += [each | {"verdict": None} for each in every if each["number"] not in met]

    def _gather(self, workers: Workers, pieces: Sequence[Item]) -> None:
        done = 0
        with closing(workers.run(pieces)) as events:
            for event in events:
                if event.answer is not None:
                    done += 1
                    self._take(event.answer.item, event.answer.entry, event.answer.problem)
                self.screen.working(done, len(pieces), workers.at_work(), {})

    def _take(self, item: Item, entry: Entry | None, problem: Any) -> None:
        if problem is not None or entry is None or "mutants" not in entry:
            self.failed = True
            self.screen.say(f"x {item.id}: {problem or (entry or {}).get('error') or 'no result'}", "bold red")
            return
        self.entries += entry["mutants"]
        self.screen.say(f"  {item.id:<24} {_counts(entry['mutants'])}  {entry['seconds']:.1f} s")

    def end(self, target: str | None, seconds: float) -> int:
        """Show what was found, write it, and say how it ended."""
        _notice(self.entries, self.missing)
        for summary in self.summaries:
            own = sorted((e for e in self.entries if e["model"] == summary["id"]), key=lambda e: int(e["number"]))
            summary["verdicts"] = dict(Counter(each["verdict"] for each in own))
            summary["without_result"] = summary["mutants"] - len(own)
            told = [f"{summary['without_result']} without a result"] if summary["without_result"] else []
            counts = f"{summary['mutants']} mutants, {summary['claims']} claims"
            self.screen.say(f"{summary['id']}: {counts}: {', '.join([_counts(own), *told])}")
            for each in own:
                if each["verdict"] in LEFT:
                    self.screen.say(f"  {_line(each)}", "" if each["noticed_on"] else "yellow")
        totals = totals_of([*self.entries, *self.missing])
        self.screen.say(", ".join(f"{count} {key.replace('_', ' ')}" for key, count in totals.items()))
        if totals["proof_lost"]:
            self.screen.say(NOT_SHOWN, "yellow")
        if target:
            document = {"schema": SCHEMA, "interrupted": self.interrupted, "seconds": seconds, "totals": totals}
            write_plain(document | {"models": self.summaries, "mutants": self.entries}, target)
        if self.interrupted or self.failed:
            return INTERRUPTED if self.interrupted else INPUT_ERROR
        left = {each["verdict"] for each in self.entries if each["verdict"] in LEFT and not each["noticed_on"]}
        return UNDECIDED if "undecided" in left else WEAKER if left else 0


def _order(model: type, sizes: Mapping[type, int]) -> tuple[int, int]:
    """The smaller model first, a variant after the model that it is made from."""
    bases = [sizes[each] for each in model.__mro__ if each in sizes]
    return max(bases), len(bases)


def totals_of(entries: Sequence[Entry]) -> dict[str, int]:
    """How many mutants there are of each standing; a lost proof is no kill."""
    from safety.prove.mutants import KILLED

    kinds = Counter(each["verdict"] for each in entries)
    others = {kind.replace(" ", "_"): kinds[kind] for kind in (*LEFT, "equivalent", ELSEWHERE)}
    killed = sum(kinds[kind] for kind in KILLED)
    return {"mutants": len(entries), "killed": killed, **others, "without_result": kinds[None]}


Change = tuple[Any, ...]  # file, line, what is changed, perhaps what was written


def changes_of(entry: Entry) -> list[Change]:
    """The change of the text that a mutant stands for: that of any term of its line, and that of just this term."""
    line = (entry["file"], entry["line"], entry["change"])
    return [line, (*line, entry["written"])] if entry["file"] else []


def killed_on(entries: Sequence[Entry]) -> dict[Change, str]:
    """For each change of a line or term the first model in which it is killed wherever it was made."""
    from safety.prove.mutants import KILLED

    alike: dict[tuple[Change, str], list[str]] = {}
    for each in entries:
        for change in changes_of(each) if each["verdict"] != ELSEWHERE else []:
            alike.setdefault((change, each["model"]), []).append(each["verdict"])
    found: dict[Change, str] = {}
    for (change, model), verdicts in alike.items():
        if set(verdicts) <= set(KILLED):
            found.setdefault(change, model)
    return found


def noticed_on(entry: Entry, known: Mapping[Change, str]) -> str | None:
    """The model on which the same change is killed."""
    return next((known[change] for change in changes_of(entry) if change in known), None)


def _skipped(model: str) -> Entry:
    return {"verdict": ELSEWHERE, "claim": None, "how": f"the same change of the line is killed on {model}"}


def _notice(entries: Sequence[Entry], missing: Sequence[Entry] = ()) -> None:
    """Say of what is not killed on one model on which other one the same change of the line is."""
    known = killed_on([*entries, *missing])
    for each in entries:
        each["noticed_on"] = noticed_on(each, known) if each["verdict"] in (*LEFT, ELSEWHERE) else None


def _counts(entries: Iterable[Entry]) -> str:
    kinds = Counter(each["verdict"] for each in entries)
    return ", ".join(f"{count} {kind}" for kind, count in kinds.most_common()) or "none"


def _line(each: Entry) -> str:
    place = f"{each['file']}:{each['line']}" if each["file"] else "no place"
    told = f" ({each['how']})" if each["how"] else ""
    told += f"; noticed on {each['noticed_on']}" if each["noticed_on"] else ""
    return f"{each['verdict']}  {place}  {each['was']}: {each['change']}{told}"
