"""Importance of basic events, of gates, and of events together."""
