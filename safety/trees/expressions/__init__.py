"""What the probability of a basic event follows from: expressions, laws of lifetimes, distributions, readings."""
