"""Campaigns kept on disk as they run: in shards that survive whatever is killed, on one machine or on many."""

from safety.inject.store.executors import open_executor
from safety.inject.store.keys import campaign_key
from safety.inject.store.parquet import export_parquet
from safety.inject.store.running import Part, merge, run_sharded
from safety.inject.store.shards import StoreError
from safety.inject.store.store import FOLDER, Store, Stored

__all__ = [
    "FOLDER", "Part", "Store", "StoreError", "Stored", "campaign_key", "export_parquet", "merge", "open_executor",
    "run_sharded",
]  # fmt: skip
