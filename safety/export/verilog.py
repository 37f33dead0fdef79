"""A claim as a synthesizable Verilog module with `assume` and `assert`, for formal tools that read Verilog.

Ports, registers and signals have their full names, as escaped identifiers (IEEE 1364-2005, 3.7.1).
"""

from __future__ import annotations

from collections.abc import Mapping

from safety.export.expressions import Expression, Names, Reading, Width, below
from safety.export.transition import Problem, power_up, transition
from safety.system import System
from safety.terms.graph import Term

CLOCK, FIRST = "clk", "tool.first"
HEAD = """\
// {name}: a claim of rightside; one edge of {clock} is one step.
// Registers without an initial value may hold anything at power-up.
"""
_INFIX = {
    **{"and": "&", "or": "|", "xor": "^", "bvand": "&", "bvor": "|", "bvxor": "^", "=": "==", "bvult": "<"},
    **{"bvule": "<=", "bvadd": "+", "bvsub": "-", "bvmul": "*", "bvudiv": "/", "bvurem": "%"},
}
_SIGNED = {"bvslt": "<", "bvsle": "<="}


def verilog(problem: Problem, lemmas: bool = False) -> str:
    """The claim as a module of its inputs and a clock: the assertion holds exactly if the claim holds for ever.

    `lemmas` have to hold as the claim does.  Raises `TermError` for a claim over reals.
    """
    what = transition(problem, lemmas)
    reading = Reading(integers=False)
    names = Names(" \t\n")
    inputs = [reading.bind(v, names.new(str(v.attr))) for v in what.inputs]
    held = {s: reading.bind(s.var, names.new(s.path)) for s in what.states}
    start, given, holds = reading([what.start, what.given, what.holds])
    following = reading([s.next for s in what.states])
    signals = {names.new(path): x for path, x in zip(what.named, reading(what.named.values()), strict=True)}
    clock, first = (f"\\{names.new(each)} " for each in (CLOCK, FIRST))
    nodes = [x for x in below([start, given, holds, *following, *signals.values()]) if x.op != "var"]
    wires = {x.number: names.new(f"n{x.number}") for x in nodes}

    def name(x: Expression) -> str:
        return f"\\{x.attr} " if x.op == "var" else wires[x.number]

    ports = [f"input {clock}", *(f"input {_range(x.sort)}{name(x)}" for x in inputs)]
    lines = [f"  reg {_range(x.sort)}{name(x)};" for x in held.values()]
    lines += [f"  wire {_range(x.sort)}{name(x)} = {_text(x, [name(a) for a in x.args])};" for x in nodes]
    lines += [f"  wire {_range(x.sort)}\\{path} = {name(x)};" for path, x in signals.items()]
    for s, x in held.items():
        if (value := power_up(s)) is not None:
            lines.append(f"  initial {name(x)} = {_constant(int(value), x.sort)};")
    steps = [f"{name(x)} <= {name(after)};" for x, after in zip(held.values(), following, strict=True)]
    checks = [f"assert ({name(holds)});"]
    if not given.is_true:
        checks.insert(0, f"assume ({name(given)});")
    if what.has_start:
        lines.append(f"  reg {first} = 1'b1;")
        steps.append(f"{first} <= 1'b0;")
        checks.insert(0, f"if ({first}) assume ({name(start)});")
    for when, body in ((f"@(posedge {clock})", steps), ("@*", checks)):
        lines += [f"  always {when} begin", *(f"    {line}" for line in body), "  end"]
    head = HEAD.format(name=what.name, clock=clock.strip())
    return head + f"module \\claim (\n  {f',{chr(10)}  '.join(ports)}\n);\n" + "\n".join(lines) + "\nendmodule\n"


def machine(system: System, outputs: Mapping[str, Term]) -> str:
    """The system as a module for simulators: its inputs, `outputs` by the names of their ports, a clock.

    Each edge of the clock, rising or falling, is one step; after it the outputs are those of the step.  One block
    computes a step, so that a simulator has nothing to schedule.  Raises `TermError` for a system with reals.
    """
    reading, names = Reading(integers=False), Names(" \t\n")
    clock = f"\\{names.new(CLOCK)} "
    ports = {f"\\{names.new(name)} ": term for name, term in outputs.items()}
    inputs = [reading.bind(v, names.new(name)) for name, v in system.inputs.items()]
    held = {s: reading.bind(s.var, names.new(s.path)) for s in system.states}
    following, seen = reading([s.next for s in system.states]), reading(ports.values())
    whole = below([*following, *seen])
    taken = {x.number for x in following if x.op == "var"}  # read before it changes
    nodes = [x for x in whole if x.op != "var" or x.number in taken]
    local = {x.number: names.new(f"n{x.number}") for x in nodes}
    value = {x.number: f"\\{x.attr} " if x.op == "var" else local[x.number] for x in whole}
    lines = [f"  reg {_range(x.sort)}\\{x.attr} ;" for x in held.values()]
    lines += [f"  reg {_range(x.sort)}{local[x.number]};" for x in nodes]
    for s, x in held.items():
        if (start := power_up(s)) is not None:
            lines.append(f"  initial \\{x.attr} = {_constant(int(start), x.sort)};")
    steps = [
        f"{local[x.number]} = {value[x.number] if x.op == 'var' else _text(x, [value[a.number] for a in x.args])};"
        for x in nodes
    ]
    steps += [f"{port} = {value[x.number]};" for port, x in zip(ports, seen, strict=True)]
    steps += [f"\\{x.attr} = {local[after.number]};" for x, after in zip(held.values(), following, strict=True)]
    declared = [f"input {clock}", *(f"input {_range(x.sort)}\\{x.attr} " for x in inputs)]
    declared += [f"output reg {_range(x.sort)}{port}" for port, x in zip(ports, seen, strict=True)]
    return "\n".join(
        [
            f"// {system.name}: an edge of {CLOCK}, rising or falling, is one step.",
            f"module machine (\n  {f',{chr(10)}  '.join(declared)}\n);",
            *lines,
            f"  always @(edge {clock}) begin",
            *(f"    {step}" for step in steps),
            "  end\nendmodule\n",
        ]
    )


def _range(sort: Width) -> str:
    return f"[{sort - 1}:0] " if isinstance(sort, int) else ""


def _constant(value: int, sort: Width) -> str:
    bits = sort if isinstance(sort, int) else 1
    return f"{bits}'d{value % (1 << bits)}"


def _text(x: Expression, args: list[str]) -> str:
    if x.op == "const":
        return _constant(int(x.attr), x.sort)
    if x.op in _INFIX:
        return f"{args[0]} {_INFIX[x.op]} {args[1]}"
    if x.op in _SIGNED:
        return f"$signed({args[0]}) {_SIGNED[x.op]} $signed({args[1]})"
    match x.op:
        case "not":
            return f"~{args[0]}"
        case "=>":
            return f"~{args[0]} | {args[1]}"
        case "ite":
            return f"{args[0]} ? {args[1]} : {args[2]}"
        case "concat":
            return f"{{{args[0]}, {args[1]}}}"
        case "extract":
            return f"{args[0]}[{x.attr[0]}:{x.attr[1]}]"
        case "zero_extend":
            return f"{{{x.attr}'d0, {args[0]}}}"
        case "sign_extend":
            top = f"{args[0]}[{int(x.args[0].sort) - 1}]"
            return f"{{{{{x.attr}{{{top}}}}}, {args[0]}}}"
    raise AssertionError(f"{x.op} is no operation on bits")
