"""Proof engines behind one interface, run as a portfolio: the first conclusive answer ends the others.

An engine takes a `Problem` and a `Budget` and gives a `Result`; `engine.NAMES` lists them, a file an engine.  Each runs
in a process of its own with a cap on time and memory (`portfolio`), so that none of them can take the others down.

What an engine says is worth what can be checked of it.  A counterexample is replayed on the Python reading before it
is called one.  An inductive invariant is put to z3 and cvc5 like any user lemma, and `agreed_by` then names them; a
"proved" without such an invariant rests on the engine alone, and `agreed_by` and `why` say so.
"""
