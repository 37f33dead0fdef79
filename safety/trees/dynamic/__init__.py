"""Dynamic fault trees: gates to which order and spares matter, solved in parts by Markov chain and decision diagram."""
