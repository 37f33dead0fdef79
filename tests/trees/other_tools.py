"""Two tools that share nothing with ours, asked about our trees: SCRAM (the program) and d4 (the package d4solver)."""

import math
import shutil
import subprocess
import xml.etree.ElementTree as ET
from fractions import Fraction
from functools import cache

SCRAM = shutil.which("scram")


# --- SCRAM ------------------------------------------------------------------------------------------------------------


def scram(trees, folder, *options):
    """Top probability (6 digits), and how many minimal cut sets of order 1, 2, 3, ... each tree has, all in one run."""
    path, out = folder / "trees.xml", folder / "out.xml"
    model = ET.Element("opsa-mef")
    data = ET.Element("model-data")
    for number, tree in enumerate(trees):
        _define(tree, f"t{number}-", model, data)
    model.append(data)
    ET.ElementTree(model).write(path, encoding="utf-8", xml_declaration=True)
    subprocess.run(
        [SCRAM, "--bdd", "--probability", "1", "-l", "1000", *options, path, "-o", out],
        check=True, capture_output=True, timeout=300,
    )  # fmt: skip
    found = {}
    for result in ET.parse(out).getroot().iter("sum-of-products"):
        counts = tuple(int(n) for n in (result.get("distribution") or "").split())
        found[result.get("name")] = float(result.get("probability")), counts
    return [found[f"t{number}-{tree.top}"] for number, tree in enumerate(trees)]


def _define(tree, prefix, model, data):
    """The tree in MEF: gates of one input are that input, an xor of many is a chain."""
    definition = ET.SubElement(model, "define-fault-tree", name=f"{prefix}tree")
    kinds = {gate.name: "gate" for gate in tree.gates} | {house.name: "house-event" for house in tree.house_events}
    for gate in tree.inputs_first:
        parent = ET.SubElement(definition, "define-gate", name=prefix + gate.name)
        inputs = [ET.Element(kinds.get(name, "basic-event"), name=prefix + name) for name in gate.inputs]
        parent.append(_formula(gate, inputs))
    for event in tree.events:
        basic = ET.SubElement(data, "define-basic-event", name=prefix + event.name)
        ET.SubElement(basic, "float", value=repr(float(event.probability)))
    for house in tree.house_events:
        constant = ET.SubElement(data, "define-house-event", name=prefix + house.name)
        ET.SubElement(constant, "constant", value=str(house.state).lower())


def _formula(gate, inputs):
    if gate.kind == "not":
        return _element("not", inputs)
    if gate.kind == "vote":
        return _at_least(gate.k, inputs)
    if len(inputs) == 1:
        return inputs[0]
    if gate.kind == "xor":
        return _element("xor", [inputs[0], _formula(gate, inputs[1:])])
    return _element(gate.kind, inputs)


def _at_least(k, inputs):
    """A vote of basic events as it is, another as ands and ors: of inputs that turn out equal SCRAM 0.16.2 takes some.

    So it finds e0 for 2 of (e0, x, y), where x and y are both e0 & e1.
    """
    if k == len(inputs) or k == 1:
        return inputs[0] if len(inputs) == 1 else _element("and" if k > 1 else "or", inputs)
    if all(one.tag == "basic-event" for one in inputs):
        return _element("atleast", inputs, min=str(k))
    first, *others = inputs
    return _element("or", [_element("and", [first, _at_least(k - 1, others)]), _at_least(k, others)])


def _element(name, inputs, **attributes):
    element = ET.Element(name, attributes)
    element.extend(inputs)
    return element


# --- d4 ---------------------------------------------------------------------------------------------------------------


def d4(tree):
    """Top probability, exactly, of the gates as clauses: compiled by d4, the sums and products here.

    What d4 compiles is deterministic and decomposable, and the chances of an event add up to 1: an event that a branch
    leaves open needs no factor.
    """
    import py_d4

    clauses = Clauses(tree)
    if abs(clauses.top) == clauses.true:
        return Fraction(clauses.top > 0)
    edges, kinds = {}, {}
    for line in py_d4.Solver(clauses.found, clauses.variables).compile().getNNFString().splitlines():
        first, second, *literals, _ = line.split() if line[:1].isdigit() else (*line.split(), "")
        if first.isdigit():
            edges.setdefault(first, []).append((second, literals))
        else:
            kinds[second] = first

    @cache
    def of(node):
        if kinds[node] in "tf":
            return Fraction(kinds[node] == "t")
        terms = [of(below) * math.prod(clauses.weights.get(int(x), 1) for x in xs) for below, xs in edges[node]]
        return sum(terms) if kinds[node] == "o" else math.prod(terms)

    return of("1")


class Clauses:
    """A tree as clauses that define a variable for each gate, and for each count within a vote or an xor."""

    def __init__(self, tree):
        self.found, self.variables, self.weights = [], 0, {}
        self.true = self._new()
        self.found.append([self.true])
        number = {house.name: self.true if house.state else -self.true for house in tree.house_events}
        for event in tree.events:
            n = number[event.name] = self._new()
            self.weights |= {n: event.probability, -n: 1 - event.probability}
        for gate in tree.inputs_first:
            number[gate.name] = self._gate(gate, [number[name] for name in gate.inputs])
        self.top = number[tree.top]
        self.found.append([self.top])

    def _new(self):
        self.variables += 1
        return self.variables

    def _gate(self, gate, inputs):
        if gate.kind == "not":
            return -inputs[0]
        if gate.kind == "or":
            return -self._and([-x for x in inputs])
        if gate.kind == "vote":
            return self._at_least(gate.k, inputs)
        if gate.kind == "xor":
            odd = -self.true
            for x in inputs:
                odd = -self._and([-self._and([odd, -x]), -self._and([-odd, x])])
            return odd
        return self._and(inputs)

    def _and(self, inputs):
        inputs = list(dict.fromkeys(x for x in inputs if x != self.true))
        if -self.true in inputs or any(-x in inputs for x in inputs):
            return -self.true
        if len(inputs) < 2:
            return inputs[0] if inputs else self.true
        both = self._new()
        self.found += [[-both, x] for x in inputs]
        self.found.append([both, *(-x for x in inputs)])
        return both

    def _at_least(self, k, inputs):
        @cache
        def of(first, needed):
            if needed == 0:
                return self.true
            if len(inputs) - first < needed:
                return -self.true
            with_it = self._and([inputs[first], of(first + 1, needed - 1)])
            return -self._and([-with_it, -of(first + 1, needed)])

        return of(0, k)
