"""Certificates that somebody has tampered with, drawn at random, and whether they are still valid."""

from __future__ import annotations

import contextlib
import json
import random
from typing import Any

from safety.prove import check
from safety.prove.lrat import NoProof, refutation
from tests.prove.certified import Files, edited, follows, proves, rebuilt

SWAPS = {"and": "or", "or": "xor", "xor": "and", "implies": "or", "lt": "le", "le": "lt", "add": "sub", "sub": "add"}
SWAPS |= {"eq": "le", "band": "bor", "bor": "bxor", "bxor": "band", "mul": "add", "div": "mod", "mod": "div"}


def _index(rng: random.Random, nodes: list[Any], sort: str) -> int:
    return rng.choice([i for i, node in enumerate(nodes) if node[3] == sort])


def _constant(text: Any, rng: random.Random) -> None:
    node = rng.choice([node for node in text["nodes"] if node[0] == "const"])
    old = node[2]
    node[2] = (not old) if isinstance(old, bool) else old + rng.choice([-1, 1]) if isinstance(old, int) else "5/6"


def _operation(text: Any, rng: random.Random) -> None:
    node = rng.choice([node for node in text["nodes"] if node[0] in SWAPS])
    node[0] = SWAPS[node[0]]


def _arguments(text: Any, rng: random.Random) -> None:
    node = rng.choice([node for node in text["nodes"] if node[1]])
    i = rng.randrange(len(node[1]))
    match rng.choice(["other", "other", "turned", "later", "none"]):
        case "other":
            node[1][i] = _index(rng, text["nodes"], text["nodes"][node[1][i]][3])
        case "turned":
            node[1].reverse()
        case "later":
            node[1][i] = rng.choice([len(text["nodes"]), text["nodes"].index(node), -1])
        case "none":
            del node[1][i]


def _sort(text: Any, rng: random.Random) -> None:
    node = rng.choice(text["nodes"])
    node[3] = rng.choice(
        ["bit", "u1", "u3", "u4", "u5", "u600", "real", "int[0, 15]", "int[-20, 20]", "int[1, 0]", node[3] + " "]
    )


def _attribute(text: Any, rng: random.Random) -> None:
    node = rng.choice([node for node in text["nodes"] if node[0] in ("slice", "bit", "var")])
    node[2] = {"var": "other", "bit": 1, "slice": rng.choice([[0, 2], [1, 3], [0, 5], [0]])}[node[0]]


def _register(text: Any, rng: random.Random) -> None:
    register = rng.choice(text["registers"])
    sort = text["nodes"][register[1]][3]
    match rng.choice(["power-up", "power-up", "any", "next", "drop", "twice"]):
        case "power-up":
            old = register[3]
            register[3] = (not old) if isinstance(old, bool) else (old or 0) + 1 if not isinstance(old, str) else "9/4"
        case "any":
            register[3] = None
        case "next":
            register[2] = _index(rng, text["nodes"], sort)
        case "drop":
            text["registers"].remove(register)
        case "twice":
            text["registers"].append(list(register))


def _lemma(text: Any, rng: random.Random) -> None:
    lemmas = text["lemmas"]
    match rng.choice(["drop", "other", "other", "more"]) if lemmas else "more":
        case "drop":
            lemmas.remove(rng.choice(lemmas))
        case "other":
            rng.choice(lemmas)[1] = _index(rng, text["nodes"], "bit")
        case "more":
            lemmas.append([rng.choice(["more", "in range"]), _index(rng, text["nodes"], "bit")])


def _formula(text: Any, rng: random.Random) -> None:
    text[rng.choice(["given", "start", "holds"])] = _index(rng, text["nodes"], "bit")


def _induction(text: Any, rng: random.Random) -> None:
    match rng.choice(["depth", "depth", "labels", "arithmetic"]):
        case "depth":
            text["depth"] = rng.choice([0, 1, 2, 3, -1, True])
        case "labels":
            text["obligations"].remove(rng.choice(text["obligations"]))
        case "arithmetic":
            text["arithmetic"] = {"bits": "integers", "integers": "bits"}[text["arithmetic"]]


