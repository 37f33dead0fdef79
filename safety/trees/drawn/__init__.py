"""Fault trees drawn from minimal cut sets, as an engineer would draw them."""
