"""Masks of one lane, in native code: what an atom sets among the taps where it begins, and what is left behind."""

from __future__ import annotations

from safety.inject.native.kernel import Kernel
from safety.inject.native.routine import Routine

ENTRY = (
    "keep",
    "turn",
    "keep_at",
    "turn_at",
    "size",
    "flag",
)  # an atom at a point, 8 bytes each; masks and where they go
PACKED = 0  # a size: the lanes are the bits of one number


def masking(kernel: Kernel) -> list[Routine]:
    """`mask(taps, entry, lane)`: an atom's mask on what is there already; `pass(...)`: none any more."""
    write = _in_planes if kernel.target.sliced else _in_words
    return [write(kernel, "mask"), write(kernel, "pass")]


def _in_planes(kernel: Kernel, name: str) -> Routine:
    k = Routine(kernel.target, name, ["ptr %taps", "ptr %entry", "i64 %lane"])
    keep, turn, keep_at, turn_at, size, flag = (k.load("i64", "%entry", 8 * i, align=8) for i in range(len(ENTRY)))
    byte = k.op("lshr i64 %lane, 3")
    shift = k.op(f"trunc i64 {k.op('and i64 %lane, 7')} to i8")
    own = k.op(f"shl i8 1, {shift}")
    others = k.op(f"xor i8 {own}, -1")
    k.store("i8", 1, k.at("%taps", flag))
    with k.each(0, size) as i:
        behind = k.op(f"add i64 {byte}, {k.op(f'mul i64 {i}, {k.lanes // 8}')}")
        places = [k.at(k.at("%taps", at), behind) for at in (keep_at, turn_at)]
        held, turned = (k.load("i8", place) for place in places)
        if name == "pass":
            held, turned = k.op(f"or i8 {held}, {own}"), k.op(f"and i8 {turned}, {others}")
        else:
            bits = [k.op(f"trunc i64 {k.op(f'lshr i64 {x}, {i}')} to i1") for x in (keep, turn)]
            k_ = k.op(f"select i1 {bits[0]}, i8 -1, i8 {others}")
            t_ = k.op(f"select i1 {bits[1]}, i8 {own}, i8 0")
            held = k.op(f"and i8 {held}, {k_}")
            turned = k.op(f"xor i8 {k.op(f'and i8 {turned}, {k_}')}, {t_}")
        k.store("i8", held, places[0])
        k.store("i8", turned, places[1])
    return k


def _in_words(kernel: Kernel, name: str) -> Routine:
    k = Routine(kernel.target, name, ["ptr %taps", "ptr %entry", "i64 %lane"])
    keep, turn, keep_at, turn_at, size = (k.load("i64", "%entry", 8 * i, align=8) for i in range(len(ENTRY) - 1))
    keep_place, turn_place = k.at("%taps", keep_at), k.at("%taps", turn_at)
    sizes = [(b, f"i{8 * b}") for b in (1, 2, 4, 8)] + ([(PACKED, f"i{k.lanes}")] if kernel.target.packed else [])
    for number, kind in sizes:
        with k.when(k.is_("eq", "i64", size, number)):
            k_, t_ = (x if kind == "i64" else k.op(f"trunc i64 {x} to {kind}") for x in (keep, turn))
            if number == PACKED:
                lane = "%lane" if kind == "i64" else k.op(f"trunc i64 %lane to {kind}")
                own = k.op(f"shl {kind} 1, {lane}")
                k_ = k.op(f"or {kind} {k.op(f'shl {kind} {k_}, {lane}')}, {k.op(f'xor {kind} {own}, -1')}")
                t_ = k.op(f"shl {kind} {t_}, {lane}")
                places = keep_place, turn_place
            else:
                own = "-1"
                places = k.element(keep_place, kind, "%lane"), k.element(turn_place, kind, "%lane")
            held, turned = (k.load(kind, place) for place in places)
            if name == "pass":
                held = k.op(f"or {kind} {held}, {own}")
                turned = k.op(f"and {kind} {turned}, {k.op(f'xor {kind} {own}, -1')}")
            else:
                held = k.op(f"and {kind} {held}, {k_}")
                turned = k.op(f"xor {kind} {k.op(f'and {kind} {turned}, {k_}')}, {t_}")
            k.store(kind, held, places[0])
            k.store(kind, turned, places[1])
    return k
