"""What README and docs say is so: code stands where it is said to stand, links lead somewhere, commands exist."""

import inspect
import re
from pathlib import Path

import pytest

import safety
from safety.commands import main

ROOT = Path(__file__).resolve().parent.parent
DOCUMENTS = [ROOT / "README.md", *sorted((ROOT / "docs").glob("*.md"))]
README = (ROOT / "README.md").read_text(encoding="utf-8")


def test_code_in_the_readme_stands_in_the_project() -> None:
    files = [path for folder in ("models", "proofs") for path in (ROOT / folder).rglob("*.py")]
    sources = [path.read_text(encoding="utf-8") for path in files]
    blocks = re.findall(r"```python\n(.*?)```", README, re.DOTALL)
    assert len(blocks) == 2
    for block in blocks:
        assert any(block in source for source in sources), f"nowhere in models/ or proofs/:\n{block}"


@pytest.mark.parametrize("document", DOCUMENTS, ids=lambda path: path.name)
def test_links_lead_somewhere(document: Path) -> None:
    targets = [t for t in re.findall(r"\]\(([^)#]+)\)", document.read_text(encoding="utf-8")) if "://" not in t]
    assert [t for t in targets if not (document.parent / t).exists()] == []


@pytest.mark.parametrize("document", DOCUMENTS, ids=lambda path: path.name)
def test_commands_exist(document: Path, capsys: pytest.CaptureFixture[str]) -> None:
    for verb in sorted(set(re.findall(r"`rightside ([a-z]+)", document.read_text(encoding="utf-8")))):
        if verb == "init" and document.name == "decisions.md":
            continue  # said there to be what the wheel's scaffold is for
        assert main([verb, "--help"]) == 0
        assert "examples:" in capsys.readouterr().out


def test_arguments_of_claim_are_all_described() -> None:
    using = (ROOT / "docs" / "using.md").read_text(encoding="utf-8")
    parameters = set(inspect.signature(safety.claim).parameters) - {"model"}
    described = {p for p in parameters if f"`{p}" in using or f"{p}=" in using}
    assert parameters - described == set()


def test_public_names_are_all_there() -> None:
    assert [name for name in safety.__all__ if not hasattr(safety, name)] == []
