"""The house rules: arrows between the parts, what a start may load, names, sizes, and nothing of anyone's machine."""

import ast
import json
import re
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parent.parent

FACADE = "safety"  # safety/__init__.py hands out names to users; inside the package only the outermost parts use it

# The parts of safety/, each with the parts that it may import besides itself.
CORE = {"terms", "system", "canonical", "scope", "fields", "model", "tracing", "trace", "kinds", "faults"}
ANALYSES = CORE | {"export", "prove", "inject", "trees", "trees.from_model", "rates", "closure", "exhibits", "audit"}
EVERYTHING = ANALYSES | {FACADE, "project", "report", "commands", "pytest_plugin"}
MAY_IMPORT = {
    "terms": set(),
    "system": {"terms"},
    "canonical": {"terms", "system"},
    "scope": {"terms", "system"},
    "fields": {"terms", "system"},
    "model": {"terms", "system", "scope", "fields"},
    "tracing": {"terms", "system", "scope", "fields", "model"},
    "trace": {"terms", "system", "model", "tracing"},
    "kinds": {"terms", "system"},
    "faults": {"terms", "system", "kinds"},
    "export": {"terms", "system"},
    "prove": CORE | {"export"},
    "inject": CORE,
    "trees": {"rates"},
    "trees.from_model": CORE | {"prove", "trees"},
    "rates": set(),
    "exhibits": set(),
    "audit": CORE | {"export", "prove"},
    "closure": CORE | {"inject", "prove"},
    "project": ANALYSES,
    "report": ANALYSES | {"project"},
    "commands": EVERYTHING,
    "pytest_plugin": EVERYTHING,
    FACADE: ANALYSES,
}
OURS = {"safety": {"safety"}, "models": {"safety", "models"}, "proofs": {"safety", "models", "proofs"}}
SOLVERS = {"z3", "cvc5"}

HEAVY = {"cvc5", "jinja2", "llvmlite", "msgspec", "networkx", "numpy", "rich", "z3"}
LONGEST = 400
MAY_BE_LONGER = {"safety/prove/check.py": "one file, so that it runs where nothing else of the project is"}  # path: why

MACHINE = re.compile(r"(?<![\w.~<})-])/(?:work|root|tmp|home|opt|Users)\b|\b[A-Z]:\\Users\b")
REGISTRY = re.compile(r"\b(?:pypi\.org|pythonhosted\.org|crates\.io|npmjs\.org|proxy\.golang\.org)\b")


def files(root: Path) -> Iterator[Path]:
    """All files of the project: neither environments nor caches nor builds."""
    for path in sorted(root.iterdir()):
        if path.is_file():
            yield path
        elif path.name == ".ci" or not (path.name.startswith(".") or path.name in {"__pycache__", "build", "dist"}):
            yield from files(path)


def python_files(root: Path) -> Iterator[Path]:
    return (path for path in files(root) if path.suffix == ".py")


def imports(path: Path, root: Path) -> Iterator[tuple[int, str]]:
    """Line and absolute name of every import in a file; `from a import b` counts as `a.b`, lazy ones count too."""
    package = path.relative_to(root).parts[:-1]
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            yield from ((node.lineno, name.name) for name in node.names)
        elif isinstance(node, ast.ImportFrom):
            base = package[: len(package) + 1 - node.level] if node.level else ()
            module = (node.module,) if node.module else ()
            yield from ((node.lineno, ".".join([*base, *module, name.name])) for name in node.names)


def part(module: str) -> str:
    """The part of safety/ that a module, or a name in one, belongs to: `safety.trees.solve.Solution` -> `trees`."""
    names = module.split(".")[1:]
    return next((name for name in (".".join(names[:2]), *names[:1]) if name in MAY_IMPORT), FACADE)


def wrong_arrows(root: Path) -> list[str]:
    return [
        f"{path.relative_to(root)}:{line} imports {module}: {why}"
        for folder in OURS
        if (root / folder).is_dir()
        for path in python_files(root / folder)
        for line, module in imports(path, root)
        if (why := wrong(folder, ".".join(path.relative_to(root).with_suffix("").parts), module))
    ]


