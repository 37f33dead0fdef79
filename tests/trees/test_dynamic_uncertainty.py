"""Uncertainty of dynamic trees: every sample against the tree solved anew with its numbers, spreads in closed form."""

import math

import numpy as np
import pytest
from scipy import stats

from safety.trees import TreeError, solve
from safety.trees.dynamic.data import static_with_data, with_data
from safety.trees.dynamic.samples import probabilities
from safety.trees.dynamic.solve import solve_dynamic
from safety.trees.dynamic.uncertainty import propagate
from safety.trees.formats.files import read_study
from safety.trees.formats.galileo import read_galileo
from safety.trees.uncertainty.sampling import Plan

PLANT = """toplevel T; T or S L X; S wsp A B; L pand C D; X and E F;
A lambda=1e-4; B lambda=1e-4 dorm=0.3; C lambda=1e-4; D lambda=2e-4; E prob=0.1; F lambda=1e-4;"""
RATE = '<define-basic-event name="{0}"><exponential>{1}<system-mission-time/></exponential></define-basic-event>'
GAMMA = '<gamma-deviate><float value="2"/><float value="1e-4"/></gamma-deviate>'
LOGNORMAL = '<lognormal-deviate><float value="1e-4"/><float value="3"/><float value="0.95"/></lognormal-deviate>'
UNIFORM = '<uniform-deviate><float value="0.05"/><float value="0.15"/></uniform-deviate>'
SHARED = '<parameter name="pump rate"/>'
DATA = (
    f'<define-parameter name="pump rate" unit="hours-1">{LOGNORMAL}</define-parameter>'
    + RATE.format("A", SHARED)
    + RATE.format("B", SHARED)
    + RATE.format("D", GAMMA)
    + f'<define-basic-event name="E">{UNIFORM}</define-basic-event>'
)
SIGMA = math.log(3) / stats.norm.ppf(0.95)
INVERSE = {
    "pump rate": stats.lognorm(SIGMA, scale=1e-4 * math.exp(-SIGMA * SIGMA / 2)).ppf,
    "D/1": stats.gamma(2, scale=1e-4).ppf,
    "E": stats.uniform(0.05, 0.1).ppf,
}


def tree(text=PLANT):
    return read_galileo(text.encode(), "plant.dft")


def data_of(tmp_path, text=DATA):
    (tmp_path / "data.xml").write_text(f"<opsa-mef><model-data>{text}</model-data></opsa-mef>")
    return read_study(tmp_path / "data.xml").events


@pytest.mark.parametrize("plan", [Plan(20, 3), Plan(20, 3, hypercube=True, blocks=2)], ids=["free", "hypercube"])
def test_each_sample_as_if_the_tree_were_solved_anew(tmp_path, plan):
    known = with_data(tree(), data_of(tmp_path))
    found = propagate(solve_dynamic(known.tree), known, 1000, plan)
    drawn = plan.uniforms(["D", "E", "pump rate"])
    for i in range(plan.samples):
        rate, d, e = (
            float(INVERSE[name](drawn[variable][i]))
            for name, variable in (("pump rate", "pump rate"), ("D/1", "D"), ("E", "E"))
        )
        text = PLANT.replace("A lambda=1e-4", f"A lambda={rate!r}").replace("B lambda=1e-4", f"B lambda={rate!r}")
        text = text.replace("D lambda=2e-4", f"D lambda={d!r}").replace("prob=0.1", f"prob={e!r}")
        assert found.values[i] == pytest.approx(float(solve_dynamic(tree(text)).probability(1000).middle), rel=1e-11)
    assert found.variables == ("D", "E", "pump rate")


def test_data_stand_in_place_of_what_the_tree_says(tmp_path):
    known = with_data(
        tree(), data_of(tmp_path, DATA + '<define-basic-event name="F"><float value="0.3"/></define-basic-event>')
    )
    nodes = known.tree.nodes
    assert float(nodes["A"].rate_per_hour) == 1e-4 and float(nodes["D"].rate_per_hour) == 2e-4
    assert nodes["B"].dormancy == tree().nodes["B"].dormancy and nodes["C"] == tree().nodes["C"]
    assert nodes["F"].probability == nodes["E"].probability * 3 and nodes["F"].rate_per_hour is None
    assert known.rates.keys() == {"A", "B", "D"} and known.chances.keys() == {"E"}


