"""What all tests share: hypothesis without a clock, and with the same examples in every run."""

from hypothesis import settings

settings.register_profile("pinned", deadline=None, derandomize=True)
settings.load_profile("pinned")
