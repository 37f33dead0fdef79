"""TS-7 relay contacts: the 2-out-of-3 voter and the emergency-brake chain as networks of contacts.

A network joins terminals by contacts; current flows from `+` to the coil while some path is closed.  A front contact
(`chr_a`) is closed while its relay is up, a back contact (`~chr_a`) while it is down.  Open contacts brake.
Source: always-energised relays, two out of three [P]; the drawing of the circuits [R], rule (b) [A].
"""

from __future__ import annotations

from collections.abc import Mapping
from itertools import combinations
from typing import TYPE_CHECKING, NamedTuple

if TYPE_CHECKING:
    import networkx as nx

PLUS, COIL = "+", "coil"


class Contact(NamedTuple):
    """A contact between two terminals; several contacts of one relay have the same name."""

    start: str
    end: str
    name: str


Network = tuple[Contact, ...]

TWO_UP = (("nbrr_a", "nbrr_b"), ("nbrr_b", "nbrr_c"), ("nbrr_a", "nbrr_c"))


def ladder(start: str, end: str, rungs: tuple[tuple[str, ...], ...]) -> Network:
    """Rungs side by side between two terminals, each a series of contacts."""
    found: list[Contact] = []
    for i, rung in enumerate(rungs):
        terminals = [start, *(f"{start}>{end} {i}.{k}" for k in range(1, len(rung))), end]
        found += [Contact(a, b, name) for a, b, name in zip(terminals, terminals[1:], rung, strict=False)]
    return tuple(found)


NB_RULE_A = ladder(PLUS, COIL, TWO_UP)
"""Rule (a), reference: NB is released while two of the three relays NBRR are up."""

NB_RULE_B = (
    *ladder(PLUS, "none isolated", (("chr_a", "chr_b", "chr_c"),)),
    *ladder("none isolated", COIL, TWO_UP),
    *ladder(PLUS, "one isolated", (("~chr_a",), ("~chr_b",), ("~chr_c",))),
    *ladder("one isolated", COIL, (("chr_a", "nbrr_a"), ("chr_b", "nbrr_b"), ("chr_c", "nbrr_c"))),
)
"""Rule (b), variant: after an isolation one remaining relay up releases NB."""

EB_CHAIN = (
    *ladder(PLUS, "no dual fault", (("chr_a", "chr_b"), ("chr_b", "chr_c"), ("chr_a", "chr_c"))),
    *ladder("no dual fault", COIL, (("~rev_a", "~rev_b", "~rev_c"),)),
)
"""The EB relay is up while two CHR are up and no channel finds the train rolling back."""


def closed(contact: str, up: Mapping[str, bool]) -> bool:
    """Whether a contact is closed, given which relays are up."""
    return not up[contact[1:]] if contact.startswith("~") else up[contact]


def graph(network: Network, up: Mapping[str, bool] | None = None) -> nx.MultiGraph:
    """The network as a graph of terminals; with `up`, of its closed contacts only."""
    import networkx as nx

    drawn = nx.MultiGraph()
    drawn.add_nodes_from((PLUS, COIL))
    drawn.add_edges_from((c.start, c.end, {"name": c.name}) for c in network if up is None or closed(c.name, up))
    return drawn


def conducts(network: Network, up: Mapping[str, bool]) -> bool:
    """Whether the coil has current."""
    import networkx as nx

    return bool(nx.has_path(graph(network, up), PLUS, COIL))


def relays(network: Network) -> list[str]:
    """The relays whose contacts a network uses."""
    return sorted({c.name.removeprefix("~") for c in network})


def paths(network: Network) -> set[frozenset[str]]:
    """Minimal sets of contacts that feed the coil when closed."""
    import networkx as nx

    drawn = graph(network)
    found = {
        frozenset(drawn.edges[edge]["name"] for edge in path) for path in nx.all_simple_edge_paths(drawn, PLUS, COIL)
    }
    return minimal(found)


def cuts(network: Network) -> set[frozenset[str]]:
    """Minimal sets of contacts that drop the coil when open (hit every path)."""
    ways = paths(network)
    names = sorted(frozenset().union(*ways))
    hits = (frozenset(some) for n in range(len(names) + 1) for some in combinations(names, n))
    return minimal({some for some in hits if all(some & way for way in ways)})


def minimal(sets: set[frozenset[str]]) -> set[frozenset[str]]:
    """Those that contain no other."""
    return {s for s in sets if not any(other < s for other in sets)}
