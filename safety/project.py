"""A project: its root, its configuration, and what its models/ and proofs/ declare.

The root is the nearest folder, here or above, that holds `proofs/` beside `models/` or `pyproject.toml`.  Files are
imported the way pytest finds tests: by their place below the root, in order of name.  A file that cannot be imported
becomes a `Problem`; the others count all the same.  Configuration stands in pyproject.toml:

    [tool.rightside]
    timeout = 60              # seconds for one question to a solver
    jobs = 2                  # worker processes; default: as many as there are cores
    report = "reports"        # folder of the report
    title = "..."             # head of the report; default: the name of the root folder
    settings = {k = 100}      # parameters of the models: each goes to those that have it
"""

from __future__ import annotations

import contextlib
import importlib
import importlib.util
import linecache
import re
import sys
import tomllib
import traceback
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from pathlib import Path
from types import ModuleType
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from safety.audit import Entry
    from safety.exhibits import Exhibit
    from safety.inject import Campaign
    from safety.model import Model
    from safety.prove.bounds.claims import RealClaim
    from safety.prove.claims import Claim
    from safety.prove.hazards import Hazard
    from safety.prove.weakest import Synthesis
    from safety.rates.claims import Rate

PROOFS, MODELS = "proofs", "models"
Value = bool | int | Fraction
_HUGE = re.compile(r"e[+-]?0*[1-9]\d{4,}", re.IGNORECASE)


class ProjectError(Exception):
    """The project cannot be used as it stands; the message names the place and what to do."""

    exit_code = 2


@dataclass(frozen=True)
class Problem:
    """Something in a project's file that stops what depends on it."""

    file: str  # relative to the root
    line: int
    message: str
    excerpt: str = ""
    traceback: str = field(default="", compare=False)

    def __str__(self) -> str:
        excerpt = f"\n    {self.excerpt}" if self.excerpt else ""
        return f"{self.file}:{self.line}: {self.message}{excerpt}"


@dataclass(frozen=True)
class Config:
    """What `[tool.rightside]` says."""

    timeout: float = 60.0
    jobs: int = 0
    report: str = "reports"
    title: str = ""
    settings: dict[str, Value] = field(default_factory=dict)


