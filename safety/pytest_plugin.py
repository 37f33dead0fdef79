"""Makes the claims and campaigns of a project's proofs/ test items of pytest.

Asked for with `--rightside`, or `rightside = true` in pytest's configuration; then `pytest proofs` collects every file
of proofs/, an item for each claim and campaign, named by its id.  An item passes when its result is as asked.
"""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest

if TYPE_CHECKING:
    from safety.commands.selection import Item
    from safety.project import Project


def pytest_addoption(parser: pytest.Parser) -> None:
    """`--rightside` and the ini option `rightside`."""
    parser.getgroup("rightside").addoption(
        "--rightside", action="store_true", help="collect the claims and campaigns of proofs/ as test items"
    )
    parser.addini("rightside", "collect the claims and campaigns of proofs/ as test items", type="bool", default=False)


def pytest_collect_file(file_path: Path, parent: pytest.Collector) -> ProofFile | None:
    """A file of proofs/, when asked for."""
    config = parent.config
    if file_path.suffix != ".py" or not (config.getoption("rightside") or config.getini("rightside")):
        return None
    project = _project(config, file_path)
    from safety.project import PROOFS, files

    if project is None or file_path not in files(project.root / PROOFS):
        return None
    collected: ProofFile = ProofFile.from_parent(parent, path=file_path, name=f"{file_path.name} (rightside)")
    collected.project = project
    return collected


class NotAsAsked(Exception):
    """A result that is not what its claim or campaign states; the text tells it in full."""


class ProofFile(pytest.File):
    """A file of proofs/."""

    project: Project

    def collect(self) -> Iterator[pytest.Item]:
        """An item for each claim and campaign that the file declares."""
        from safety.commands import CommandError, settings
        from safety.commands.selection import items
        from safety.project import module_name

        problem = self.project.load(self.path)
        if problem is not None:
            raise self.CollectError(f"{problem}\nmend this file; nothing of it was worked out")
        try:
            settings.check(self.project, [], {})
        except CommandError as error:
            raise self.CollectError(str(error)) from None
        home = module_name(self.project.root, self.path)
        homes = {("claims", c.id): c.formula.__module__ for c in self.project.claims}
        homes |= {("claims", b.id): b.module for b in self.project.bounds}
        homes |= {("campaigns", c.id): c.module for c in self.project.campaigns}
        for item in items(self.project, ("claims", "campaigns")):
            if homes[item.section, item.id] == home:
                test: Evidence = Evidence.from_parent(self, name=item.id)
                test.item = item
                yield test


class Evidence(pytest.Item):
    """A claim or a campaign."""

    item: Item

    def runtest(self) -> None:
        """Work it out; raises NotAsAsked."""
        from safety.commands.evaluate import Order, evaluate
        from safety.report.standing import standing

        parent = self.parent
        assert isinstance(parent, ProofFile)
        config = parent.project.config
        order = Order(config.timeout, config.settings)
        answer = evaluate(parent.project, self.item, order, lambda note: None)
        if answer.entry is None:
            raise NotAsAsked(str(answer.problem))
        judged = standing(self.item.section, answer.entry)
        if judged.code:
            raise NotAsAsked(_told(self.item.section, answer.entry, judged))

    def repr_failure(self, excinfo: pytest.ExceptionInfo[BaseException], style: Any = None) -> Any:
        """The result in words; a traceback only for what is no result."""
        return str(excinfo.value) if isinstance(excinfo.value, NotAsAsked) else super().repr_failure(excinfo, style)

    def reportinfo(self) -> tuple[Path, int | None, str]:
        """Where the item stands."""
        return self.path, None, self.name


def _told(section: str, entry: dict[str, Any], judged: Any) -> str:
    """Verdict, reason, statement, and for a refuted claim the table of changed cells."""
    from safety.commands.screen import line
    from safety.report.terminal import changed_cells

    lines = [line(section, entry, judged, 0), f"    {entry.get('statement') or entry.get('note') or ''}"]
    if entry.get("counterexample"):
        lines += [row.text for row in changed_cells(entry)]
    return "\n".join(lines)


_PROJECT: pytest.StashKey[dict[Path, Any]] = pytest.StashKey()


def _project(config: pytest.Config, path: Path) -> Project | None:
    """The project that a file lies in, opened once a run."""
    from safety.project import ProjectError, find_root, open_project

    opened = config.stash.setdefault(_PROJECT, {})
    try:
        root = find_root(path.parent)
    except ProjectError:
        return None
    if root not in opened:
        try:
            opened[root] = open_project(root)
        except ProjectError as error:
            raise pytest.UsageError(str(error)) from None
    found: Project = opened[root]
    return found
