"""Lemma synthesis: inductive invariants of counters, accumulators, pulses and timers, found without a hint.

    sampled steps -> conserved forms (exact integer null space) -> guarded bounds -> pruned to an inductive set

What comes out is a set of lemmas like any that a user writes: nothing rests on how it was found, each is proved by two
solvers afterwards (`safety.prove.induction`).
"""
