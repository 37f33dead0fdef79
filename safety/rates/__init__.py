"""Failure rates, Markov chains, two-out-of-three equipment and wrong-side failure, each figure by two routes.

Stands alone: no model is needed. In reading order: `units` (what is put in), `markov` (exact), `numeric` and
`exponential` (certified bounds), `two_out_of_three` and `wrong_side` (equipment), `inverse` (which rate meets a
target), `claims` (statements for the report).
"""
