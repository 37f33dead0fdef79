"""The common course of verify, prove, inject, tree and rate: load, select, work, show, keep."""

from __future__ import annotations

import contextlib
import hashlib
import sys
import time
from argparse import Namespace
from collections.abc import Callable, Iterable, Sequence
from contextlib import closing
from dataclasses import dataclass, field
from fractions import Fraction
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

from safety.commands import INPUT_ERROR, INTERRUPTED, earlier, memory, settings
from safety.commands.earlier import Earlier
from safety.commands.evaluate import (
    Answer,
    Evaluate,
    Order,
    evaluate,
    fitting,
    models_of,
    without_result,
)
from safety.commands.options import cores
from safety.commands.output import probe, write, write_json
from safety.commands.screen import Screen
from safety.commands.selection import Item, items, select
from safety.commands.versions import versions
from safety.commands.workers import Workers
from safety.project import MODELS, PROOFS, Problem, Project, open_project
from safety.report import terminal
from safety.report.closing import settled
from safety.report.figures import decided
from safety.report.results import Results, ResultsError, empty, exit_code, merge, validate
from safety.report.schema import JUDGED, SCHEMA
from safety.report.standing import DISAGREE, INTERNAL, NOTHING, WORDS, standing

if TYPE_CHECKING:
    from safety.model import Model

NOUNS = {name: name for name in JUDGED} | {"trees": "hazards"}
SAVE_S = 30.0  # what a power cut may cost


