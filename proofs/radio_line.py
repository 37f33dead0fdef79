"""Radio control: a line of n trains, by what two of them do.

Small-model argument. Put the followers of a line one behind the other, each as its leader's `Follower`. For each pair
of neighbours read, out of the line, a leader, a follower and the inputs of `TwoTrains`: the leader's brake is what its
own unit demands, the order to the follower what the cell behind it says, all else is an input of the line. If, read
so, every register begins as in `TwoTrains`, follows the same law, and the line assumes what its pairs do and no more,
then each run of the line is, for each pair, a run of `TwoTrains`; so whatever is proved of all its runs holds of each
pair.  A collision in a line is one of neighbours; so n does not matter as long as each further train is put on in the
same way.  What a pair takes as given, that its follower keeps its authority, is proved of a supervised train in any
surroundings (`radio_authority`), and each follower of the line is one.

`differences` checks the premise term by term, without a solver: the laws have to be the same terms.
`contract_differences` checks in the same way that each follower is the supervised train of the contract.  Both are
checked of lines of 2, 3 and 4 trains, found violated by a line whose ground takes the trains in the wrong order and by
a pair read at the wrong place; what follows is proved once more, directly, of three trains.
Source: section 10, AR-6, unique order of the trains [P]; the argument [D].
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from itertools import pairwise

from models.radio import Supervised, ThreeTrains, Train, TwoTrains
from proofs.radio_formulas import Pair
from safety import PROVED, REFUTED, Bit, Fault, Model, Seen, any_of_faults, claim, stuck
from safety.system import System, substitute
from safety.terms.graph import Term, rewrite, variables
from safety.terms.values import build
from safety.tracing import trace


@dataclass(frozen=True)
class Neighbours(Pair):
    """A pair in a line, and where its inputs come from: prefixes by the names of `TwoTrains`."""

    inputs: tuple[tuple[str, str], ...] = ()
    braked: str = "braked"
    behind: str = "order"

    def place(self, name: str) -> str:
        """The name in the line of a register or input of `TwoTrains`."""
        if name == "braked":
            return self.braked
        named = {"leader": self.leader, "follower": self.follower, "now": self.now, "order": self.behind}
        head, dot, rest = name.partition(".")
        return (named | dict(self.inputs)).get(head, head) + dot + rest


def _added(name: str) -> tuple[tuple[str, str], ...]:
    """The inputs of one more train."""
    return ("air", f"{name}.air"), ("wish", f"{name}.wish"), ("behind", f"{name}.motion")


def _behind(pair: Neighbours, follower: str, moves: str, added: str) -> Neighbours:
    """The pair of a pair's follower, whose motion is the input `moves`, and one more train."""
    driven = f"{pair.follower}.driven"
    return Neighbours(
        f"{driven}.train", follower, pair.now, inputs=(("ahead", moves), *_added(added)), braked=f"{driven}.brake"
    )


def neighbours(trains: int) -> list[Neighbours]:
    """The pairs in a line of 2, 3 or 4 trains, from the front."""
    if trains == 2:
        return [Neighbours()]
    front = "ahead." * (trains - 2)
    pairs = [
        Neighbours(f"{front}leader", f"{front}follower", f"{front}now", (("ahead", "first"), ("behind", "second")))
    ]
    pairs.append(_behind(pairs[0], "ahead." * (trains - 3) + "follower", "second", "third"))
    if trains == 4:
        pairs.append(_behind(pairs[1], "follower", "third.motion", "fourth"))
    return [replace(p, behind=after.follower) for p, after in pairwise(pairs)] + pairs[-1:]


# --- the check -------------------------------------------------------------------------------------------------------


def open_system(model: type[Model]) -> System:
    """A model with all its parameters left open, and without its points: nothing is broken."""
    found = trace(model, {}, ())
    names = tuple(name for name, setting in found.settings.items() if not isinstance(setting.value, bool))
    return trace(model, {}, names).mapped(lambda terms: rewrite(terms, _without_point))


def _without_point(old: Term, args: tuple[Term, ...]) -> Term:
    if old.op == "point":
        return args[0]
    return build(old.op, args, old.attr, old.sort) if old.args else old


