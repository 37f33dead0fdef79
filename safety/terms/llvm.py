"""LLVM: the target, texts compiled to machine code, and a folder of what was compiled before.

The folder belongs to the user alone, since what is in it is run.  An entry carries its own digest and is compiled anew
when it does not fit; a folder that cannot be written costs the time to compile, never a run.
"""

from __future__ import annotations

import contextlib
import ctypes
import functools
import hashlib
import os
import stat
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

DIGEST = 32  # bytes of a SHA-256
MOST_KEPT = 256  # entries
READY = b"ready"  # an attribute of functions that passes cannot make simpler


@dataclass(frozen=True)
class Target:
    """A processor as LLVM names it, its features as `+avx2,-...`, how many lanes run side by side.

    `packed`: a bit of all lanes is one whole number, as mask registers have it; else it is a vector.  `sliced`: there
    are only bits, each of all lanes a vector of 64-bit words.
    """

    cpu: str
    features: str
    lanes: int
    packed: bool
    sliced: bool = False

    @property
    def ternary(self) -> bool:
        """Whether any function of three bits is one instruction."""
        return self.sliced and self.lanes == 512

    def in_slices(self) -> Target:
        """The same processor with a lane for each bit of its vectors."""
        return replace(self, lanes=8 * self.lanes, packed=False, sliced=True)


AVX512 = Target("x86-64-v4", "", 64, True)
AVX2 = Target("x86-64-v3", "", 32, False)
PLAIN = Target("", "", 16, False)  # what every processor of the kind has; also NEON


@functools.cache
def host() -> Target:
    """The processor that this runs on."""
    import llvmlite.binding as llvm

    features = llvm.get_host_cpu_features()
    best = AVX512 if features.get("avx512bw") else AVX2 if features.get("avx2") else PLAIN
    return replace(best, cpu=llvm.get_host_cpu_name(), features=features.flatten())


@functools.cache
def _started() -> Any:
    import llvmlite.binding as llvm

    llvm.initialize_native_target()
    llvm.initialize_native_asmprinter()
    return llvm


def _machine(target: Target) -> Any:
    llvm = _started()
    found = llvm.Target.from_default_triple()
    return found.create_target_machine(cpu=target.cpu, features=target.features, opt=2, jit=True)


class Library:
    """Compiled functions, of pointers and 64-bit numbers; Python's lock is free while one runs.

    `keep`: what is compiled is kept in the user's folder, and taken from there the next time.
    """

    def __init__(self, text: str, target: Target, *, keep: bool = False) -> None:
        llvm = _started()
        key = hashlib.sha256("\0".join([text, target.cpu, target.features, str(llvm.llvm_version_info)]).encode())
        code = recalled(key.hexdigest()) if keep else None
        if code is None:
            code = _object(target, text)
            if keep:
                remember(key.hexdigest(), code)
        empty = llvm.parse_assembly("")
        self._engine = llvm.create_mcjit_compiler(empty, _machine(target))
        self._engine.add_object_file(llvm.ObjectFileRef.from_data(code))
        self._engine.finalize_object()

    def address(self, name: str) -> int:
        """Where a function is."""
        found: int = self._engine.get_function_address(name)
        assert found, f"no function {name}"
        return found

    def function(self, name: str, *kinds: Any) -> Any:
        """A function as one of Python, from arguments of the given ctypes to nothing."""
        return ctypes.CFUNCTYPE(None, *kinds)(self.address(name))


def _object(target: Target, text: str) -> bytes:
    """Machine code of a text.  The terms are simple already: a short list of passes compiles fastest."""
    llvm, machine = _started(), _machine(target)
    module = llvm.parse_assembly(text)
    module.verify()
    builder = llvm.create_pass_builder(machine, llvm.create_pipeline_tuning_options(speed_level=2))
    passes = llvm.create_new_function_pass_manager()
    passes.add_sroa_pass()
    passes.add_instruction_combine_pass()
    passes.add_new_gvn_pass()
    passes.add_simplify_cfg_pass()
    for function in module.functions:
        if not function.is_declaration and READY not in b"".join(function.attributes):
            passes.run(function, builder)
    code: bytes = machine.emit_object(module)
    return code


# --- what was compiled before --------------------------------------------------------------------------------------


def home() -> Path:
    """Where compiled code is kept."""
    base = os.environ.get("XDG_CACHE_HOME") or os.path.join(os.path.expanduser("~"), ".cache")
    return Path(base) / "rightside" / "native"


def folder() -> Path | None:
    """The user's own folder of compiled code, made where it is missing; None where there can be none of that kind."""
    path = home()
    try:
        path.mkdir(mode=0o700, parents=True, exist_ok=True)
        found = path.lstat()
    except (OSError, RuntimeError):
        return None
    private = stat.S_ISDIR(found.st_mode) and not found.st_mode & (stat.S_IWGRP | stat.S_IWOTH)
    return path if private and (not hasattr(os, "getuid") or found.st_uid == os.getuid()) else None


def recalled(key: str) -> bytes | None:
    """What was compiled under a key, if it is there and whole."""
    place = folder()
    if place is None:
        return None
    try:
        kept = (place / key).read_bytes()
    except OSError:
        return None
    return kept[DIGEST:] if hashlib.sha256(kept[DIGEST:]).digest() == kept[:DIGEST] else None


def remember(key: str, code: bytes) -> None:
    """Keep what was compiled, and the newest `MOST_KEPT` before; a folder that cannot be written keeps nothing."""
    place = folder()
    if place is None:
        return
    new = place / f"{key}.{os.getpid()}.new"
    try:
        new.write_bytes(hashlib.sha256(code).digest() + code)
        os.replace(new, place / key)
        for old in sorted(place.iterdir(), key=lambda file: -file.stat().st_mtime)[MOST_KEPT:]:
            old.unlink()
    except OSError:
        with contextlib.suppress(OSError):
            new.unlink()
