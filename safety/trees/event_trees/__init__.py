"""Event trees: what may follow an initiating event, and how likely each sequence is."""
