"""`rightside tree FILE` with common-cause groups."""

import json
from fractions import Fraction
from pathlib import Path

from tests.commands.conftest import Run

MEF = """<opsa-mef><define-fault-tree name="t"><define-gate name="top"><and><event name="a"/><event name="b"/></and>
</define-gate></define-fault-tree><model-data><define-basic-event name="a">{law}</define-basic-event>
<define-basic-event name="b">{law}</define-basic-event></model-data><define-CCF-group name="G" model="beta-factor">
<members><basic-event name="a"/><basic-event name="b"/></members><distribution>{law}</distribution>
<factor level="2"><float value="0.1"/></factor></define-CCF-group></opsa-mef>"""
EXPONENTIAL = '<exponential><float value="1e-4"/><system-mission-time/></exponential>'
REPAIRED = '<GLM><float value="0"/><float value="1e-4"/><float value="0.1"/><system-mission-time/></GLM>'


def test_the_mean_time_takes_the_shares_of_the_rates_and_says_so(run: Run, project: Path) -> None:
    (project / "t.xml").write_text(MEF.format(law=EXPONENTIAL))
    called = run("tree", "t.xml", "--hours", "1000", "--sil", "--json", "out.json")
    assert called.code == 0 and "common causes have their shares of the failure rates" in called.out
    found = json.loads((project / "out.json").read_text())["trees"][0]["mean_time_to_failure_h"]
    rate = Fraction(1, 10**4)
    exact = 2 / rate - 1 / (Fraction(19, 10) * rate)
    assert Fraction(found["exact"]) == exact and found["common_cause"] == "shares of failure rates"
    (project / "t.xml").write_text(MEF.format(law=REPAIRED))
    called = run("tree", "t.xml", "--hours", "1000", "--sil")
    assert called.code == 0 and 'no mean time to failure: basic event "a-alone" is repaired' in called.out
