"""Campaigns split over machines: their stores put together are the campaign, and what does not fit is refused."""

from __future__ import annotations

import shutil
import sys
from pathlib import Path
from typing import Any

import pytest

from safety.commands.declared import Declared
from safety.inject.store import Part, Store, Stored, StoreError, export_parquet, merge, open_executor, run_sharded
from safety.inject.store.shards import decode, encode
from tests.inject import timer_project as timer


@pytest.fixture(scope="module")
def root(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return timer.write(tmp_path_factory.mktemp("merged"))


@pytest.fixture(scope="module")
def machines(root: Path) -> list[Path]:
    """The stores of three machines that took every third shard each."""
    find = Declared(str(root), "timer")
    for number in (1, 2, 3):
        with open_executor("serial") as executor:
            store = Store(root / f"machine{number}")
            run_sharded(find(), find, store, executor, part=Part(number, 3), size=timer.SIZE)
    return [root / f"machine{number}" for number in (1, 2, 3)]


@pytest.fixture(scope="module")
def whole(root: Path) -> Stored:
    return timer.whole(root, root / "whole")


def merged(stored: Stored, folders: list[Path], into: Path, said: Any = print) -> Stored:
    return merge(stored.campaign, folders, Store(into, said))


def test_stores_together_are_the_campaign(machines: list[Path], whole: Stored, tmp_path: Path) -> None:
    stored = merged(whole, machines, tmp_path)
    assert (stored.complete, stored.digest) == (True, whole.digest)
    assert timer.files(stored.folder) == timer.files(whole.folder)
    assert stored.undetected() == whole.undetected()
    assert merged(whole, [*machines, tmp_path], tmp_path).digest == whole.digest, "the same answers twice do no harm"


def test_a_folder_of_shards_will_do(machines: list[Path], whole: Stored, tmp_path: Path) -> None:
    folders = [next(path for path in machine.iterdir() if path.is_dir()) for machine in machines]
    assert merged(whole, folders, tmp_path).complete


def test_what_is_missing_is_told(machines: list[Path], whole: Stored, tmp_path: Path) -> None:
    said: list[str] = []
    stored = merged(whole, machines[:2], tmp_path, said.append)
    assert said == [
        "timer: 320 of 1040 injections are missing: 80 to 119, 200 to 239, 320 to 359, 440 to 479, 560 to 599, ..."
    ]
    assert stored.missing == [range(lo, lo + 40) for lo in range(80, 1040, 120)]
    assert not stored.complete and stored.result().interrupted


def test_a_damaged_shard_is_left_out_and_left_there(machines: list[Path], whole: Stored, tmp_path: Path) -> None:
    shutil.copytree(machines[0], tmp_path / "copy")
    path = min((tmp_path / "copy").glob("*/*.shard"))
    path.write_bytes(path.read_bytes()[:-1])
    said: list[str] = []
    stored = merged(whole, [tmp_path / "copy", *machines[1:]], tmp_path / "store", said.append)
    assert stored.missing == [range(40)] and path.exists()
    assert said == [
        f"{path} is damaged: its checksum is wrong; it has to be made again",
        "timer: 40 of 1040 injections are missing: 0 to 39",
    ]


def test_a_store_without_the_campaign_is_told(whole: Stored, tmp_path: Path) -> None:
    other = timer.write(tmp_path / "other")
    (other / "models" / "timer.py").write_text(timer.MODEL.replace("total >= 8", "total >= 9"))
    timer.whole(other, tmp_path / "others")
    said: list[str] = []
    with pytest.raises(StoreError, match="no shard of timer is there to merge"):
        merged(whole, [tmp_path / "others"], tmp_path / "store", said.append)
    assert said == [f"{tmp_path / 'others'} holds no shard of timer as it stands (key {whole.key[:12]})"]
    folder = next(path for path in (tmp_path / "others").iterdir() if path.is_dir())
    with pytest.raises(StoreError, match="is of another campaign"):
        merged(whole, [folder], tmp_path / "store")
    with pytest.raises(StoreError, match="no such folder"):
        merged(whole, [tmp_path / "absent"], tmp_path / "store")


def test_ranges_that_overlap_or_disagree_are_refused(
    machines: list[Path], whole: Stored, root: Path, tmp_path: Path
) -> None:
    find = Declared(str(root), "timer")
    with open_executor("serial") as executor:
        run_sharded(find(), find, Store(tmp_path / "wider"), executor, part=Part(1, 2), size=64)
    with pytest.raises(StoreError, match=r"overlaps the injections .* cut with another size"):
        merged(whole, [machines[0], tmp_path / "wider"], tmp_path / "a")

    shutil.copytree(machines[0], tmp_path / "liar")
    path = sorted((tmp_path / "liar").glob("*/*.shard"))[1]
    header, judged = decode(path.read_bytes())
    judged.latency[7] ^= 1
    path.write_bytes(encode(header.campaign, header.key, header.lo, header.of, judged)[1])
    with pytest.raises(StoreError, match=f"injections {header.lo} to {header.hi - 1} came to something else"):
        merged(whole, [machines[0], tmp_path / "liar"], tmp_path / "b")


# --- Parquet ---------------------------------------------------------------------------------------------------------


def test_parquet_holds_a_row_an_injection(whole: Stored, tmp_path: Path) -> None:
    duckdb = pytest.importorskip("duckdb", reason="DuckDB is not installed: pip install rightside[analysis]")
    pytest.importorskip("pyarrow", reason="pyarrow is not installed: pip install rightside[analysis]")
    path = tmp_path / "timer.parquet"
    export_parquet(whole, path)
    rows = duckdb.sql(f"SELECT * FROM '{path}'").fetchall()
    judged = whole.result().judged
    assert [row[0] for row in rows] == list(range(1040))
    assert [row[2] for row in rows if row[1] == "dangerous_undetected"] == ["wrong/no"] * 227
    assert [row[0] for row in rows if row[3] == "stands"] == (judged.detector == 0).nonzero()[0].tolist()
    assert {row[4] for row in rows if row[3] is None} == {None}
    latencies = duckdb.sql(f"SELECT sum(latency) FROM '{path}' WHERE detector IS NOT NULL").fetchall()
    assert latencies == [(int(judged.latency[judged.detector == 0].sum()),)]


def test_a_parquet_file_that_cannot_be_written_is_told(whole: Stored, tmp_path: Path) -> None:
    pytest.importorskip("pyarrow", reason="pyarrow is not installed: pip install rightside[analysis]")
    with pytest.raises(StoreError, match="give another file"):
        export_parquet(whole, tmp_path / "absent" / "timer.parquet")


def test_without_pyarrow_the_error_names_the_extra(
    whole: Stored, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(sys.modules, "pyarrow", None)
    with pytest.raises(StoreError, match=r"pip install rightside\[analysis\]"):
        export_parquet(whole, tmp_path / "timer.parquet")
