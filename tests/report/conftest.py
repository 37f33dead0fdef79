"""The sample: a results document as a project of some size makes it, with every verdict and every kind of open end."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from safety.report.results import load


@pytest.fixture
def sample() -> dict[str, Any]:
    return load(Path(__file__).with_name("sample.json"))
