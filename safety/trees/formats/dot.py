"""A fault tree as a Graphviz graph (DOT), for other programs to draw.

Every gate and event is drawn once, so that what several gates share shows as shared: gates as boxes with their kind,
basic events as circles, undeveloped ones as diamonds, house events as houses (IEC 61025 words).
"""

from __future__ import annotations

from safety.trees.tree import BasicEvent, FaultTree, Gate, Node

SHAPES = {"undeveloped": "diamond", "conditional": "ellipse"}


def to_dot(tree: FaultTree) -> str:
    """`tree` as DOT text, from the top down; what the top does not reach is left out."""
    gates = tree.inputs_first[::-1]
    used = {name for gate in gates for name in gate.inputs}
    leaves: tuple[Node, ...] = (*tree.events, *tree.house_events)
    nodes: list[Node] = [*gates, *(leaf for leaf in leaves if leaf.name in used)]
    lines = [f"digraph {_quoted(tree.name)} {{", ' node [fontname="Helvetica"];', " edge [arrowhead=none];"]
    for node in nodes:
        lines.append(f" {_quoted(node.name)} [shape={_shape(node)}, label={_quoted(_label(node))}];")
    for gate in gates:
        lines += [f" {_quoted(gate.name)} -> {_quoted(name)};" for name in gate.inputs]
    return "\n".join([*lines, "}", ""])


def _shape(node: Node) -> str:
    if isinstance(node, Gate):
        return "box"
    if isinstance(node, BasicEvent):
        return SHAPES.get(dict(node.attributes).get("flavor", ""), "circle")
    return "house"


def _label(node: Node) -> str:
    shown = [node.name, node.description]
    if isinstance(node, Gate):
        shown.append(f"{node.k} of {len(node.inputs)}" if node.kind == "vote" else node.kind)
    elif isinstance(node, BasicEvent):
        known = "" if node.chance is None else f"{node.chance[0]:.3g}"
        shown.append(f"{known} [A]".lstrip() if node.source == "A" else known)
    else:
        shown.append(str(node.state).lower())
    return "\n".join(text for text in shown if text)


def _quoted(text: str) -> str:
    escaped = text.replace("\\", "\\\\").replace('"', '\\"').replace("\n", "\\n")
    return f'"{escaped}"'
