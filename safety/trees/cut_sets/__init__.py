"""Minimal cut sets and prime implicants one by one, and trees of which only some can be had."""