@dataclass
class Session:
    """A piece of work on a project: what it found so far."""

    project: Project
    args: Namespace
    sections: Sequence[str]
    chosen: list[Item]
    results: Results
    earlier: Earlier | None = None
    tables: bool = False
    interrupted: bool = False
    notes: dict[str, str] = field(default_factory=dict)
    code: int = 0
    here: Evaluate | None = None  # what works on an item in this process, where no worker does
    records: dict[str, Any] = field(default_factory=dict)  # of campaigns, for a baseline

    @property
    def part(self) -> bool:
        """Whether only a part of the project's results was asked for, or of a changed model."""
        args = self.args
        chosen = args.keyword or args.req or args.lf or args.first or getattr(args, "changed", False)
        chosen = chosen or getattr(args, "paper", None)
        return bool(chosen or args.settings)

    def work(self) -> None:
        """Do everything that was chosen; results are shown as they come and kept, whatever happens."""
        began = time.monotonic()
        config, args = self.project.config, self.args
        given = {**config.settings, **dict(args.settings)}
        order = Order(args.timeout or config.timeout, given, bool(getattr(args, "vcd", None)), args.traceback)
        order.certify = getattr(args, "certify", None) or ""
        order.injecting = getattr(args, "injecting", {})
        if self.earlier:
            order.cache, order.again = True, self.earlier.again
        screen = Screen(not args.no_progress)
        try:
            self._show_problems(screen, self.project.problems)
            width = max((len(item.id) for item in self.chosen), default=0)
            left = self._recall(screen, width)
            if left and self.here:
                with screen:
                    self._one_by_one(left, order, screen, width)
            elif left:
                with screen, Workers(self.project, order, args.jobs or config.jobs or cores()) as workers:
                    self._gather(left, workers, screen, width)
        except KeyboardInterrupt:
            self.interrupted = True
            self.results["interrupted"] = True
        except BaseException:
            self._rescue(screen)
            raise
        self.results["runs"] = [{"command": args.command, "seconds": round(time.monotonic() - began, 3)}]
        self.code = self._end(screen)

    def _rescue(self, screen: Screen) -> None:
        """Keep what is there before an error ends the work; a second error must not hide the first."""
        self.interrupted = self.results["interrupted"] = True
        self.results["runs"] = [{"command": self.args.command}]
        done = sum(len(self.results.get(section, ())) for section in NOUNS)
        with contextlib.suppress(Exception):
            self._keep()
        with contextlib.suppress(Exception):
            if self.args.json:
                write_json(self.results, self.args.json)
        with contextlib.suppress(Exception):
            screen.say(f"stopped by an error; {done} of {len(self.chosen)} have a result, which is kept", "bold red")

    def _recall(self, screen: Screen, width: int) -> list[Item]:
        """Take what earlier runs have found of a project without a change; what is left to do."""
        left = []
        for item in self.chosen:
            entry = self.earlier.entry(item) if self.earlier else None
            if entry is None:
                left.append(item)
            else:
                self._take(Answer(item, entry), screen, width)
        return left

    def _gather(self, left: Sequence[Item], workers: Workers, screen: Screen, width: int) -> None:
        saved, done = time.monotonic(), len(self.chosen) - len(left)
        order = left if self.args.first else memory.longest_first(self.project.root, left)
        with closing(workers.run(order)) as events:
            for event in events:
                if event.item is not None:
                    self.notes[event.item.id] = event.note
                if event.answer is not None:
                    done += 1
                    as_asked = self._take(event.answer, screen, width)
                    if self.args.first and not as_asked:
                        return
                    if time.monotonic() - saved > SAVE_S:
                        self._keep()
                        saved = time.monotonic()
                screen.working(done, len(self.chosen), workers.at_work(), self.notes)

    def _one_by_one(self, left: Sequence[Item], order: Order, screen: Screen, width: int) -> None:
        """Work in this process; what is given out to others is given out by `here`."""
        for done, item in enumerate(left):
            screen.working(done, len(left), [item], self.notes)
            note = partial(self._tell, screen, item, done, len(left))
            as_asked = self._take(evaluate(self.project, item, order, note, self.here), screen, width)
            if self.args.first and not as_asked:
                return

    def _tell(self, screen: Screen, item: Item, done: int, of: int, text: str) -> None:
        self.notes[item.id] = text
        screen.working(done, of, [item], self.notes)

    def _take(self, answer: Answer, screen: Screen, width: int) -> bool:
        """Show and keep an answer; whether it is as asked."""
        item, entry = answer.item, answer.entry
        if self.earlier:
            self.earlier.reads += answer.reads
        if answer.problem is not None:
            self._show_problems(screen, [answer.problem])
            self.project.problems.append(answer.problem)
        if entry is None:
            return False
        if "record" in entry:
            self.records[item.id] = entry.pop("record")
        try:
            validate({"schema": SCHEMA, item.section: [entry]}, item.id)
        except ResultsError as error:  # one entry that is out of shape must not cost all the others
            entry = without_result(item, str(error))
        self.results.update(merge(self.results, {item.section: [entry]}))
        if item.section == "figures" and entry.get("claim"):
            return True  # its verdict is that of a claim that may come later: shown when all are there
        screen.result(item.section, entry, width)
        as_asked = standing(item.section, entry).code == 0
        if self.tables and as_asked and entry.get("counterexample"):  # the others follow at the end
            for row in terminal.changed_cells(entry):
                screen.say(row.text, row.style)
        if answer.vcd:
            path = Path(self.args.vcd, f"{item.id}.vcd")
            write(path, answer.vcd)
            screen.say(f"    waveform  {path}")
        return as_asked

    def _show_problems(self, screen: Screen, problems: Iterable[Problem]) -> None:
        for problem in problems:
            screen.say(f"x {problem}", "bold red")
            if self.args.traceback:
                screen.say(problem.traceback.rstrip())

    def _keep(self) -> str:
        """Keep the results for --lf, replay and report; why not, if so.

        Those of other settings, or of a part of a campaign, are not kept.
        """
        if self.args.settings or getattr(self.args, "shard", None):
            return ""
        done = not (self.part or self.interrupted or self.project.problems)
        return memory.keep(self.project.root, self.results, self.sections if done else ())

    def _close(self, screen: Screen) -> None:
        """Put the verdicts of claims to what names them; those of an earlier run too, if nothing has changed."""
        campaigns, figures = (self.results.get(section, ()) for section in ("campaigns", "figures"))
        if not any(entry.get("closure") for entry in campaigns) and not any(entry.get("claim") for entry in figures):
            return
        kept = {} if self.args.settings else memory.last(self.project.root)
        same = kept.get("models") == self.results["models"]
        known = merge(kept, self.results) if same else {**self.results}
        known["settings"] = {**self.project.config.settings, **dict(self.args.settings)}
        settle = {"campaigns": ("closure", settled), "figures": ("claim", decided)}
        for section, (names, closed) in settle.items():
            if self.results.get(section):
                entries = self.results[section]
                self.results[section] = [closed(entry, known) if entry.get(names) else entry for entry in entries]
        width = max((len(item.id) for item in self.chosen), default=0)
        for entry in self.results.get("figures", ()):
            if entry.get("claim"):
                screen.result("figures", entry, width)

    def _end(self, screen: Screen) -> int:
        """Keep and show what was found; the exit code."""
        problems, args = self.project.problems, self.args
        if problems:
            self.results["limits"] = [f"left out: {each.file}:{each.line}: {each.message}" for each in problems]
        self._close(screen)
        warning = self._keep()
        if self.earlier and not problems:
            self.earlier.keep(self.results)
        try:
            for row in terminal.summary(self.results)[:-1]:  # the last one is the exit code, which more bears on here
                screen.say(row.text, row.style)
            if warning:
                screen.say(warning, "yellow")
            for text in earlier.told(self.results):
                screen.say(text)
            code, why = self._code()
            screen.say(f"exit {code}: {why}", "bold red" if code else "bold green")
        finally:
            if args.json:
                write_json(self.results, args.json)
        return code

    def _code(self) -> tuple[int, str]:
        code, problems = exit_code(self.results), self.project.problems
        if self.interrupted:
            left = len(self.chosen) - sum(len(self.results.get(section, ())) for section in NOUNS)
            return INTERRUPTED, f"interrupted; {left} of {len(self.chosen)} have no result, the others are kept"
        if problems and code not in (INTERNAL, DISAGREE):
            names = ", ".join(sorted({problem.file for problem in problems}))
            return INPUT_ERROR, f"mend {names}; --traceback shows the whole way to the error"
        if code == INTERNAL:
            return code, "a fault of rightside; please report it, with what this command shows with --traceback"
        return code, WORDS[code]


