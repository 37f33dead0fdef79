"""What the detectors of the fault table find in a cycle, where they are fitted."""

from __future__ import annotations

from typing import NamedTuple

from safety import Bit, any_of, bit


class Found(NamedTuple):
    """Which detector has found something in this cycle; those that are not fitted stay off."""

    contact: Bit = bit(False)  # the contact does not follow the signal; looked at on the ground only
    pair: Bit = bit(False)  # a point was announced, and neither stop nor proceed was read
    unread: Bit = bit(False)  # the code is red and no point was read; part of point and continuous transmission
    test_coil: Bit = bit(False)  # the oscillator does not answer to the test coil
    two_speeds: Bit = bit(False)
    two_patterns: Bit = bit(False)
    echo: Bit = bit(False)  # the gradient bin is not that of the ground
    dynamic_test: Bit = bit(False)  # the comparator does not answer to a speed that is too high
    valve_test: Bit = bit(False)
    brake_test: Bit = bit(False)
    two_codes: Bit = bit(False)
    watchdog: Bit = bit(False)  # the two clocks differ

    @property
    def on_board(self) -> Bit:
        """What brakes."""
        return any_of(*self[1:])
