"""The failure modes are the rows of the fault table, and each acts in an equipment that has the component."""

from __future__ import annotations

import pytest

from models.patterns.failures import ADDED, TABLE, component_faults
from proofs.patterns_hazards import CHECKED, PLAIN_ONES

ROWS = """
track coil | missing or detuned | D | 200
track coil contact | welded | D | 20
track coil contact | open | S | 100
permanent magnet | lost or demagnetised | D | 10
clearing coil or supply | open | S | 200
on-board coil and oscillator | stops oscillating | S | 300
on-board coil and oscillator | frequency stuck | D | 30
speed generator | zero output | D | 150
speed generator | reads high | S | 50
function generator | value high | D | 100
function generator | value low or none | S | 100
gradient selector | wrong bin | D | 50
comparator | stuck below | D | 30
comparator | stuck above | S | 70
brake valve | fails to vent | D | 20
brake valve | coil open | S | 200
brake force | less than guaranteed | D | 100
code receiver | loss | S | 300
code receiver | decodes a higher code | D | 5
acknowledgement button | stuck closed | D | 50
program clock | fast | D | 20
program clock | stops | S | 20
"""


def test_list_is_the_table_row_by_row() -> None:
    rows = [[cell.strip() for cell in line.split("|")] for line in ROWS.strip().splitlines()]
    assert [[m.component, m.mode, m.direction, str(m.fit)] for m in TABLE] == rows


def test_every_mode_acts_somewhere() -> None:
    plain = {fault.name for one in PLAIN_ONES.values() for fault in component_faults(one.equipment)}
    assert plain == {row.name for row in TABLE}
    fitted = {fault.name for one in CHECKED.values() for fault in component_faults(one.equipment, ADDED)}
    assert fitted == {row.name for row in ADDED}


@pytest.mark.parametrize("way", PLAIN_ONES)
def test_names_of_an_equipment_are_told_apart(way: str) -> None:
    names = [fault.name for fault in component_faults(CHECKED[way].equipment, (*TABLE, *ADDED))]
    assert len(names) == len(set(names))
