"""The committed seeds.  Others are drawn by `python tests/generated/run.py --seeds 100:120`."""

SEEDS = range(20)  # of each family: 400 models, 800 cases
QUICK = range(2)  # what the default suite explores
SHORT = ("gray", "queue", "vote")  # what the default suite also proves and refutes, with little time for each