def differences(line: type[Model], pair: Neighbours) -> Iterator[str]:
    """In what the pair is not the `TwoTrains` of the argument; nothing where it is."""
    return otherwise(TwoTrains, line, pair.place, unread=("beyond",))


def contract_differences(line: type[Model], pair: Neighbours) -> Iterator[str]:
    """In what the pair's follower is not the `Supervised` of the contract; nothing where it is."""

    def place(name: str) -> str:
        head, dot, rest = name.partition(".")
        read = {"now": pair.now, "came": f"{pair.follower}.authorities", "order": pair.behind}
        moves = dict(pair.inputs).get("behind", "behind")
        return (read | {"motion": moves}).get(head, f"{pair.follower}.driven.{head}") + dot + rest

    return otherwise(Supervised, line, place)


def otherwise(
    model: type[Model], line: type[Model], place: Callable[[str], str], unread: tuple[str, ...] = ()
) -> Iterator[str]:
    """In what a line, read at these places, is not the model; `unread` are inputs that only faults read."""
    lone, whole = open_system(model), open_system(line)
    leaves = {**{s.path: s.var for s in lone.states}, **lone.inputs}
    there_is = {name: place(name) in whole.names() for name in leaves if name not in unread}
    if not all(there_is.values()):
        yield from (f"there is no {place(name)}, read as {name}" for name, found in there_is.items() if not found)
        return
    read = {leaves[name].uid: whole.lookup(place(name)) for name in there_is}

    def there(term: Term) -> Term:
        return rewrite(substitute([term], read), _without_point)[0]

    for s in lone.states:
        found = whole.state[place(s.path)]
        if found.power_up != s.power_up:
            yield f"{found.path} begins otherwise than {s.path}"
        if there(s.next) is not found.next:
            yield f"{found.path} follows another law than {s.path}"
    granted = {a.uid for a in whole.assumptions.values()}
    yield from (f"{text!r} is not assumed" for text, a in lone.assumptions.items() if there(a).uid not in granted)
    if model is TwoTrains:
        yield from (f"{text!r} is assumed of the line, not of two trains" for text in unshared(whole, lone))


def unshared(whole: System, lone: System) -> Iterator[str]:
    """The assumptions of a line that none of its pairs makes: they might leave out runs."""
    for text, assumed in whole.assumptions.items():
        images = (_image(a, whole, text.removesuffix(own)) for own, a in lone.assumptions.items() if text.endswith(own))
        if not any(image is assumed for image in images):
            yield text


def _image(term: Term, whole: System, prefix: str) -> Term | None:
    """A term of the pair, read in the line with this before each name."""
    names = {v.uid: f"{prefix}{v.attr}" for v in variables([term])}
    if not set(names.values()) <= set(whole.names()):
        return None
    return rewrite(substitute([term], {uid: whole.lookup(name) for uid, name in names.items()}), _without_point)[0]


class Misordered(ThreeTrains):
    """A planted bug: the ground takes the first train for the one ahead of the third."""

    def next_ahead(self, second: Train, first: Train) -> Train:
        """The first train in place of the second."""
        return first


# --- three trains, directly ------------------------------------------------------------------------------------------

_, BACK = neighbours(3)


def given(s: Seen) -> Bit:
    """The third train keeps its authority; the ground allows for what the second rolls back."""
    return BACK.keeps_its_authority(s) & BACK.allowed_for(s)


@claim(ThreeTrains, expect=PROVED, requirement="AR-6", source="[D] cross-check of the small-model argument",
       start=BACK.commissioned, given=given, lemmas=BACK.lemmas(), symbolic=BACK.left_open)  # fmt: skip
def the_third_train_never_passes_the_second(s: Seen) -> Bit:
    """Of three trains the third never passes the rear of the second, whatever the first does."""
    return BACK.never_passed(s)


@claim(ThreeTrains, expect=REFUTED, requirement="AR-6", source="[D] section 10, AR-6: unique order",
       start=BACK.commissioned, given=given, symbolic=BACK.left_open, twin_of=the_third_train_never_passes_the_second,
       faults=any_of_faults([Fault(stuck(1), ["follower.cell.wrong_order"])]))  # fmt: skip
def even_in_the_wrong_order(s: Seen) -> Bit:
    """The same where the ground takes the first train for the one ahead of the third."""
    return the_third_train_never_passes_the_second(s)
