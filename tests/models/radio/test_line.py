"""Radio control: the two arguments about any number of trains and any number of messages, and that they can fail."""

from __future__ import annotations

from dataclasses import replace

import pytest

from models.radio import Air, FourTrains, Message, Motion, SetBack, Slot, Supervised, ThreeTrains, TwoTrains, Wish
from models.radio.moving_block import More
from proofs.radio_authority import stays_within_its_authority
from proofs.radio_channel import broken_rules
from proofs.radio_formulas import TWO
from proofs.radio_line import Misordered, Neighbours, contract_differences, differences, neighbours
from safety import Bit, Model, Real, Seen, all_of, assume, bit, point, power_up
from safety.system import substitute
from safety.tracing import trace

# --- n trains --------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("trains", "line", "pair"),
    [(n, line, k) for n, line in ((2, TwoTrains), (3, ThreeTrains), (4, FourTrains)) for k in range(n - 1)],
)
def test_every_pair_of_a_line_is_the_two_trains_of_the_claims(trains: int, line: type[Model], pair: int) -> None:
    assert list(differences(line, neighbours(trains)[pair])) == []
    assert list(contract_differences(line, neighbours(trains)[pair])) == []


def test_a_follower_that_is_not_the_one_of_the_contract_is_found() -> None:
    front, back = neighbours(3)
    found = list(contract_differences(ThreeTrains, replace(back, inputs=front.inputs)))
    assert "follower.driven.train.head follows another law than train.head" in found


def test_the_contract_says_of_a_follower_what_is_proved_of_a_supervised_train() -> None:
    """The very same formula, read at the follower's place."""
    lone, pair = trace(Supervised), trace(TwoTrains)
    there = {lone.lookup(name).uid: pair.lookup(f"follower.driven.{name}") for name in ("train.head", "unit.limit")}
    proved = stays_within_its_authority(Seen(lone))
    assert substitute([proved], there)[0] is TWO.keeps_its_authority(Seen(pair))


def test_a_ground_that_takes_the_trains_in_the_wrong_order_is_found() -> None:
    front, back = neighbours(3)
    assert list(differences(Misordered, front)) == []
    assert list(differences(Misordered, back))


class Hasty(ThreeTrains):
    """A planted bug: the third train's cell is told where the second has its head, not its rear."""

    def next_ahead(self, second: object, first: object) -> object:  # type: ignore[override]
        """The second train, one length further ahead."""
        return _Longer(second)


class _Longer:
    """A train as it would be with no length."""

    def __init__(self, train: object) -> None:
        self.parted, self.head, self.length = train.parted, train.head, train.length - train.length  # type: ignore[attr-defined]


def test_a_pair_that_follows_another_law_is_found() -> None:
    found = list(differences(Hasty, neighbours(3)[1]))
    assert any("follower.reports.one.says follows another law" in text for text in found)


class Assuming(ThreeTrains):
    """A planted bug: a line that leaves out the runs in which its first train moves."""

    def step(
        self, beyond: Real, order: SetBack, braked: Bit, air: Air, wish: Wish, first: Motion, second: Motion,
        third: More,
    ) -> ThreeTrains:  # fmt: skip
        """One cycle."""
        assume("the first train stands", first.way == 0)
        return super().step(beyond, order, braked, air, wish, first, second, third)


@pytest.mark.parametrize("pair", neighbours(3))
def test_a_line_that_assumes_more_than_its_pairs_is_found(pair: Neighbours) -> None:
    said = "'the first train stands' is assumed of the line, not of two trains"
    assert said in list(differences(Assuming, pair))


def test_a_pair_read_at_the_wrong_place_is_found() -> None:
    front, back = neighbours(3)
    assert list(differences(FourTrains, back))
    assert list(differences(ThreeTrains, type(back)(back.leader, back.follower, back.now, front.inputs)))


# --- any number of messages ------------------------------------------------------------------------------------------


def test_two_slots_stand_for_any_number_of_messages() -> None:
    assert list(broken_rules(TwoTrains, TWO.lemmas(), TWO.left_open)) == []


def test_an_invariant_of_two_messages_is_found() -> None:
    def in_order(s: Seen) -> Bit:
        return all_of(s.follower.reports.one.sent_at <= s.follower.reports.two.sent_at)

    assert [text[:2] for text in broken_rules(TwoTrains, [in_order])] == ["3:"]


class Chained(Model, tick_s="0.1"):
    """A planted bug: the second slot takes what the first one holds, and somebody reads a slot itself."""

    one: Slot
    two: Slot
    read: Real = power_up(0)

    def step(self, sent: Real) -> Chained:
        """One cycle."""
        one, first = self.one.step(bit(True), Message(sent, sent))
        two, _ = self.two.step(bit(True), Message(self.one.sent_at, self.one.says))
        return Chained(one=one, two=two, read=point("stamp_heard", first.stamp) + self.two.says)


def test_slots_that_read_one_another_are_found() -> None:
    found = list(broken_rules(Chained))
    assert "1: two.says reads one itself" in found
    assert "2: read reads two itself" in found


class NoRadio(Model, tick_s="0.1"):
    """Nothing to check."""

    a: Real = power_up(0)

    def step(self) -> NoRadio:
        """Nothing happens."""
        return NoRadio(a=self.a)


def test_a_model_without_slots_is_no_radio() -> None:
    assert list(broken_rules(NoRadio)) == ["NoRadio has no slots"]
