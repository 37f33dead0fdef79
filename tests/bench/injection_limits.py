"""What a processor can do in vectors, and how many vector instructions a compiled step has."""

from __future__ import annotations

import ctypes
import re
import subprocess
import tempfile
import time
from pathlib import Path

CHAINS, ROUNDS = 12, 20_000_000
ADDS = """
#include <stdint.h>
typedef uint8_t v8 __attribute__((vector_size(@WIDTH@)));
extern "C" int adds(long rounds) {
  v8 @START@;
  for (long r = 0; r < rounds; r++) { @ADD@ }
  return (@SUM@)[0];
}
"""
VECTOR = re.compile(r"\s(v\w+|k(?:and|or|xor|not|mov|unpck|shift|test|add)\w*)\s")
MOVED = re.compile(r"\s(vmov\w+|kmov\w+|vpbroadcast\w+|vzero\w+)\s")


def most_adds(compiler: str, width: int = 64) -> float:
    """Additions of vectors of bytes (`width` of them) that one core makes in a second: independent, in registers."""
    with tempfile.TemporaryDirectory() as folder:
        source, library = Path(folder) / "adds.cpp", Path(folder) / "adds.so"
        marked = {
            "WIDTH": width,
            "START": ", ".join(f"x{k} = v8{{}} + (uint8_t){k}, y{k} = x{k} + (uint8_t)1" for k in range(CHAINS)),
            "ADD": " ".join(f'x{k} += y{k}; __asm__ volatile("" : "+v"(x{k}));' for k in range(CHAINS)),
            "SUM": " + ".join(f"x{k}" for k in range(CHAINS)),
        }
        source.write_text(re.sub("@([A-Z]+)@", lambda found: str(marked[found[1]]), ADDS), encoding="utf-8")
        words = [compiler, "-O3", "-march=native", "-w", "-shared", "-fPIC", "-o", str(library), str(source)]
        subprocess.run(words, check=True, timeout=60)
        adds = ctypes.CDLL(str(library)).adds
        best = 0.0
        for _ in range(5):
            began = time.process_time()
            adds(ctypes.c_long(ROUNDS))
            best = max(best, ROUNDS * CHAINS / (time.process_time() - began))
        return best


def vector_instructions(code: bytes, function: str) -> tuple[int, int]:
    """Vector instructions of a function in an object file: those that compute, and those that only move.

    For a function without inner loops.  Raises `ValueError` when the file has no such function.
    """
    with tempfile.NamedTemporaryFile(suffix=".o") as file:
        file.write(code)
        file.flush()
        words = ["objdump", "-d", "--no-show-raw-insn", f"--disassemble={function}", file.name]
        text = subprocess.run(words, check=True, capture_output=True, text=True).stdout
    if f"<{function}>:" not in text:
        raise ValueError(f"the object file has no function {function}")
    vectors = sum(bool(VECTOR.search(line + " ")) for line in text.splitlines())
    moves = sum(bool(MOVED.search(line + " ")) for line in text.splitlines())
    return vectors - moves, moves