def test_one_event_in_closed_form(tmp_path):
    """A cold spare of equal parts of one rate: 1 - (1 + x) exp(-x), which rises with the rate, so do its quantiles."""
    known = with_data(
        tree("toplevel T; T csp A B; A lambda=1; B lambda=1;"),
        data_of(tmp_path, DATA.split('<define-basic-event name="D')[0]),
    )
    found = propagate(solve_dynamic(known.tree), known, 20_000, Plan(5000, 8))

    def failed(rate):
        return -math.expm1(-20_000 * rate) - 20_000 * rate * math.exp(-20_000 * rate)

    for level in (0.05, 0.5, 0.95):
        quantile = found.quantile(level, 0.999)
        assert quantile.low < failed(INVERSE["pump rate"](level)) < quantile.high
    grid = (np.arange(20_000) + 0.5) / 20_000
    exact = np.mean([failed(rate) for rate in INVERSE["pump rate"](grid)])
    assert abs(found.mean - exact) < 4 * found.standard_error


def test_equal_parts_with_variables_of_their_own_are_told_apart(tmp_path):
    text = "toplevel T; T pand G C; G and A B; A lambda=1e-4; B lambda=1e-4; C lambda=1e-4;"
    shared = with_data(tree(text), data_of(tmp_path, DATA.split('<define-basic-event name="D')[0]))
    own = with_data(tree(text), data_of(tmp_path, RATE.format("A", LOGNORMAL) + RATE.format("B", LOGNORMAL)))
    plan = Plan(40, 2)
    for known, variables in ((shared, ("pump rate",)), (own, ("A", "B"))):
        found = propagate(solve_dynamic(known.tree), known, 1000, plan)
        drawn = plan.uniforms(list(variables))
        rates = {
            name: INVERSE["pump rate"](drawn[variable])
            for name, variable in zip("AB", variables * 2, strict=False)
        }  # fmt: skip
        anew = probabilities(solve_dynamic(known.tree, symmetry=False), rates, 1000)
        assert found.variables == variables and list(found.values) == pytest.approx(list(anew), rel=1e-11)


@pytest.mark.parametrize(
    ("gates", "timed"), [("T pand G Z; G and A B C;", "C"), ("T pand G Z; G or X Y; X and A C; Y and B D;", "CD")]
)
def test_uncertain_probabilities_of_parts_that_are_alike_once_they_are_there(tmp_path, gates, timed):
    """Given that A and B are there they are alike, and X and Y are if C and D have one rate; their figures are not."""
    spans = {"A": (0, 0.2), "B": (0.1, 0.3)} | {name: (1e-3, 3e-3) for name in timed}

    def anew(figures):
        told = "".join(f"{name} {'prob' if name in 'AB' else 'lambda'}={x!r};" for name, x in figures.items())
        return solve_dynamic(tree(f"toplevel T; {gates} Z lambda=1e-3; {told}"))

    mean = anew({name: (low + high) / 2 for name, (low, high) in spans.items()})
    laws = ""
    for name, (low, high) in spans.items():
        law = f'<uniform-deviate><float value="{low}"/><float value="{high}"/></uniform-deviate>'
        chance = f'<define-basic-event name="{name}">{law}</define-basic-event>'
        laws += chance if name in "AB" else RATE.format(name, law)
    known, plan = with_data(mean.tree, data_of(tmp_path, laws)), Plan(6, 4)
    found, drawn = propagate(solve_dynamic(known.tree), known, 1000, plan), plan.uniforms([*spans])
    for i in range(plan.samples):
        figures = {name: float(low + (high - low) * drawn[name][i]) for name, (low, high) in spans.items()}
        assert found.values[i] == pytest.approx(float(anew(figures).probability(1000).middle), rel=1e-11)


