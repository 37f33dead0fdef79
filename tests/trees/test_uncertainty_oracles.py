"""Sampled distributions against SCRAM's, on its own input files, from independent samples of both programs.

Level of the tests: 4 standard deviations of the difference, at fixed seeds of both; a distribution passes some 20 of
them, so that equal ones would fail at fewer than one in 700 seeds.
"""

from __future__ import annotations

import math
import re
import shutil
import subprocess
from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest

from safety.trees import read
from safety.trees.event_trees import uncertainty as sequences
from safety.trees.event_trees.answers import analyse
from safety.trees.formats.files import read_study
from safety.trees.solve import solve
from safety.trees.uncertainty.propagation import Uncertainty, propagate
from safety.trees.uncertainty.sampling import Plan

INPUT = Path("/", "usr", "share", "scram", "input")
N = 20_000
pytestmark = pytest.mark.skipif(
    shutil.which("scram") is None or not INPUT.is_dir(), reason="scram is not installed (Debian package scram)"
)


def scram(files: list[Path], hours: int, sequence: str = "") -> tuple[float, float, list[tuple[float, float]]]:
    """Mean, standard deviation, and (level, quantile), of a top event or of a sequence."""
    options = f"--probability 1 --uncertainty 1 --num-trials {N} --num-quantiles 20 --seed 12 --mission-time {hours}"
    run = subprocess.run(["scram", *options.split(), *map(str, files)], capture_output=True, text=True, timeout=60)
    which = f'<measure initiating-event="I" name="{sequence}"' if sequence else "<measure"
    measure = run.stdout[run.stdout.index(which) :].partition("</measure>")[0]
    mean, deviation = (
        float(re.search(rf'<{tag} value="([^"]+)"', measure)[1])  # type: ignore[index]
        for tag in ("mean", "standard-deviation")
    )
    found = re.findall(r'<quantile number="\d+" value="([^"]+)" lower-bound="[^"]+" upper-bound="([^"]+)"', measure)
    return mean, deviation, [(float(level), float(bound)) for level, bound in found if float(level) < 1]


def disagreements(found: Uncertainty, mean: float, deviation: float, quantiles: list[tuple[float, float]]) -> list[str]:
    wrong = []
    if abs(found.mean - mean) > 4 * math.hypot(found.standard_error, deviation / math.sqrt(N)):
        wrong.append(f"mean {found.mean} and {mean}")
    for level, bound in quantiles:
        below = np.searchsorted(found.ordered, bound) / found.values.size
        if abs(below - level) > 4 * math.sqrt(level * (1 - level) * 2 / N):
            wrong.append(f"{below} and {level} of the samples up to {bound}")
    return wrong


FILES = {"SmallTree": ["SmallTree.xml"], "BSCU": ["BSCU.xml"], "Chinese": ["mixed_mcs_prob.xml"]}


MIXED = """
<opsa-mef><define-fault-tree name="mixed">
  <define-gate name="top"><atleast min="2">
    <basic-event name="a"/><basic-event name="b"/><basic-event name="c"/><basic-event name="d"/><basic-event name="e"/>
  </atleast></define-gate>
  <define-basic-event name="a"><exponential><parameter name="rate"/><system-mission-time/></exponential>
  </define-basic-event>
  <define-basic-event name="b"><mul><float value="0.5"/><parameter name="share"/></mul></define-basic-event>
  <define-basic-event name="c"><uniform-deviate><float value="0.02"/><float value="0.2"/></uniform-deviate>
  </define-basic-event>
  <define-basic-event name="d"><GLM><float value="0"/><parameter name="rate"/><float value="1e-2"/>
    <system-mission-time/></GLM></define-basic-event>
  <define-basic-event name="e"><periodic-test><parameter name="hidden"/><float value="1000"/><float value="500"/>
    <system-mission-time/></periodic-test></define-basic-event>
  <define-parameter name="rate"><gamma-deviate><float value="2"/><float value="1e-5"/></gamma-deviate>
  </define-parameter>
  <define-parameter name="share"><beta-deviate><float value="2"/><float value="8"/></beta-deviate></define-parameter>
  <define-parameter name="hidden"><lognormal-deviate><float value="-9"/><float value="0.7"/></lognormal-deviate>
  </define-parameter>
</define-fault-tree></opsa-mef>
"""


def test_all_distributions_and_shared_parameters_agree_with_scram(tmp_path: Path) -> None:
    file = tmp_path / "mixed.xml"
    file.write_text(MIXED)
    found = propagate(solve(read(file, mission_time_h=8000)), Plan(N, seed=3))
    assert found.variables == ("c", "hidden", "rate", "share")
    assert disagreements(found, *scram([file], 8000)) == []


FORKS = """<define-initiating-event name="I" event-tree="after"/><define-event-tree name="after">
<define-functional-event name="F"/><define-functional-event name="G"/><define-sequence name="S"/>
<define-sequence name="T"/><define-sequence name="U"/><initial-state><fork functional-event="F">
<path state="works"><collect-formula><not><gate name="top"/></not></collect-formula><sequence name="S"/></path>
<path state="fails"><collect-formula><gate name="top"/></collect-formula><fork functional-event="G">
<path state="works"><collect-formula><not><basic-event name="e"/></not></collect-formula><sequence name="T"/></path>
<path state="fails"><collect-formula><basic-event name="e"/></collect-formula><sequence name="U"/></path>
</fork></path></fork></initial-state></define-event-tree>"""


@pytest.mark.parametrize("sequence", ["S", "T", "U"])
def test_the_sequences_of_an_event_tree_agree_with_scram(tmp_path: Path, sequence: str) -> None:
    """Successes that share parameters and events with failures."""
    file = tmp_path / "forks.xml"
    file.write_text(MIXED.replace("<opsa-mef>", "<opsa-mef>" + FORKS))
    study = read_study(file, mission_time_h=8000)
    answers = [(analyse(study, study.initiating_events[0]), Fraction(1))]
    found = sequences.propagate(answers, Plan(N, seed=3), study.mission_time_h)[0][sequence].probability
    peer = scram([file], 8000, sequence)
    assert len(peer[2]) > 15 and disagreements(found, *peer) == []
    assert disagreements(Uncertainty(found.values * 1.05, plan=found.plan), *peer)  # so much is seen


@pytest.mark.parametrize("name", FILES)
def test_the_distribution_is_that_of_scram(name: str) -> None:
    files = [INPUT / name / file for file in FILES[name]]
    if name == "Chinese":
        files.insert(0, INPUT / name / "chinese.xml")
    solution = solve(read(*files, mission_time_h=8760))
    found, peer = propagate(solution, Plan(N, seed=3)), scram(files, 8760)
    assert len(peer[2]) > 15 and disagreements(found, *peer) == []
    shifted = Uncertainty(found.values * 1.05, plan=found.plan)
    assert disagreements(shifted, *peer)  # so much is seen
