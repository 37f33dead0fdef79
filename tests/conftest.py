"""What all tests share: hypothesis without a clock and with the same examples in every run; an empty result cache."""

from pathlib import Path

import pytest
from hypothesis import settings

from safety.prove.cache import Cache

settings.register_profile("pinned", deadline=None, derandomize=True)
settings.load_profile("pinned")


@pytest.fixture
def said() -> list[str]:
    """What the cache warned of."""
    return []


@pytest.fixture
def cache(tmp_path: Path, said: list[str]) -> Cache:
    """A cache without records."""
    return Cache(tmp_path / "cache", said.append)
