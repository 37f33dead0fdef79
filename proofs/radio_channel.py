"""Radio control: two slots a channel are as good as a memory of all messages ever sent.

The invariants of `radio_formulas` speak of each message by itself.  Suppose a channel with any number of slots, of
which in a cycle any one may take what is sent and any one is delivered.  Then, of each channel,

1. a slot's law reads no other slot: what is sent depends on slots only through what arrives;
2. all else reads the slots only through what arrives, which is one message a channel;
3. each invariant reads one slot, or none.

So the step of an invariant about the message in slot i, or about none, speaks of two messages of a channel at most: the
one in slot i, and the one that arrives, which may be the same.  Both are there with two slots, one in `one` and one in
`two`, in either place; the obligations of a channel with more slots are these with other names.  At power-up all
slots fare alike.  Hence what is proved with two slots holds for any number, that is for an air that forgets nothing.

`broken_rules` checks 1 to 3 on the terms, with a solver nowhere.
Source: section 9 [P]; the argument [D].
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from proofs.radio_formulas import Formula
from safety import Model, Seen
from safety.system import System
from safety.terms.graph import Term, rewrite, variable, variables
from safety.terms.values import build
from safety.tracing import trace

HEARD = (".stamp_heard", ".place_heard")


def slots_of(system: System) -> set[str]:
    """The paths of all slots."""
    return {path for path, kind in system.parts.items() if kind == "Slot"}


def read_slots(system: System, terms: Iterable[Term]) -> set[str]:
    """The slots that terms read."""
    names = {str(v.attr).rpartition(".")[0] for v in variables(list(terms))}
    return names & slots_of(system)


def _as_heard(old: Term, args: tuple[Term, ...]) -> Term:
    if old.op == "point" and str(old.attr).endswith(HEARD):
        return variable(f"{old.attr} (arrives)", old.sort)
    return build(old.op, args, old.attr, old.sort) if old.args else old


def broken_rules(model: type[Model], lemmas: Iterable[Formula] = (), left_open: tuple[str, ...] = ()) -> Iterator[str]:
    """In what a model or an invariant breaks 1 to 3; nothing where the argument stands."""
    system = trace(model, {}, left_open)
    slots = slots_of(system)
    if not slots:
        yield f"{system.name} has no slots"
    for s in system.states:
        own = s.path.rpartition(".")[0]
        others = read_slots(system, rewrite([s.next], _as_heard)) - {own}
        yield from (f"{1 if own in slots else 2}: {s.path} reads {other} itself" for other in sorted(others))
    for lemma in lemmas:
        read = read_slots(system, [lemma(Seen(system))])
        if len(read) > 1:
            yield f"3: {lemma.__name__} reads {' and '.join(sorted(read))}"