@dataclass
class Project:
    """A project on disk; `problems` grows as files are imported."""

    root: Path
    config: Config
    problems: list[Problem] = field(default_factory=list)

    def load_proofs(self) -> None:
        """Import every file of proofs/, and so the models that they use."""
        self._load(PROOFS)

    def load_models(self) -> None:
        """Import every file of models/."""
        self._load(MODELS)

    def _load(self, folder: str) -> None:
        for path in files(self.root / folder):
            problem = self.load(path)
            if problem is not None and problem not in self.problems:
                self.problems.append(problem)

    def load(self, path: Path) -> Problem | None:
        """Import one file; what it prints goes to stderr, since stdout is for data."""
        self._enter()
        try:
            with contextlib.redirect_stdout(sys.stderr):
                importlib.import_module(module_name(self.root, path))
        except (Exception, SystemExit) as error:
            return self.problem(error, path)
        return None

    def _enter(self) -> None:
        """Make the root the first place to import from, and forget the modules of another project."""
        place = str(self.root)
        if sys.path[:1] != [place]:
            sys.path.insert(0, place)
            importlib.invalidate_caches()
        for name, module in list(sys.modules.items()):
            if name.partition(".")[0] in (PROOFS, MODELS) and not _lies_in(module, self.root):
                del sys.modules[name]
        for name in (PROOFS, MODELS):
            if name not in sys.modules and not (self.root / name / "__init__.py").exists():
                sys.modules[name] = package = ModuleType(name)  # else any regular package of this name would win
                package.__path__ = [str(self.root / name)]

    def problem(self, error: BaseException, path: Path | None = None, line: int = 1) -> Problem:
        """An error as the user sees it: at the innermost line of the project's own files, else at `path` and `line`."""
        frames = [f for f in traceback.extract_tb(error.__traceback__) if self._declares(f.filename)]
        file = path or self.root
        if isinstance(error, SyntaxError) and error.filename:
            file, line = Path(error.filename), error.lineno or 1
        elif frames:
            file, line = Path(frames[-1].filename), frames[-1].lineno or 1
        where = file.relative_to(self.root).as_posix() if file.is_relative_to(self.root) else str(file)
        excerpt = "" if file == self.root else linecache.getline(str(file), line).strip()
        return Problem(where, line, _words(error), excerpt, "".join(traceback.format_exception(error)))

    def is_users(self, error: BaseException) -> bool:
        """Whether an error is the project's own: one of ours that says so, or one raised by the project's own lines."""
        if getattr(error, "exit_code", None) == 2:
            return True
        frames = traceback.extract_tb(error.__traceback__)
        return bool(frames) and self._declares(frames[-1].filename)

    def _declares(self, filename: str) -> bool:
        return any(Path(filename).is_relative_to(self.root / folder) for folder in (PROOFS, MODELS))

    @property
    def claims(self) -> list[Claim]:
        """The claims of all files imported so far."""
        from safety.prove.claims import registered

        return registered()

    @property
    def bounds(self) -> list[RealClaim]:
        """The claims of bounds over reals of all files imported so far."""
        if "safety.prove.bounds.claims" not in sys.modules:
            return []
        from safety.prove.bounds.claims import declared

        return declared()

    @property
    def syntheses(self) -> list[Synthesis]:
        """The weakest safe parameters that files imported so far look for."""
        if "safety.prove.weakest" not in sys.modules:
            return []
        from safety.prove.weakest import declared

        return declared()

    @property
    def hazards(self) -> list[Hazard]:
        """The hazards of all files imported so far."""
        from safety.prove.hazards import hazards

        return hazards()

    @property
    def campaigns(self) -> list[Campaign]:
        """The campaigns of all files imported so far."""
        if "safety.inject.campaign" not in sys.modules:
            return []
        from safety.inject import campaigns

        return list(campaigns())

    @property
    def rates(self) -> list[Rate]:
        """The rate statements of all files imported so far."""
        if "safety.rates.claims" not in sys.modules:
            return []
        from safety.rates.claims import declared

        return list(declared())

    @property
    def figures(self) -> list[Entry]:
        """What papers print, of all files imported so far."""
        if "safety.audit" not in sys.modules:
            return []
        from safety.audit import declared

        return list(declared())

    @property
    def exhibits(self) -> list[Exhibit]:
        """The tables and plots of all files imported so far."""
        if "safety.exhibits" not in sys.modules:
            return []
        from safety.exhibits import declared

        return declared()

    @property
    def models(self) -> dict[str, type[Model]]:
        """The models of all files of models/ imported so far, by full name without `models.`: `ts7.channel.Channel`."""
        from safety.model import Model

        found = {}
        for cls in filter(steps, _below(Model)):
            package, _, module = cls.__module__.partition(".")
            if package == MODELS and getattr(sys.modules.get(cls.__module__), cls.__name__, None) is cls:
                found[f"{module}.{cls.__name__}"] = cls
        return dict(sorted(found.items()))


def open_project(folder: Path | None = None) -> Project:
    """The project in or above a folder (default: the current one).  Raises ProjectError when there is none."""
    root = find_root(folder or Path.cwd())
    return Project(root, read_config(root))


def find_root(start: Path) -> Path:
    """The nearest folder, `start` or above, that holds a project."""
    start = start.resolve()
    if not start.is_dir():
        raise ProjectError(f"{start}: no such folder; give the project's folder")
    for folder in (start, *start.parents):
        if (folder / PROOFS).is_dir() and ((folder / MODELS).is_dir() or (folder / "pyproject.toml").is_file()):
            return folder
    raise ProjectError(
        f"no project in {start} or above: none of these folders has proofs/ beside models/ or pyproject.toml; "
        "change into a project or give --project DIR"
    )


