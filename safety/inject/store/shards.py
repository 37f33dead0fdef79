"""A shard: what became of the injections `lo` to `hi`, as one file that is never changed.

    rightside-shard 1 <SHA-256 of all that follows>\\n
    {"campaign": ..., "key": ..., "lo": ..., "hi": ..., "of": ..., "histogram": ..., "digest": ..., ...}\\n
    cells, detectors, latencies

Cells stand in the order of enumeration, so the injections' numbers need not be written; detectors are sorted by cell,
latencies by cell and detector, kept in order within these.  Latencies are written plainly or as differences, whichever
is shorter.  Each is transposed to planes of bytes and deflated.  The same answers make the same bytes; `digest` is over
the answers themselves, so it does not depend on who deflated them.
"""

from __future__ import annotations

import hashlib
import json
import zlib
from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from safety.inject.classes import CELLS
from safety.inject.space import CampaignError

if TYPE_CHECKING:
    import numpy as np
    import numpy.typing as npt

    from safety.inject.judging import Judged

    Words = npt.NDArray[np.uint32]

MAGIC = "rightside-shard 1"
LEVEL = 6  # of deflate: higher ones take twice the time for 1 % less
UNDETECTED = CELLS.index("wrong/no")
KINDS = 1 << 16  # pairs of cell and detector
PLAIN, DIFFERENCES = "plain", "differences"


class StoreError(CampaignError):
    """The store cannot do what is asked; the message says what is kept, and what to do."""


class DamagedError(Exception):
    """A file is not the shard that was written."""


@dataclass(frozen=True)
class Header:
    """What a shard is about: the campaign's id and key, its range of how many injections, what these came to."""

    campaign: str
    key: str
    lo: int
    hi: int
    of: int
    histogram: Mapping[tuple[int, int], int]  # (cell, detector): injections
    digest: str  # of the answers

    @property
    def undetected(self) -> int:
        """How many are dangerous and undetected."""
        return sum(number for (cell, _), number in self.histogram.items() if cell == UNDETECTED)

    @property
    def name(self) -> str:
        """Name of the file; names in order are ranges in order."""
        return f"{self.lo:012d}-{self.hi:012d}.shard"


def encode(campaign: str, key: str, lo: int, of: int, judged: Judged) -> tuple[Header, bytes]:
    """The file for the answers to the injections from `lo` on, out of so many."""
    import numpy as np

    kinds = _kinds(judged.cells, judged.detector)
    counts = np.bincount(kinds, minlength=KINDS)
    histogram = {(int(kind) >> 8, int(kind) & 255): int(counts[kind]) for kind in np.flatnonzero(counts)}
    header = Header(campaign, key, lo, lo + len(kinds), of, histogram, _digest(judged))
    latency = judged.latency[_order(kinds)]
    ways = {PLAIN: _deflated(latency), DIFFERENCES: _deflated(_differences(latency))}
    way = min(ways, key=lambda name: len(ways[name]))
    planes = [_deflated(judged.cells), _deflated(judged.detector[_order(judged.cells)]), ways[way]]
    told = {
        "campaign": campaign,
        "key": key,
        "lo": header.lo,
        "hi": header.hi,
        "of": of,
        "histogram": [[cell, detector, number] for (cell, detector), number in histogram.items()],
        "digest": header.digest,
        "latency": way,
        "sizes": [len(plane) for plane in planes],
    }
    body = json.dumps(told, separators=(",", ":")).encode() + b"\n" + b"".join(planes)
    return header, f"{MAGIC} {hashlib.sha256(body).hexdigest()}\n".encode() + body


def decode(data: bytes) -> tuple[Header, Judged]:
    """A shard's header and answers.  Raises `DamagedError` when a bit of the file has changed."""
    import numpy as np

    from safety.inject.judging import Judged

    header, told, payload = _opened(data)
    count = header.hi - header.lo
    ends = np.cumsum(told["sizes"])
    cells, detector, latency = (payload[end - size : end] for end, size in zip(ends, told["sizes"], strict=True))
    judged = Judged(_inflated(cells, "u1"), np.empty(count, np.uint8), np.empty(count, np.uint32))
    judged.detector[_order(judged.cells)] = _inflated(detector, "u1")
    words = _inflated(latency, "<u4")
    order = _order(_kinds(judged.cells, judged.detector))
    judged.latency[order] = words if told["latency"] == PLAIN else _summed(words)
    if _digest(judged) != header.digest:
        raise DamagedError("its answers are not those that were written")
    return header, judged


def head(data: bytes) -> Header:
    """A shard's header alone.  Raises `DamagedError` when a bit of the file, its answers included, has changed."""
    return _opened(data)[0]


def _opened(data: bytes) -> tuple[Header, Any, memoryview]:
    first, _, _ = data[:256].partition(b"\n")
    body = memoryview(data)[len(first) + 1 :]
    if first.decode(errors="replace") != f"{MAGIC} {hashlib.sha256(body).hexdigest()}":
        raise DamagedError("its checksum is wrong")
    line, _, _ = bytes(body[: 1 << 20]).partition(b"\n")
    told = json.loads(line)
    histogram = {(cell, detector): number for cell, detector, number in told["histogram"]}
    header = Header(told["campaign"], told["key"], told["lo"], told["hi"], told["of"], histogram, told["digest"])
    return header, told, body[len(line) + 1 :]


def _digest(judged: Judged) -> str:
    """SHA-256 over the answers, whatever they were packed with."""
    sum_ = hashlib.sha256()
    for plane, kind in ((judged.cells, "u1"), (judged.detector, "u1"), (judged.latency, "<u4")):
        sum_.update(plane.astype(kind, copy=False).tobytes())
    return sum_.hexdigest()


def _kinds(cells: npt.NDArray[Any], detector: npt.NDArray[Any]) -> npt.NDArray[Any]:
    """What each injection came to, as one number."""
    kinds: npt.NDArray[Any] = (cells.astype("u2") << 8) | detector
    return kinds


def _order(kinds: npt.NDArray[Any]) -> npt.NDArray[Any]:
    """Where the injections stand when sorted by kind, each kind in order."""
    order: npt.NDArray[Any] = kinds.argsort(kind="stable")
    return order


def _deflated(plane: npt.NDArray[Any]) -> bytes:
    """Bytes of equal weight side by side, which deflate packs better."""
    import numpy as np

    width = plane.dtype.itemsize
    raw = plane.astype(plane.dtype.newbyteorder("<")).view(np.uint8).reshape(-1, width)
    return zlib.compress(raw.T.tobytes(), LEVEL)


def _inflated(data: memoryview, kind: str) -> npt.NDArray[Any]:
    import numpy as np

    planes = np.frombuffer(zlib.decompress(data), np.uint8).reshape(np.dtype(kind).itemsize, -1)
    words: npt.NDArray[Any] = planes.T.copy().view(kind).reshape(-1)
    return words


def _differences(words: Words) -> Words:
    """Each less the one before, small ones of either sign as small numbers (0, -1, 1, -2 ... as 0, 1, 2, 3 ...)."""
    import numpy as np

    steps = np.diff(words, prepend=np.uint32(0)).view(np.int32)
    return ((steps << 1) ^ (steps >> 31)).view(np.uint32)


def _summed(words: Words) -> Words:
    import numpy as np

    steps = (words >> np.uint32(1)) ^ (-(words & np.uint32(1)).view(np.int32)).view(np.uint32)
    return np.cumsum(steps, dtype=np.uint32)