def _words(text: Any, rng: random.Random) -> None:
    match rng.choice(["inputs", "statement", "id", "key"]):
        case "inputs":
            text["inputs"] = rng.choice([text["inputs"][1:], [*text["inputs"], text["registers"][0][0]]])
        case "statement":
            text["claim"]["statement"] = "It never fails."
        case "id":
            text["claim"]["id"] = "another.claim"
        case "key":
            text.pop(rng.choice([*text]))


CHANGES = [_constant, _operation, _arguments, _sort, _attribute, _register, _lemma, _formula, _induction, _words]


def proved_again(text: Any, files: Files) -> Files:
    """What a forger makes of a changed json: its own texts and clauses, new proofs where there are any."""
    try:
        c = check.read(text)
    except (check.Malformed, AttributeError, TypeError, KeyError):
        return files
    made: Files = {}
    text["obligations"] = [[one.label, ""] for one in check.obligations(c)]
    for i, one in enumerate(check.obligations(c), 1):
        made[f"{i}.smt2"], clauses = check.smt(c, one), check.clauses(c, one)
        if clauses is not None:
            made[f"{i}.cnf"] = check.dimacs(one.label, clauses)
            try:
                made[f"{i}.lrat"] = refutation(clauses, 20)
            except NoProof:
                made |= {name: files[name] for name in [f"{i}.lrat"] if name in files}
    return made


def same_claim(text: Any, other: Any) -> bool:
    """Whether what the hashes bind is the same, as the terms that the toolkit itself makes of it."""
    problems = rebuilt(text), rebuilt(other)  # both at once: equal terms are then one
    seen = [
        (
            {(s.path, s.var.uid, s.next.uid, repr(s.power_up)) for s in p.system.states},
            [p.holds.uid, p.given.uid, p.start.uid, sorted(of["inputs"])],
            [of["claim"]["id"], of["claim"]["statement"], of["claim"]["faults"], of["model"]["name"]],
        )
        for p, of in zip(problems, (text, other), strict=True)
    ]
    return seen[0] == seen[1]


def clauses_in(text: str) -> list[list[int]]:
    return [[int(word) for word in line.split()[:-1]] for line in text.splitlines()[2:]]


def forged(files: Files, rng: random.Random) -> tuple[str, Files, bool]:
    """What was done to a certificate, the outcome, and whether it is invalid, as judged without the checker."""
    if rng.random() < 0.3:
        name = rng.choice([name for name in files if name != check.MAIN])
        if name.endswith("lrat"):
            new = edited(files[name], rng)
            return f"{name} edited", files | {name: new}, not follows(clauses_in(files[name[:-4] + "cnf"]), new)
        new = files[name].replace(*rng.choice([("1", "2"), ("-", ""), ("and", "or")]))
        return f"{name} edited", files | {name: new}, new != files[name]
    text, before = json.loads(files[check.MAIN]), json.loads(files[check.MAIN])
    change = rng.choice(CHANGES)
    change(text, rng)
    if rng.random() < 0.25:
        with contextlib.suppress(IndexError, KeyError, ValueError):  # there is nothing left of that kind
            change(text, rng)
    rehashed, again = rng.random() < 0.5, rng.random() < 0.7
    if again:
        files = proved_again(text, files)
    if rehashed:
        try:
            text["model"]["sha256"], text["claim"]["sha256"] = check.hashes(text)
        except (IndexError, KeyError, TypeError):
            rehashed = False
    valid = {*text} == {*before} and all(len(n[1]) == check.ARITY[n[0]] for n in text["nodes"]) and proves(text)
    valid = valid and len(text["obligations"]) == 2 * len(text["lemmas"]) + 1 + text["depth"]
    valid = valid and (rehashed or same_claim(text, before))
    done = f"{change.__name__}{', hashes' * rehashed}{', proofs' * again}"
    return done, files | {check.MAIN: json.dumps(text)}, not valid
