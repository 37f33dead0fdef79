"""Fractions of what was injected, with bounds that hold as often as they say, and with a check of when to stop.

| drawn                              | bounds                                                             |
|------------------------------------|--------------------------------------------------------------------|
| everything                         | none needed: `Share.known`                                         |
| independently                      | `clopper_pearson`                                                  |
| from a population of known size    | `hypergeometric_limits`                                            |
| from a population of unknown size  | `any_population`                                                   |
| by strata                          | `total`, `weighted`                                                |
| under scenarios that are drawn     | `clustered`, `clustered_ratio`                                     |
| until sure                         | `anytime`, `anytime_limits`, `StopWhenSure`                        |

All are rounded outward, and their coverage is at least the stated confidence, not about it.
"""

from safety.inject.statistics.binomial import any_population, clopper_pearson, runs_without_failure
from safety.inject.statistics.clusters import clustered, clustered_ratio
from safety.inject.statistics.hypergeometric import hypergeometric_limits
from safety.inject.statistics.sequences import StopWhenSure, anytime, anytime_limits
from safety.inject.statistics.shares import Share, bounds, share
from safety.inject.statistics.stratified import Stratum, Trials, total, weighted

__all__ = [
    "Share", "StopWhenSure", "Stratum", "Trials", "any_population", "anytime", "anytime_limits", "bounds",
    "clopper_pearson", "clustered", "clustered_ratio", "hypergeometric_limits", "runs_without_failure", "share",
    "total", "weighted",
]  # fmt: skip
