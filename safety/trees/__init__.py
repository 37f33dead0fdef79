"""Fault trees: the tree, its formats, its exact solution. Usable without any model of equipment."""

from safety.trees.formats import read, write
from safety.trees.from_cut_sets import from_cut_sets
from safety.trees.json_form import to_document
from safety.trees.solve import Solution, TooLarge, solve
from safety.trees.summary import summary
from safety.trees.tree import BasicEvent, FaultTree, Gate, HouseEvent, TreeError

__all__ = [
    "BasicEvent",
    "FaultTree",
    "Gate",
    "HouseEvent",
    "Solution",
    "TooLarge",
    "TreeError",
    "from_cut_sets",
    "read",
    "solve",
    "summary",
    "to_document",
    "write",
]
