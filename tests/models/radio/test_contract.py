"""Radio control: the train watched, of which the contract is proved for all parameters, is the train."""

from __future__ import annotations

import pytest

from models.kinematics import CYCLE
from models.radio import Arrival, Drive, Motion, SetBack, Supervised
from models.radio.watched import Watched
from proofs import radio_authority, radio_contract
from proofs.radio_contract import watched_differences
from safety import Model, Real, Seen, assume
from safety.system import substitute
from safety.tracing import trace


def test_the_train_watched_is_the_supervised_train() -> None:
    assert list(watched_differences()) == []


def test_the_contract_is_the_one_of_the_supervised_train() -> None:
    """The very same formula, read at the watched train's place."""
    lone, watched = trace(Supervised), trace(Watched)
    there = {lone.lookup(name).uid: watched.lookup(f"driven.{name}") for name in ("train.head", "unit.limit")}
    proved = radio_authority.stays_within_its_authority(Seen(lone))
    assert substitute([proved], there)[0] is radio_contract.stays_within_its_authority(Seen(watched))


class Meddling(Model, tick_s=CYCLE):
    """A planted bug: the observer holds the train fast."""

    driven: Supervised

    def step(self, now: Real, came: Arrival, order: SetBack, motion: Motion) -> tuple[Meddling, Drive]:
        """One cycle."""
        driven, drive = self.driven.step(now, came, order, motion._replace(way=motion.way - motion.way))
        return Meddling(driven=driven), drive


class Assuming(Model, tick_s=CYCLE):
    """A planted bug: the observer leaves out the runs in which the train moves."""

    driven: Supervised

    def step(self, now: Real, came: Arrival, order: SetBack, motion: Motion) -> tuple[Assuming, Drive]:
        """One cycle."""
        assume("the train stands", motion.way == 0)
        driven, drive = self.driven.step(now, came, order, motion)
        return Assuming(driven=driven), drive


@pytest.mark.parametrize(
    ("watched", "found"),
    [
        (Meddling, "driven.train.head follows another law than train.head"),
        (Assuming, "'the train stands' is assumed of the train watched, not of the train"),
    ],
)
def test_an_observer_that_does_more_than_observe_is_found(watched: type[Model], found: str) -> None:
    assert found in list(watched_differences(watched))
