"""A campaign's answers as a Parquet file, for questions in SQL or by other tools; needs the extra `analysis`.

    index     number of the injection, in the order of enumeration
    class     safe, detected, dangerous_undetected or no_effect
    cell      direction and whether it is detected, e.g. wrong/no
    detector  what detected it first; null where nothing did, or the campaign names no detectors
    latency   frames from the onset until then, or null

What became of 10^8 injections, in a second or so:

    import duckdb
    duckdb.sql("SELECT class, detector, count(*), median(latency) FROM 'campaign.parquet' GROUP BY ALL ORDER BY ALL")
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

from safety.inject.classes import CELLS, class_of
from safety.inject.judging import NO_LATENCY, UNDETECTED
from safety.inject.store.shards import StoreError
from safety.inject.store.store import Stored, told

PACKING: dict[str, Any] = {
    "compression": "zstd",
    "use_dictionary": ["class", "cell", "detector"],
    "column_encoding": {"index": "DELTA_BINARY_PACKED", "latency": "BYTE_STREAM_SPLIT"},
}


def export_parquet(stored: Stored, path: Path) -> None:
    """Write what is there of a campaign, a row an injection.

    Raises `StoreError` when pyarrow is missing or the file cannot be written.
    """
    try:
        import pyarrow as arrow
        from pyarrow import parquet
    except ImportError:
        raise StoreError(f"{path}: pyarrow is not installed; pip install rightside[analysis]") from None
    import numpy as np

    words = arrow.dictionary(arrow.uint8(), arrow.string())
    columns = {"index": arrow.int64(), "class": words, "cell": words, "detector": words, "latency": arrow.uint32()}
    classes, detectors = [class_of(cell) for cell in CELLS], list(stored.campaign.detectors)
    with told(path, "give another file"), parquet.ParquetWriter(path, arrow.schema(columns), **PACKING) as writer:
        for lo, judged in stored.parts():
            none = judged.detector == UNDETECTED
            table = {
                "index": arrow.array(np.arange(lo, lo + len(judged))),
                "class": arrow.DictionaryArray.from_arrays(judged.cells, classes),
                "cell": arrow.DictionaryArray.from_arrays(judged.cells, list(CELLS)),
                "detector": arrow.DictionaryArray.from_arrays(arrow.array(judged.detector, mask=none), detectors),
                "latency": arrow.array(judged.latency, mask=judged.latency == NO_LATENCY),
            }
            writer.write_table(arrow.table(table, schema=arrow.schema(columns)))
