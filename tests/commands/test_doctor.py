"""What `rightside doctor` finds, and what it finds missing."""

import json
from importlib import metadata
from pathlib import Path

import pytest

from safety.commands import main


def found(capsys: pytest.CaptureFixture[str]) -> tuple[int, dict[str, dict[str, str]]]:
    """The exit code and the findings by name."""
    code = main(["doctor", "--json", "-"])
    document = json.loads(capsys.readouterr().out)
    assert document["schema"] == "rightside/doctor/1"
    return code, {line["name"]: line for line in document["found"]}


def test_what_is_there_has_a_version(capsys: pytest.CaptureFixture[str]) -> None:
    code, lines = found(capsys)
    assert code == 0
    for name in "z3-solver", "cvc5", "numpy":
        assert lines[name] == {"what": "package", "name": name, "state": metadata.version(name), "remedy": ""}
    assert lines["spacer"] == {"what": "engine", "name": "spacer", "state": "ready", "remedy": ""}


def test_missing_programs_are_no_fault_and_have_a_remedy(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.setenv("PATH", str(tmp_path))
    code, lines = found(capsys)
    assert code == 0
    for name, package in ("pdr", "berkeley-abc"), ("smtbmc", "yosys"), ("yosys", "yosys"), ("cadical", "cadical"):
        assert lines[name]["state"] == "missing" and f"apt install {package}" in lines[name]["remedy"]


def test_a_second_owner_of_the_package_is_named(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(metadata, "packages_distributions", lambda: {"safety": ["rightside", "safety", "safety"]})
    code, lines = found(capsys)
    assert code == 2
    assert lines["safety"]["state"] == "wrong" and lines["safety"]["remedy"].endswith("pip uninstall safety")


def test_a_missing_package_is_named(capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch) -> None:
    usual = metadata.version

    def without_cvc5(name: str) -> str:
        if name == "cvc5":
            raise metadata.PackageNotFoundError(name)
        return usual(name)

    monkeypatch.setattr(metadata, "version", without_cvc5)
    code, lines = found(capsys)
    assert code == 2
    assert lines["cvc5"]["state"] == "missing" and "pip install 'cvc5" in lines["cvc5"]["remedy"]


def test_it_is_a_table_for_people(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["doctor"]) == 0
    shown = capsys.readouterr().out
    assert shown.startswith("what") and "\nengine   spacer" in shown.replace("engine     ", "engine   ")
