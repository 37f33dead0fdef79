"""Uncertainty of event trees: every sample against the study solved anew with its numbers, spreads in closed form."""

import math
from fractions import Fraction

import numpy as np
import pytest
from scipy import stats

from safety.trees import TreeError
from safety.trees.event_trees.answers import analyse, consequences
from safety.trees.event_trees.summary import add_uncertainty, answers_of, event_tree_entries
from safety.trees.event_trees.uncertainty import propagate
from safety.trees.formats.files import read_study
from safety.trees.uncertainty.correlation import Correlation
from safety.trees.uncertainty.sampling import Plan

TREE = """<opsa-mef><define-initiating-event name="leak" event-tree="after">{often}</define-initiating-event>
<define-initiating-event name="fire" event-tree="after"><float value="0.001"/></define-initiating-event>
<define-event-tree name="after"><define-functional-event name="stop"/><define-functional-event name="people"/>
<define-sequence name="safe"/><define-sequence name="spill"/><define-sequence name="hurt"/>
<initial-state><fork functional-event="stop">
<path state="works"><collect-formula><not><gate name="g"/></not></collect-formula><sequence name="safe"/></path>
<path state="fails"><collect-formula><gate name="g"/></collect-formula><fork functional-event="people">
<path state="no"><collect-expression><sub><float value="1"/><parameter name="p"/></sub></collect-expression>
<sequence name="spill"/></path>
<path state="yes"><collect-expression><parameter name="p"/></collect-expression><sequence name="hurt"/></path>
</fork></path></fork></initial-state></define-event-tree>
<define-fault-tree name="t"><define-gate name="g"><or><event name="a"/><and><event name="b"/><event name="c"/></and>
</or></define-gate></define-fault-tree><model-data>
<define-parameter name="p">{p}</define-parameter><define-parameter name="rate" unit="hours-1">{rate}</define-parameter>
<define-basic-event name="a"><exponential><parameter name="rate"/><system-mission-time/></exponential>
</define-basic-event><define-basic-event name="b"><float value="0.2"/></define-basic-event>
<define-basic-event name="c">{c}</define-basic-event></model-data></opsa-mef>"""
LAWS = {
    "often": "<lognormal-deviate><float value='0.01'/><float value='5'/><float value='0.95'/></lognormal-deviate>",
    "p": "<uniform-deviate><float value='0.1'/><float value='0.5'/></uniform-deviate>",
    "rate": "<gamma-deviate><float value='2'/><float value='1e-4'/></gamma-deviate>",
    "c": "<normal-deviate><float value='0.1'/><float value='0.08'/></normal-deviate>",
}
SIGMA = math.log(5) / stats.norm.ppf(0.95)
INVERSE = {  # by another library, under the names of the random variables
    "frequency of leak": stats.lognorm(SIGMA, scale=0.01 * math.exp(-SIGMA * SIGMA / 2)).ppf,
    "p": stats.uniform(0.1, 0.4).ppf,
    "rate": stats.gamma(2, scale=1e-4).ppf,
    "c": stats.norm(0.1, 0.08).ppf,
}
FIGURES = dict(zip(INVERSE, LAWS, strict=True))


def study_of(tmp_path, text=TREE, **laws):
    path = tmp_path / "study.xml"
    path.write_text(text.format(**(LAWS | laws)))
    return read_study(path, mission_time_h=1000)


def answers(study):
    return [(analyse(study, initiating), Fraction(1)) for initiating in study.initiating_events]


@pytest.mark.parametrize("plan", [Plan(20, 3), Plan(20, 3, hypercube=True, blocks=2)], ids=["free", "hypercube"])
def test_each_sample_as_if_the_study_were_solved_anew(tmp_path, plan):
    study = study_of(tmp_path)
    found = propagate(answers(study), plan, study.mission_time_h)
    drawn = plan.uniforms(list(INVERSE))
    times_out = 0
    for i in range(plan.samples):
        values = {name: float(inverse(drawn[name][i])) for name, inverse in INVERSE.items()}
        times_out += values["c"] < 0
        values["c"] = max(0.0, values["c"])
        anew = study_of(tmp_path, **{FIGURES[name]: f"<float value='{x!r}'/>" for name, x in values.items()})
        again = answers(anew)
        everywhere = consequences(again)
        for (answer, _), spreads in zip(again, found, strict=True):
            for name, spread in spreads.items():
                for one, figure in (
                    (spread.probability, answer.sequences[name].probability),
                    (spread.frequency, answer.frequency_of(name)),
                    (spread.everywhere, everywhere[name]),
                ):
                    assert one.values[i] == pytest.approx(figure.value, rel=1e-11)
    assert times_out and found[0]["safe"].probability.outside == {"c": times_out}


