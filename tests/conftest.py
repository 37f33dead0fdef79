"""What all tests share: hypothesis without a clock and with the same examples in every run; an empty result cache.

No test, and no file of tests, leaves models, proofs or declarations behind for the next one.
"""

import os
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest
from hypothesis import settings

from safety.prove.cache import Cache
from tests.apart import kept

# Tests rewrite files of projects within a second and in the same size, which compiled bytecode would not notice.
sys.dont_write_bytecode = True
os.environ["PYTHONDONTWRITEBYTECODE"] = "1"

settings.register_profile("pinned", deadline=None, derandomize=True)
settings.load_profile("pinned")


@pytest.fixture(scope="module", autouse=True)
def declarations_of_a_file() -> Iterator[None]:
    """Those of fixtures that a file's tests share."""
    with kept():
        yield


@pytest.fixture(autouse=True)
def declarations_of_a_test() -> Iterator[None]:
    with kept():
        yield


@pytest.fixture
def said() -> list[str]:
    """What the cache warned of."""
    return []


@pytest.fixture
def cache(tmp_path: Path, said: list[str]) -> Cache:
    """A cache without records."""
    return Cache(tmp_path / "cache", said.append)