def wrong(folder: str, importer: str, module: str) -> str:
    """Why this import is not allowed, or nothing."""
    top = module.partition(".")[0]
    if top in {"safety", "models", "proofs", "tests"}:
        if top not in OURS[folder]:
            return f"{folder} may import of ours only {', '.join(sorted(OURS[folder]))}"
        if folder == top == "safety":
            here, there = part(importer), part(module)
            if here == FACADE and importer != "safety.__init__":
                return f"{importer} is a new part; enter it in MAY_IMPORT with its arrows"
            if here != there and there not in MAY_IMPORT[here]:
                return f"{here} may import only {', '.join(sorted(MAY_IMPORT[here])) or 'itself'}"
    elif folder != "safety":
        return "" if top in sys.stdlib_module_names or top == "networkx" else f"{folder} take everything from safety"
    elif top in SOLVERS and part(importer) not in {"terms", "prove"}:
        return "solvers are reached through safety.terms and safety.prove"
    elif top == "networkx" and part(importer).startswith("trees"):
        return "fault trees are solved by their own kernel"
    return ""


def test_imports_follow_the_arrows() -> None:
    assert wrong_arrows(ROOT) == []


@pytest.mark.parametrize(
    ("place", "source"),
    [
        ("safety/terms/direct.py", "from safety.model import Model"),
        ("safety/terms/direct.py", "from ..model import Model"),
        ("safety/terms/direct.py", "from safety import Model"),
        ("safety/model.py", "import safety.faults"),
        ("safety/faults.py", "def late():\n    from safety import prove"),
        ("safety/prove/claims.py", "from safety.inject import campaign"),
        ("safety/trees/solve.py", "from safety.terms.graph import Term"),
        ("safety/trees/solve.py", "from .from_model import tree_of"),
        ("safety/trees/solve.py", "from safety.prove import claims"),
        ("safety/trees/solve.py", "import networkx as nx"),
        ("safety/rates/markov.py", "from safety.trees import solve"),
        ("safety/report/html.py", "from safety.commands import main"),
        ("safety/report/html.py", "import z3"),
        ("safety/inject/space.py", "from cvc5 import pythonic"),
        ("safety/project.py", "import models.voter"),
        ("safety/commands/prove.py", "from proofs import voter"),
        ("safety/unheard_of.py", "import safety.terms"),
        ("models/voter.py", "import proofs.voter"),
        ("models/voter.py", "import z3"),
        ("proofs/voter.py", "from tests import readings"),
    ],
)
def test_a_planted_wrong_arrow_is_found(tmp_path: Path, place: str, source: str) -> None:
    planted = tmp_path / place
    planted.parent.mkdir(parents=True)
    planted.write_text(source)
    assert [found.partition(":")[0] for found in wrong_arrows(tmp_path)] == [place]


@pytest.mark.parametrize(
    ("place", "source"),
    [
        ("safety/model.py", "from safety.terms.graph import Term"),
        ("safety/prove/smt.py", "import z3\nfrom safety import faults"),
        ("safety/trees/solve.py", "from . import tree\nfrom .tree import Gate\nimport json"),
        ("safety/trees/from_model.py", "from safety.prove import cut_sets\nfrom safety.trees.tree import Gate"),
        ("safety/report/html.py", "from safety import rates\nfrom safety.trees.from_model import tree_of"),
        ("safety/commands/__init__.py", "from safety.commands import prove\nfrom safety import __version__"),
        ("safety/__init__.py", "from safety.model import Model"),
        ("models/voter.py", "from typing import NamedTuple\nfrom models.ring import Ring\nfrom safety import Model"),
        ("proofs/voter.py", "from fractions import Fraction\nfrom models.voter import Voter\nfrom safety import claim"),
    ],
)
def test_an_arrow_along_the_direction_is_free(tmp_path: Path, place: str, source: str) -> None:
    allowed = tmp_path / place
    allowed.parent.mkdir(parents=True)
    allowed.write_text(source)
    assert wrong_arrows(tmp_path) == []


START = """
import json, sys
before = set(sys.modules)
from safety.commands import main
try:
    code = main(sys.argv[1:])
except SystemExit as end:
    code = end.code
print(json.dumps([code or 0, sorted({name.partition(".")[0] for name in set(sys.modules) - before})]))
"""


def started(*words: str) -> tuple[int, set[str]]:
    """The exit code of a command, and the packages and modules that it has loaded."""
    ended = subprocess.run([sys.executable, "-c", START, *words], cwd=ROOT, capture_output=True, text=True)
    assert ended.returncode == 0, ended.stderr
    code, loaded = json.loads(ended.stdout.splitlines()[-1])
    return code, set(loaded)