def test_each_spread_names_what_it_depends_on(tmp_path):
    study = study_of(tmp_path)
    leak, fire = propagate(answers(study), Plan(20), study.mission_time_h)
    assert leak["safe"].probability.variables == fire["safe"].frequency.variables == ("c", "rate")
    assert leak["hurt"].frequency.variables == ("c", "frequency of leak", "p", "rate")
    assert fire["hurt"].frequency.variables == ("c", "p", "rate")
    assert fire["hurt"].everywhere.variables == ("c", "frequency of leak", "p", "rate")


def test_what_was_out_of_range_is_told_where_it_matters(tmp_path):
    study = study_of(tmp_path, often="<normal-deviate><float value='0.01'/><float value='0.02'/></normal-deviate>")
    leak, fire = propagate(answers(study), Plan(200), study.mission_time_h)
    assert leak["hurt"].probability.outside.keys() == {"c"} == fire["hurt"].frequency.outside.keys()
    assert leak["hurt"].frequency.outside.keys() == {"c", "frequency of leak"} == fire["hurt"].everywhere.outside.keys()
    assert leak["hurt"].frequency.values.min() == 0


def test_the_sequences_share_their_samples(tmp_path):
    study = study_of(tmp_path)
    for spreads in propagate(answers(study), Plan(500), study.mission_time_h):
        assert sum(one.probability.values for one in spreads.values()) == pytest.approx(np.ones(500), abs=1e-12)


GROUP = """<define-CCF-group name="G" model="beta-factor"><members><basic-event name="c"/><basic-event name="d"/>
</members><distribution>{0}</distribution><factor level="2">{1}</factor></define-CCF-group></opsa-mef>"""


def test_common_causes_with_an_uncertain_factor(tmp_path):
    """In sequences to which a member counts alone, together with its like, or both ways."""
    text = TREE.replace('<define-basic-event name="c">{c}</define-basic-event>', "").replace("{p}", LAWS["p"])
    text = text.replace('<event name="c"/></and>', '<event name="c"/><event name="d"/></and>')
    text = text.replace('<collect-expression><parameter name="p"/></collect-expression>', "")
    share = '<collect-expression><sub><float value="1"/><parameter name="p"/></sub></collect-expression>'
    text = text.replace(share, '<collect-formula><event name="d"/></collect-formula>')
    uniform = "<uniform-deviate><float value='0.05'/><float value='0.15'/></uniform-deviate>"
    (tmp_path / "group").mkdir()
    study = study_of(tmp_path, text.replace("</opsa-mef>", GROUP.format(LAWS["p"], uniform)))
    plan = Plan(8, 6)
    found = propagate(answers(study), plan, study.mission_time_h)[0]
    names = [variable for variable in found["spill"].probability.variables if variable != "rate"]
    total, factor = sorted(names)
    assert "the distribution of" in total and "the factor at level 2 of" in factor
    drawn = plan.uniforms([*names, "rate"])
    for i in range(plan.samples):
        q, beta, rate = INVERSE["p"](drawn[total][i]), 0.05 + 0.1 * drawn[factor][i], INVERSE["rate"](drawn["rate"][i])
        numbers = [f"<float value='{float(x)!r}'/>" for x in (q, beta)]
        anew = study_of(tmp_path / "group", text.replace("</opsa-mef>", GROUP.format(*numbers)),
                        rate=f"<float value='{float(rate)!r}'/>")  # fmt: skip
        again = analyse(anew, anew.initiating_events[0]).sequences
        for name in ("safe", "spill", "hurt"):
            assert found[name].probability.values[i] == pytest.approx(again[name].probability.value, rel=1e-11)


def test_one_event_in_closed_form(tmp_path):
    """Q uniform on 0..1, the frequency lognormal: Q itself, 1 - Q, and the mean of the product."""
    text = TREE.replace(
        '<or><event name="a"/><and><event name="b"/><event name="c"/></and>\n</or>', '<event name="c"/>'
    )
    study = study_of(tmp_path, text, c="<uniform-deviate><float value='0'/><float value='1'/></uniform-deviate>")
    leak = propagate(answers(study), Plan(20_000, 5), study.mission_time_h)[0]
    safe = leak["safe"]
    assert stats.kstest(safe.probability.values, "uniform").pvalue > 1e-4
    for level in (0.05, 0.5, 0.95):
        quantile = safe.probability.quantile(level, 0.999)
        assert quantile.low < level < quantile.high
    for one, mean in ((safe, 1 / 2), (leak["hurt"], 1 / 2 * 0.3), (leak["spill"], 1 / 2 * 0.7)):
        assert abs(one.probability.mean - mean) < 4 * one.probability.standard_error
        assert abs(one.frequency.mean - 0.01 * mean) < 4 * one.frequency.standard_error
    square = 0.01**2 * math.exp(SIGMA**2) / 3
    assert safe.frequency.standard_deviation == pytest.approx(math.sqrt(square - 0.005**2), rel=0.1)


