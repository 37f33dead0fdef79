"""What was compiled is kept for the user alone, and taken only if it is whole; without a folder all still runs."""

import ctypes
import os
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from safety.terms import llvm
from safety.terms.llvm import PLAIN, Library, Target, host

TEXT = "define void @put(ptr %%place) {\n  store i64 %d, ptr %%place\n  ret void\n}\n"


@pytest.fixture
def compiled(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> list[str]:
    """The texts that were compiled, not taken from the folder."""
    texts: list[str] = []
    inner = llvm._object

    def noted(target: Target, text: str) -> bytes:
        texts.append(text)
        return inner(target, text)

    monkeypatch.setattr(llvm, "_object", noted)
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    return texts


def result(number: int = 7, **how: Any) -> int:
    """What a function compiled now gives."""
    place = ctypes.c_int64()
    library = Library(TEXT % number, how.get("target", host()), keep=True)
    library.function("put", ctypes.c_void_p)(ctypes.addressof(place))
    return place.value


def kept(tmp_path: Path) -> list[Path]:
    return sorted((tmp_path / "rightside" / "native").iterdir())


def test_it_is_compiled_once(compiled: list[str], tmp_path: Path) -> None:
    assert (result(), result(), len(compiled)) == (7, 7, 1)
    assert (tmp_path / "rightside" / "native").stat().st_mode & 0o777 == 0o700


def test_another_text_or_processor_is_another_entry(compiled: list[str], tmp_path: Path) -> None:
    assert (result(7), result(8), result(7, target=PLAIN)) == (7, 8, 7)
    assert (len(compiled), len(kept(tmp_path))) == (3, 3)


def test_without_keep_nothing_is_kept(compiled: list[str], tmp_path: Path) -> None:
    Library(TEXT % 7, host())
    assert not (tmp_path / "rightside").exists()


DAMAGE: dict[str, Callable[[bytes], bytes]] = {
    "a bit of the code": lambda whole: whole[:200] + bytes([whole[200] ^ 1]) + whole[201:],
    "a bit of the digest": lambda whole: bytes([whole[0] ^ 1]) + whole[1:],
    "cut short": lambda whole: whole[:-1],
    "empty": lambda whole: b"",
    "code of another": lambda whole: whole[:32] + b"other" + whole[32:],
}


@pytest.mark.parametrize("damage", DAMAGE)
def test_a_damaged_entry_is_compiled_anew(compiled: list[str], tmp_path: Path, damage: str) -> None:
    result()
    (entry,) = kept(tmp_path)
    whole = entry.read_bytes()
    entry.write_bytes(DAMAGE[damage](whole))
    assert (result(), len(compiled)) == (7, 2)
    assert entry.read_bytes() == whole


@pytest.mark.parametrize("mode", [0o770, 0o707, 0o777])
def test_a_folder_that_others_can_write_is_left_alone(compiled: list[str], tmp_path: Path, mode: int) -> None:
    result()
    folder = tmp_path / "rightside" / "native"
    folder.chmod(mode)
    assert (result(), len(compiled)) == (7, 2)
    folder.chmod(0o700)


def test_a_folder_of_another_user_is_left_alone(compiled: list[str], monkeypatch: pytest.MonkeyPatch) -> None:
    result()
    monkeypatch.setattr(os, "getuid", lambda: -5)
    assert (result(), len(compiled)) == (7, 2)


def test_a_link_is_no_folder(compiled: list[str], tmp_path: Path) -> None:
    (tmp_path / "elsewhere").mkdir()
    (tmp_path / "rightside").mkdir()
    (tmp_path / "rightside" / "native").symlink_to(tmp_path / "elsewhere")
    assert (result(), list((tmp_path / "elsewhere").iterdir())) == (7, [])


def test_a_file_in_the_folder_s_place_costs_time_only(compiled: list[str], tmp_path: Path) -> None:
    (tmp_path / "rightside").write_text("a file")
    assert (result(), result(), len(compiled)) == (7, 7, 2)


def test_a_full_disk_costs_time_only(compiled: list[str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def full(self: Path, data: bytes) -> int:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(Path, "write_bytes", full)
    assert (result(), result(), len(compiled), kept(tmp_path)) == (7, 7, 2, [])


def test_the_oldest_entries_give_way(compiled: list[str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(llvm, "MOST_KEPT", 2)
    for number in (1, 2, 3):
        result(number)
        os.utime(max(kept(tmp_path), key=lambda file: file.stat().st_mtime), (number, number))
    assert len(kept(tmp_path)) == 2
    result(3)
    assert len(compiled) == 3