def test_help_starts_without_solvers_and_numerics() -> None:
    code, loaded = started("--help")
    assert (code, HEAVY & loaded) == (0, set())


def test_a_tree_file_is_solved_by_the_standard_library_and_the_kernel_alone(tmp_path: Path) -> None:
    """And by nothing of the standard library that takes longer to import than a small tree to solve."""
    (tmp_path / "t.xml").write_text(
        '<opsa-mef><define-fault-tree name="t"><define-gate name="top"><or><basic-event name="a"/>'
        '<basic-event name="b"/></or></define-gate><define-basic-event name="a"><float value="0.1"/>'
        '</define-basic-event><define-basic-event name="b"/></define-fault-tree></opsa-mef>',
        encoding="utf-8",
    )
    code, loaded = started("tree", str(tmp_path / "t.xml"), "--json", str(tmp_path / "out.json"))
    kernel = {name for name in loaded if re.fullmatch(r"_\w+_c|_?[cC]ython\w*", name)}  # and what Cython brings along
    assert (code, loaded - sys.stdlib_module_names - kernel) == (0, {"safety"})
    if any(name.endswith("_c") for name in kernel):  # where the kernel is interpreted, Cython loads some of these
        assert not loaded & {"dataclasses", "inspect", "pathlib", "shutil", "tempfile", "typing"}


def test_no_file_is_named_like_one_of_the_scanner_that_shares_our_package_name() -> None:
    assert [path for path in files(ROOT) if path.name in {"cli.py", "errors.py"}] == []


def test_files_stay_short() -> None:
    lengths = {str(path.relative_to(ROOT)): len(path.read_text("utf-8").splitlines()) for path in python_files(ROOT)}
    assert {path for path, length in lengths.items() if length > LONGEST} == set(MAY_BE_LONGER)


def strange_places(text: str) -> list[str]:
    return [found.group() for pattern in (MACHINE, REGISTRY) for found in pattern.finditer(text)]


def test_no_text_names_a_machine_or_a_registry() -> None:
    found = {}
    for path in files(ROOT):
        try:
            found[path.relative_to(ROOT).as_posix()] = strange_places(path.read_text(encoding="utf-8"))
        except UnicodeDecodeError:
            continue  # a picture or a PDF
    assert {path: places for path, places in found.items() if places} == {}


@pytest.mark.parametrize("parts", [("", "work", "a"), ("see ", "root"), ("='", "tmp", "x'"), ("file://", "home", "a")])
def test_a_machine_path_is_found(parts: tuple[str, ...]) -> None:
    assert strange_places("/".join(parts))


def test_a_registry_is_found() -> None:
    assert strange_places("https://" + ".".join(["pypi", "org"]) + "/simple")


@pytest.mark.parametrize("text", ["<root></root>", "net/work", "./tmp/x", "and/or", "{base}/opt"])
def test_ordinary_text_is_not_taken_for_a_machine_path(text: str) -> None:
    assert strange_places(text) == []


def code_lines(node: ast.AST, source: list[str]) -> int:
    """Lines of a class or function that are neither blank nor comment nor docstring."""
    told: set[int] = set()
    for inner in ast.walk(node):
        if isinstance(inner, ast.ClassDef | ast.FunctionDef) and ast.get_docstring(inner):
            told |= set(range(inner.body[0].lineno, (inner.body[0].end_lineno or 0) + 1))
    lines = [source[n - 1].strip() for n in range(node.lineno, node.end_lineno + 1) if n not in told]
    return sum(1 for line in lines if line and not line.startswith("#"))


@pytest.mark.parametrize(("folder", "kind", "most"), [("models", ast.ClassDef, 24), ("proofs", ast.FunctionDef, 14)])
def test_a_part_of_a_model_and_a_claim_are_read_at_a_glance(folder: str, kind: type, most: int) -> None:
    long = []
    for path in python_files(ROOT / folder):
        text = path.read_text(encoding="utf-8")
        for node in ast.parse(text).body:
            if isinstance(node, kind) and (kind is ast.ClassDef or node.decorator_list):
                first = min([node.lineno, *(d.lineno for d in node.decorator_list)])
                size = code_lines(node, text.splitlines()) + node.lineno - first
                long += [f"{path.relative_to(ROOT)} {node.name}: {size}"] if size > most else []
    assert long == []
