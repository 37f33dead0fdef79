"""TS-7 relay circuits: the networks of contacts feed the coils of NB and EB exactly when the logic says so.

A network gives, by its paths, the sets of contacts that feed the coil; the claims compare this with the equation of the
relay in the model, for every state of the equipment and any behaviour of the channels.
Source: two out of three, dual fault, any reverse detection [P]; drawing of the circuits [R], rule (b) [A].
"""

from __future__ import annotations

from models.ts7.contacts import EB_CHAIN, NB_RULE_A, NB_RULE_B, Network, paths
from models.ts7.voting import BothMustBrake, CommonPart
from safety import PROVED, REFUTED, Bit, Seen, all_of, any_of, claim


def contact(s: Seen, name: str) -> Bit:
    """Whether a contact is closed: `chr_a`, `nbrr_a` or `rev_a` up; with `~`, down."""
    relay, n = name.removeprefix("~").split("_")
    up = {"chr": ~s.isolated[n], "nbrr": ~s.brakes[n], "rev": s[f"{n}.rev"]}[relay]
    return ~up if name.startswith("~") else up


def feeds(s: Seen, network: Network) -> Bit:
    """Whether some path of the network is closed."""
    return any_of(
        *(all_of(*(contact(s, name) for name in sorted(path))) for path in sorted(paths(network), key=sorted))
    )


@claim(CommonPart, anywhere=True, expect=PROVED, requirement="TS7-7", source="[P] two of three; circuit [R]")
def nb_circuit_is_two_of_three(s: Seen) -> Bit:
    """The contacts of NBRR feed the coil of NB exactly when the reference rule (a) releases the brake."""
    return s.nb_relay.coil == (s.supply & feeds(s, NB_RULE_A))


@claim(BothMustBrake, anywhere=True, expect=REFUTED, requirement="TS7-7", twin_of=nb_circuit_is_two_of_three)
def nb_circuit_of_rule_a_is_rule_b(s: Seen) -> Bit:
    """The same circuit obeys rule (b): it does not, once a channel is isolated."""
    return s.nb_relay.coil == (s.supply & feeds(s, NB_RULE_A))


@claim(BothMustBrake, anywhere=True, expect=PROVED, requirement="TS7-7", source="[A] rule (b)")
def nb_circuit_of_rule_b(s: Seen) -> Bit:
    """The circuit with back contacts of CHR feeds the coil of NB exactly when rule (b) releases the brake."""
    return s.nb_relay.coil == (s.supply & feeds(s, NB_RULE_B))


@claim(
    CommonPart,
    anywhere=True,
    expect=PROVED,
    requirement="TS7-13",
    source="[P] dual fault or any reverse detection; circuit [R]",
)
def eb_circuit_needs_two_in_service_and_no_reverse(s: Seen) -> Bit:
    """The EB relay is fed exactly while two channels are in service and none detects reverse motion."""
    return s.eb_relay.coil == (s.supply & feeds(s, EB_CHAIN))


@claim(
    CommonPart,
    anywhere=True,
    expect=REFUTED,
    requirement="TS7-13",
    twin_of=eb_circuit_needs_two_in_service_and_no_reverse,
)
def eb_circuit_without_the_reverse_contacts(s: Seen) -> Bit:
    """The same chain with the contacts of reverse detection bridged."""
    bridged = tuple(c for c in EB_CHAIN if not c.name.startswith("~rev"))
    return s.eb_relay.coil == (s.supply & feeds(s, bridged))