def test_split_fractions_and_frequencies_may_be_correlated(tmp_path):
    study = study_of(tmp_path)
    both = Correlation(("frequency of leak", "p"), ((1, 1), (1, 1)))
    found = propagate(answers(study), Plan(300, correlation=both), study.mission_time_h)[0]
    often = found["hurt"].frequency.values / found["hurt"].probability.values
    p = found["hurt"].probability.values / (1 - found["safe"].probability.values)
    assert list(np.argsort(often)) == list(np.argsort(p))


ANONYMOUS = """<opsa-mef><define-initiating-event name="I" event-tree="tree"/><define-event-tree name="tree">
<define-functional-event name="F"/><define-sequence name="S"/><initial-state><fork functional-event="F">
<path state="1"><collect-formula><event name="a"/></collect-formula>{first}<sequence name="S"/></path>
<path state="2"><collect-formula><not><event name="a"/></not></collect-formula>{second}<sequence name="S"/></path>
</fork></initial-state></define-event-tree><define-rule name="share"><collect-expression>{law}</collect-expression>
</define-rule><model-data><define-basic-event name="a"><float value="0.5"/>
</define-basic-event></model-data></opsa-mef>"""
UNIFORM = "<uniform-deviate><float value='0'/><float value='1'/></uniform-deviate>"


@pytest.mark.parametrize(
    ("first", "second", "variance", "variables"),
    [
        (f"<collect-expression>{UNIFORM}</collect-expression>",) * 2 + (1 / 24, 2),
        ('<rule name="share"/>',) * 2 + (1 / 12, 1),
    ],
    ids=["written twice", "one rule"],
)
def test_a_distribution_is_one_variable_where_it_is_written(tmp_path, first, second, variance, variables):
    (tmp_path / "x.xml").write_text(ANONYMOUS.format(law=UNIFORM, first=first, second=second))
    study = read_study(tmp_path / "x.xml")
    (found,) = propagate(answers(study), Plan(20_000, 2))
    spread = found["S"].probability
    assert spread.standard_deviation**2 == pytest.approx(variance, rel=0.05) and len(spread.variables) == variables
    assert found["S"].frequency is None and found["S"].everywhere is None
    assert spread.mean == pytest.approx(0.5, abs=4 * spread.standard_error)


PHASED = "<define-alignment name='al'><define-phase name='day' time-fraction='0.75'/><define-phase name='night' "


def test_over_the_phases_of_an_alignment(tmp_path):
    house = "<set-house-event name='h'><constant value='true'/></set-house-event></define-phase></define-alignment>"
    text = TREE.replace('<event name="a"/><and>', '<event name="a"/><house-event name="h"/><and>').replace(
        "<model-data>", "<model-data><define-house-event name='h'><constant value='false'/></define-house-event>"
    )
    study = study_of(tmp_path, text.replace("</opsa-mef>", f"{PHASED}time-fraction='0.25'>{house}</opsa-mef>"))
    rows = answers_of(study)
    entries = event_tree_entries(study, rows)
    add_uncertainty(entries, rows, Plan(4000, 4), study.mission_time_h)
    leaks = {entry["phase"]: entry["sequences"] for entry in entries if entry["id"].startswith("leak")}
    day, night = leaks["day"], leaks["night"]
    key = "frequency_of_all_initiating_events_uncertainty"
    for one, other in zip(day, night, strict=True):
        assert one[key] == other[key]
    assert night[0]["id"] == "safe" and night[0]["uncertainty"]["mean"] == 0
    all_safe, alone = day[0][key]["mean"], day[0]["uncertainty"]["mean"]
    assert all_safe == pytest.approx(0.75 * alone * 0.011, rel=0.1)


def test_entries_have_the_fields_of_a_tree(tmp_path):
    study = study_of(tmp_path)
    rows = answers_of(study)
    entries = event_tree_entries(study, rows)
    add_uncertainty(entries, rows, Plan(200, 9, hypercube=True), study.mission_time_h)
    found = entries[0]["sequences"][2]
    for key in ("uncertainty", "frequency_uncertainty", "frequency_of_all_initiating_events_uncertainty"):
        assert {"method", "samples", "seed", "mean", "standard_error", "standard_deviation", "quantiles"} < found[
            key
        ].keys()
        assert found[key]["method"] == "Latin hypercube" and found[key]["quantiles"][0]["confidence"] is None


def test_what_is_refused(tmp_path):
    certain = {name: "<float value='0.1'/>" for name in LAWS}
    study = study_of(tmp_path, **certain)
    with pytest.raises(TreeError, match="the study holds no distribution"):
        propagate(answers(study), Plan(20), study.mission_time_h)
    bare = study_of(tmp_path, TREE.replace('<define-basic-event name="b"><float value="0.2"/></define-basic-event>',
                                           '<define-basic-event name="b"/>'))  # fmt: skip
    with pytest.raises(TreeError, match='basic event "b" has no probability'):
        propagate(answers(bare), Plan(20), bare.mission_time_h)
    with pytest.raises(TreeError, match="samples of 6 sequences take"):
        propagate(answers(study_of(tmp_path)), Plan(10**9), study.mission_time_h)