def start(args: Namespace, sections: Sequence[str], whole: bool = False) -> Session:
    """Load the project and choose what to work on.  Raises CommandError or ProjectError."""
    project = open_project(Path(args.project) if args.project else None)
    before = earlier.of(project, args)
    if before is None or not before.known or whole:
        project.load_proofs()
    found = before.items(project, sections) if before else items(project, sections)
    chosen = select(found, args, memory.last(project.root) if args.lf else {})
    if before:
        chosen = before.chosen(project, chosen)
    results = empty(**versions())
    results["project"] = project.config.title or project.root.name
    results["models"] = texts(project)
    if args.settings:
        results["settings"] = {name: str(value) for name, value in args.settings}
    return Session(project, args, sections, chosen, results, before)


def texts(project: Project) -> list[dict[str, Any]]:
    """The files that the results rest on, each with the hash of its text."""
    return [
        {"id": path.relative_to(project.root).as_posix(), "sha256": hashlib.sha256(path.read_bytes()).hexdigest()}
        for folder in (MODELS, PROOFS)
        for path in sorted((project.root / folder).rglob("*.py"))
    ]


def work(
    args: Namespace,
    *sections: str,
    tables: bool = False,
    whole: bool = False,
    check: Callable[[Session], Evaluate | None] = lambda session: None,
) -> Session:
    """Do all that the arguments select; the session's `code` says how it ended.

    `tables`: show the runs of claims that are refuted as they must be.  `whole`: list the models' parameters too.
    `check` refuses what cannot be done before anything is, and may say what works in this process.
    """
    if args.json:
        probe(Path(args.json))
    if getattr(args, "vcd", None):
        probe(Path(args.vcd, "*.vcd"))
    if getattr(args, "certify", None):
        probe(Path(args.certify, "*.cert.zip"))
    session = start(args, sections, whole)
    if session.chosen and not (session.earlier and session.earlier.known):
        settings.check(session.project, _models(session.project, session.chosen), dict(args.settings))
    session.tables = tables
    session.here = check(session)
    if whole:
        session.results["parameters"] = parameters(session.project, session.chosen)
        session.results["figures"] = []
    if session.chosen or session.project.problems:
        session.work()
    else:
        nouns = " or ".join(NOUNS[section] for section in sections)
        why = "that fit this selection" if session.part else f"in {session.project.root / PROOFS}"
        print(f"nothing selected: there are no {nouns} {why}; `rightside list` shows all", file=sys.stderr)
        session.code = NOTHING
    return session


def parameters(project: Project, chosen: Sequence[Item]) -> list[dict[str, Any]]:
    """The parameters of every model that is worked on, with unit, range, source and its tag."""
    from safety.tracing import trace

    found = {}
    for model in _models(project, chosen):
        for each in trace(model, fitting(model, project.config.settings)).settings.values():
            entry = {"id": each.path, "model": model.__name__, "value": each.value, "unit": each.unit, "tag": each.tag}
            limits = {"low": each.low, "high": each.high, "note": each.source}
            found[model.__name__, each.path] = {name: _plain(value) for name, value in (entry | limits).items()}
    return list(found.values())


def _plain(value: Any) -> Any:
    """A fraction as the nearest double: what stands here is to be read."""
    return float(value) if isinstance(value, Fraction) else value


def _models(project: Project, chosen: Sequence[Item]) -> list[type[Model]]:
    """All models that items are about, each once."""
    return [*dict.fromkeys(model for item in chosen for model in models_of(project, item))]
