"""Claims and their verdicts: induction over lemmas, bounded search, replay, refinement, minimal cut sets."""
