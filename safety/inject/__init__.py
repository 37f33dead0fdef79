"""Fault-injection campaigns: which faults, under what stimulus, how each run is judged, and what follows from it."""

from safety.inject.campaign import Campaign, campaigns
from safety.inject.classes import CLASSES, Counts, Runs, Tally
from safety.inject.fmeda import Row, write_csv
from safety.inject.judging import Judged
from safety.inject.listing import each_bit, flipped_bits, stuck_bits, upsets
from safety.inject.monitors import Wires
from safety.inject.result import Result
from safety.inject.running import Replay
from safety.inject.space import CampaignError, Faults, Group, Injection
from safety.inject.statistics import Share, clopper_pearson, runs_without_failure
from safety.inject.variants import Choice, Uniform

__all__ = [
    "CLASSES", "Campaign", "CampaignError", "Choice", "Counts", "Faults", "Group", "Injection", "Judged", "Replay",
    "Result", "Row", "Runs", "Share", "Tally", "Uniform", "Wires", "campaigns", "clopper_pearson", "each_bit",
    "flipped_bits", "runs_without_failure", "stuck_bits", "upsets", "write_csv",
]  # fmt: skip
