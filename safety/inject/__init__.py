"""Fault-injection campaigns: which faults, under what stimulus, how each run is judged, and what follows from it."""

from safety.inject.campaign import Campaign, Wires, campaigns
from safety.inject.classes import CLASSES, Counts, Runs, Tally
from safety.inject.fmeda import Row, write_csv
from safety.inject.result import Result
from safety.inject.running import Replay
from safety.inject.space import CampaignError, Faults, Group, Injection, each_bit, stuck_bits, upsets
from safety.inject.statistics import Share, clopper_pearson, runs_without_failure

__all__ = [
    "CLASSES", "Campaign", "CampaignError", "Counts", "Faults", "Group", "Injection", "Replay", "Result", "Row", "Runs",
    "Share", "Tally", "Wires", "campaigns", "clopper_pearson", "each_bit", "runs_without_failure", "stuck_bits",
    "upsets", "write_csv",
]  # fmt: skip
