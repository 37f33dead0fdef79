"""Where the data lie that nobody here wrote: $RIGHTSIDE_ORACLES, else ../shared/oracles beside the project."""

from __future__ import annotations

import os
from pathlib import Path

SHARED = Path(os.environ.get("RIGHTSIDE_ORACLES") or Path(__file__).resolve().parents[2] / "shared" / "oracles")
