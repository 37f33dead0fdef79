"""Fault trees: the tree, its formats, its exact solution. Usable without any model of equipment."""

from safety.trees.as_written import TreeError
from safety.trees.drawn.from_cut_sets import from_cut_sets
from safety.trees.formats.files import read, write
from safety.trees.formats.json_form import to_document
from safety.trees.module_diagrams import TooLarge
from safety.trees.solve import Solution, solve
from safety.trees.summary import summary
from safety.trees.tree import BasicEvent, FaultTree, Gate, HouseEvent

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