def test_a_static_tree_with_data_is_a_static_tree(tmp_path):
    events = data_of(tmp_path, RATE.format("A", GAMMA))
    static = static_with_data(tree("toplevel T; T or A B; A lambda=1; B prob=0.25;"), events, 1000)
    assert solve(static).probability == pytest.approx(1 - 0.75 * math.exp(-0.2))
    assert static.events[0].expression == events[0].expression


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (RATE.format("Z", GAMMA), 'data are of "Z", which is no basic event of the tree "T"'),
        ('<define-basic-event name="A"/>', '"A" has neither a constant rate nor a constant probability'),
        (
            '<define-basic-event name="A"><GLM><float value="0"/><float value="1e-3"/><float value="1"/>'
            "<system-mission-time/></GLM></define-basic-event>",
            '"A" has neither a constant rate',
        ),
        (
            '<define-basic-event name="A"><exponential><float value="1e-3"/><float value="10"/></exponential>'
            "</define-basic-event>",
            '"A" has neither a constant rate',
        ),
        (RATE.format("A", "<neg><float value='1'/></neg>"), "failure rate is -1|is -1, expected 0 or more"),
        (
            RATE.format("A", "<normal-deviate><float value='0'/><float value='1e-4'/></normal-deviate>"),
            'the rate of "A" is uncertain with mean 0',
        ),
    ],
)
def test_wrong_data_are_refused(tmp_path, text, message):
    with pytest.raises(TreeError, match=message):
        with_data(tree(), data_of(tmp_path, text))


def test_fixed_probabilities_inside_a_chain(tmp_path):
    """Also of what is triggered at once, and beside rates that are sampled."""
    text = "toplevel T; T or L S; L pand C D E; S wsp A B; F fdep C B; C prob=0.1; D prob=0.5; E lambda=1e-3;"
    text += "A lambda=1e-3; B lambda=1e-3 dorm=0.5;"
    laws = "".join(f'<define-basic-event name="{name}">{UNIFORM}</define-basic-event>' for name in "CD")
    known = with_data(tree(text), data_of(tmp_path, laws + RATE.format("E", GAMMA)))
    solution, plan = solve_dynamic(known.tree), Plan(10, 4)
    assert {"C", "D"} <= {event.name for event in solution.states["T"].tree.events}
    found, drawn = propagate(solution, known, 1000, plan), plan.uniforms(["C", "D", "E"])
    for i in range(plan.samples):
        c, d = (float(INVERSE["E"](drawn[name][i])) for name in "CD")
        rate = float(INVERSE["D/1"](drawn["E"][i]))
        anew = text.replace("prob=0.1", f"prob={c!r}").replace("prob=0.5", f"prob={d!r}")
        anew = anew.replace("E lambda=1e-3", f"E lambda={rate!r}")
        assert found.values[i] == pytest.approx(float(solve_dynamic(tree(anew)).probability(1000).middle), rel=1e-11)


def test_too_many_of_them_are_refused(tmp_path, monkeypatch):
    known = with_data(
        tree("toplevel T; T pand C D E; C prob=0.1; D prob=0.5; E lambda=1e-3;"),
        data_of(
            tmp_path, "".join(f'<define-basic-event name="{name}">{UNIFORM}</define-basic-event>' for name in "CD")
        ),
    )
    monkeypatch.setattr("safety.trees.dynamic.samples.MOST_CHANCES", 1)
    with pytest.raises(TreeError, match=r'chain of "T" has 2 uncertain probabilities .* at most 1 are sampled'):
        propagate(solve_dynamic(known.tree), known, 1000, Plan(20))


def test_rates_that_differ_too_much_are_refused(tmp_path, monkeypatch):
    known = with_data(tree(), data_of(tmp_path))
    monkeypatch.setattr("safety.trees.dynamic.samples.MOST_STEPS", 50)
    with pytest.raises(TreeError, match="more than 51 steps are too many"):
        propagate(solve_dynamic(known.tree), known, 30_000, Plan(20))


def test_what_cannot_be_sampled_is_refused(tmp_path):
    certain = with_data(tree(), data_of(tmp_path, RATE.format("A", "<float value='1e-3'/>")))
    with pytest.raises(TreeError, match='tree "T" holds no distribution'):
        propagate(solve_dynamic(certain.tree), certain, 1000, Plan(20))
    solution = solve_dynamic(tree())
    for chances, message in (
        ({"A": [0.5]}, '"A", which is no event with a probability'),
        ({"E": [1.5]}, "is 1.5, expected 0 to 1"),
    ):
        with pytest.raises(TreeError, match=message):
            probabilities(solution, {"C": [1.0]}, 1.0, chances)