def read_config(root: Path) -> Config:
    """`[tool.rightside]` of pyproject.toml.  Raises ProjectError for an unknown key or a value of the wrong kind."""
    path = root / "pyproject.toml"
    if not path.is_file():
        return Config()
    try:
        with path.open("rb") as file:
            table = tomllib.load(file, parse_float=_exact).get("tool", {}).get("rightside", {})
    except (tomllib.TOMLDecodeError, UnicodeDecodeError, OSError) as error:
        raise ProjectError(f"pyproject.toml: {error}; correct it there") from None
    settings = table.get("settings", {})
    kinds: dict[str, tuple[type, ...]] = {
        "timeout": (int, Fraction),
        "jobs": (int,),
        "report": (str,),
        "title": (str,),
        "settings": (dict,),
    }
    for name, value in table.items():
        if name not in kinds:
            raise ProjectError(f"pyproject.toml: [tool.rightside] has no {name!r}; it has {', '.join(kinds)}")
        if not isinstance(value, kinds[name]) or isinstance(value, bool):
            raise ProjectError(
                f"pyproject.toml: [tool.rightside] {name} = {value!r} is not a {kinds[name][-1].__name__}"
            )
    for name, value in settings.items():
        if not isinstance(value, bool | int | Fraction):
            raise ProjectError(
                f"{setting_place(root, name)}: setting {name} = {value!r} is no value; "
                "write a whole number, an exact decimal such as 0.5, true or false"
            )
    known: dict[str, Any] = {name: value for name, value in table.items() if name != "timeout"}
    return Config(**known, timeout=float(table.get("timeout", Config.timeout)))


def exact(text: str) -> Fraction:
    """A fraction or decimal as it stands.  Raises ValueError for anything else, and for powers of ten beyond 9999."""
    if _HUGE.search(text):
        raise ValueError(f"{text}: its power of ten is too large")
    try:
        return Fraction(text)
    except ZeroDivisionError:
        raise ValueError(f"{text}: a division by 0") from None


def _exact(text: str) -> Any:
    """A number of a TOML file; what is none (nan, inf) stays a text, which no setting takes."""
    try:
        return exact(text)
    except ValueError:
        return text


def setting_place(root: Path, name: str) -> str:
    """File and line where pyproject.toml sets a parameter."""
    named = re.compile(rf"""(?:^|[\s{{,."']){re.escape(name)}["']?\s*=""")
    lines = (root / "pyproject.toml").read_text(encoding="utf-8").splitlines()
    first = next((at for at, line in enumerate(lines) if line.startswith("[tool.rightside")), 0)
    found = next((at for at in range(first, len(lines)) if named.search(lines[at])), None)
    return "pyproject.toml" if found is None else f"pyproject.toml:{found + 1}"


def files(folder: Path) -> Iterator[Path]:
    """The Python files of a folder and those below it, in order of name; `_private` ones are left to be imported."""
    for path in sorted(folder.rglob("*.py")):
        if not any(part.startswith(("_", ".")) for part in path.relative_to(folder).parts):
            yield path


def module_name(root: Path, path: Path) -> str:
    """`proofs/ts7/voting.py` -> `proofs.ts7.voting`."""
    return ".".join(path.resolve().relative_to(root).with_suffix("").parts)


def _lies_in(module: Any, root: Path) -> bool:
    places: Sequence[str] = [*getattr(module, "__path__", ()), getattr(module, "__file__", None) or ""]
    return any(place and Path(place).is_relative_to(root) for place in places)


def _words(error: BaseException) -> str:
    if isinstance(error, SyntaxError):
        return f"{type(error).__name__}: {error.msg}"
    if isinstance(error, SystemExit):
        return f"the file ends the program (sys.exit({error.code!r})); a model or proof file only declares"
    text = str(error) or "no message"
    return text if getattr(error, "exit_code", None) == 2 else f"{type(error).__name__}: {text}"


def steps(cls: type[Any]) -> bool:
    """Whether a model can be run; a class that only carries parameters cannot."""
    return hasattr(cls, "step")


def _below(base: type[Any]) -> Iterator[type[Any]]:
    for cls in base.__subclasses__():
        yield cls
        yield from _below(cls)
