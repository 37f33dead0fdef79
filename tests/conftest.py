"""What all tests share: hypothesis without a clock and with the same examples in every run; an empty result cache.

What is made while tests are collected stays to the end: the garbage collector does not look through it again.

No test, and no file of tests, leaves models, proofs or declarations behind for the next one.
"""

import compileall
import functools
import gc
import os
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest
from hypothesis import settings

from safety.prove.cache import Cache
from safety.terms import llvm
from tests.apart import kept

ROOT = Path(__file__).resolve().parents[1]
IMPORTED = "safety", "models", "proofs"  # by processes that tests start
GARBAGE = 20_000, 20, 20  # objects and younger collections that a collection waits for
settings.register_profile("pinned", deadline=None, derandomize=True)
settings.load_profile("pinned")


def pytest_configure(config: pytest.Config) -> None:
    """A process that finds no bytecode compiles for as long as it then works, and may not keep what it compiled."""
    if not hasattr(config, "workerinput"):  # once, before the workers of a parallel run start
        for folder in IMPORTED:
            compileall.compile_dir(ROOT / folder, quiet=2)


@pytest.hookimpl(wrapper=True)
def pytest_collection() -> Iterator[object]:
    gc.disable()
    try:
        return (yield)
    finally:
        gc.enable()
        gc.freeze()
        gc.set_threshold(*GARBAGE)
        # Tests rewrite files of projects within a second and in the same size, which bytecode would not notice.
        sys.dont_write_bytecode = True
        os.environ["PYTHONDONTWRITEBYTECODE"] = "1"


@pytest.fixture(scope="session", autouse=True)
def compiled_once() -> Iterator[None]:
    """Many tests run the same text of LLVM on the same processor: its machine code is made once."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(llvm, "_object", functools.cache(llvm._object))
        yield


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
