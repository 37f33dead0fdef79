"""Damaged files: whatever is done to a valid one, reading gives a study or a TreeError that names the file."""

import random
import re

import pytest

from safety.trees import TreeError
from safety.trees.formats.files import read_study
from tests.trees.test_bad_input import FACTOR, HEAD, HYPOTHESIS, MEMBERS, TARGET, TOTAL, beside, group, substitution

ALIGNMENT = '<define-alignment name="al"><define-phase name="p" time-fraction="1"/></define-alignment>'
WHOLE = {
    "xml": substitution(HYPOTHESIS, TARGET).replace("</opsa-mef>", "")
    + group(MEMBERS, TOTAL, FACTOR).partition("\n")[2].replace("</opsa-mef>", "")
    + beside(ALIGNMENT).partition("\n")[2],
    "dag": "t\ng := (a & b | @(2, [c, d, ~e])) <=> f; h := a ^ c; p(a) = 0.1; s(b) = true;",
    "json": f"""{HEAD},
 "basic_events": [{{"name": "a", "expression": {{"exponential": [{{"parameter": "x"}}, "1"]}}}}],
 "parameters": [{{"name": "x", "expression": {{"uniform-deviate": ["0", "1"]}}}}],
 "substitutions": [{{"name": "s", "hypothesis": "a", "target": false}}],
 "alignments": [{{"name": "al", "phases": [{{"name": "p", "fraction": 1, "house": []}}]}}]}}""",
    "dft": 'toplevel "t"; "t" or "a" "b"; "b" 2of3 "a" "c" "d"; "a" lambda=1e-3 dorm=0; "c" prob=0.1; "d" lambda=1;',
}
SCRAPS = b'< /> " { ] 1.3 -1 1e999 NaN null \xff \0 := @( 999999999999999999999999999999'.split()


def damaged(text, chance):
    """`text` after one to three changes of a kind that editors, networks and people make."""
    for _ in range(chance.randint(1, 3)):
        start = chance.randrange(len(text) + 1)
        end = min(len(text), start + chance.choice([1, 2, 5, 20, 80]))
        match chance.randrange(5):
            case 0:
                text = text[:start] + text[end:]
            case 1:
                text = text[:start] + chance.choice(SCRAPS) + text[start:]
            case 2:
                text = text[:end] + text[start:end] + text[end:]
            case 3:
                text = text[:start]
            case _:
                words = [found.span() for found in re.finditer(rb'"[^"]*"|[\w.-]+', text)]
                (a, b), (c, d) = chance.choices(words or [(0, 0)], k=2)
                text = text[:a] + text[c:d] + text[b:]
    return text


@pytest.mark.parametrize("ending", WHOLE)
def test_damaged_files_give_a_tree_or_a_tree_error(tmp_path, ending):
    chance, path, refused = random.Random(7), tmp_path / "f", 0
    whole = WHOLE[ending].encode()
    path.write_bytes(whole)
    read_study(path, mission_time_h=1)
    for _ in range(250):
        path.write_bytes(damaged(whole, chance))
        try:
            read_study(path, mission_time_h=1)
        except TreeError as error:
            assert str(path) in str(error)
            refused += 1
    assert refused > 60
