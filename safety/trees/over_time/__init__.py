"""A fault tree over its mission: curves, averages, mean time to failure, safety integrity levels."""
