"""Common cause: closed forms, the brute truth table of groups written out by hand, and SCRAM's own reading of them."""

import math
import random
import re
import subprocess
from dataclasses import replace
from fractions import Fraction
from math import comb

import pytest

from safety.trees import BasicEvent, FaultTree, Gate, TreeError, solve
from safety.trees.common_cause import FIRST_LEVEL, CcfGroup, apply
from safety.trees.expressions.distributions import Uniform
from safety.trees.expressions.expression import MissionTime, Parameter
from safety.trees.expressions.lifetimes import Exponential
from safety.trees.formats.files import read_study, write
from safety.trees.over_time.averages import averages
from safety.trees.over_time.mission import Mission
from tests.trees.brute import Truth
from tests.trees.other_tools import SCRAM

Q, BETA = Fraction(1, 10), Fraction(1, 5)


def voted(n, k, q=Q):
    """Top if k of n alike fail."""
    names = tuple(f"B{i}" for i in range(n))
    return FaultTree("voted", "top", (Gate("top", "vote", names, k),), tuple(BasicEvent(name, q) for name in names))


def group(model, factors, n, **more):
    first = FIRST_LEVEL[model] or n
    levels = dict(enumerate(map(Fraction, factors), first))
    return CcfGroup("alike", model, tuple(f"B{i}" for i in range(n)), levels, **more)


def random_group(rng, model, n, **more):
    count = 1 if model == "beta-factor" else n - (model == "MGL")
    parts = [Fraction(rng.randint(1, 99), 100) for _ in range(count)]
    if model in ("alpha-factor", "phi-factor"):
        parts = [part / sum(parts) for part in parts]
    return group(model, parts, n, **more)


EVERY = [(model, n) for model in FIRST_LEVEL for n in (2, 3, 4, 5)]


# --- closed forms -----------------------------------------------------------------------------------------------------


def test_one_of_two_and_two_of_three_with_a_beta_factor():
    alone, common = (1 - BETA) * Q, BETA * Q
    both = solve(apply(voted(2, 2), [group("beta-factor", [BETA], 2)]))
    assert both.exact == common + (1 - common) * alone**2
    two = solve(apply(voted(3, 2), [group("beta-factor", [BETA], 3)]))
    assert two.exact == common + (1 - common) * (3 * alone**2 - 2 * alone**3)
    assert sorted(two.cut_sets()) == [
        ("B0-alone", "B1-alone"), ("B0-alone", "B2-alone"), ("B1-alone", "B2-alone"), ("CCF-B0-B1-B2",),
    ]  # fmt: skip


def test_alpha_factors_of_a_printed_example():
    """NUREG/CR-5485: of three with non-staggered testing, Q1 = a1 Q / at, Q2 = a2 Q / at, Q3 = 3 a3 Q / at."""
    alphas = [Fraction(95, 100), Fraction(3, 100), Fraction(2, 100)]
    whole = alphas[0] + 2 * alphas[1] + 3 * alphas[2]
    assert group("alpha-factor", alphas, 3).shares == {
        1: alphas[0] / whole, 2: alphas[1] / whole, 3: 3 * alphas[2] / whole,
    }  # fmt: skip
    staggered = group("alpha-factor", alphas, 3, testing="staggered").shares
    assert staggered == {1: alphas[0], 2: alphas[1] / 2, 3: alphas[2]}


def test_greek_letters_of_a_group_of_four():
    beta, gamma, delta = Fraction(1, 10), Fraction(1, 4), Fraction(1, 2)
    assert group("MGL", [beta, gamma, delta], 4).shares == {
        1: 1 - beta,
        2: beta * (1 - gamma) / 3,
        3: beta * gamma * (1 - delta) / 3,
        4: beta * gamma * delta,
    }


def test_a_beta_factor_is_the_greek_letters_with_all_others_one():
    assert group("beta-factor", [BETA], 4).shares == group("MGL", [BETA, 1, 1], 4).shares


@pytest.mark.parametrize("testing", ["non-staggered", "staggered"])
@pytest.mark.parametrize(("model", "n"), [case for case in EVERY if case[0] != "phi-factor"])
def test_what_contains_a_member_adds_up_to_its_total(model, n, testing):
    made = random_group(random.Random(n), model, n, testing=testing)
    tree = apply(voted(n, 1), [made])
    for member in made.members:
        inputs = tree.nodes[member].inputs
        assert sum(tree.nodes[name].probability for name in inputs) == Q
    assert sum(comb(n - 1, k - 1) * share for k, share in made.shares.items()) == 1


def test_phi_factors_are_shares_as_they_stand():
    phis = [Fraction(7, 10), Fraction(2, 10), Fraction(1, 10)]
    tree = apply(voted(3, 1), [group("phi-factor", phis, 3)])
    assert [tree.nodes[name].probability for name in ("B0-alone", "CCF-B0-B1", "CCF-B0-B1-B2")] == [
        phi * Q for phi in phis
    ]


@pytest.mark.parametrize(("model", "n"), EVERY)
def test_the_diagram_agrees_with_the_truth_table(model, n):
    rng = random.Random(f"{model} {n}")
    if n > 4 and model != "beta-factor":
        n = 4  # 15 events; 31 are too many rows
    tree = apply(voted(n, rng.randint(1, n)), [random_group(rng, model, n)])
    assert solve(tree).exact == Truth(tree).probability()


def test_levels_left_out_are_never_together():
    tree = apply(voted(3, 3), [group("MGL", [BETA], 3)])
    assert {event.name for event in tree.events} == {
        "B0-alone", "B1-alone", "B2-alone", "CCF-B0-B1", "CCF-B0-B2", "CCF-B1-B2",
    }  # fmt: skip


def test_other_events_and_gates_are_left_alone():
    plain = voted(2, 1)
    tree = FaultTree(
        "two", "all", (*plain.gates, Gate("all", "or", ("top", "C"))), (*plain.events, BasicEvent("C", Q, source="P"))
    )
    changed = apply(tree, [group("beta-factor", [BETA], 2)])
    assert changed.nodes["C"] == tree.nodes["C"] and changed.nodes["all"] == tree.nodes["all"]
    assert apply(tree, []) == tree


def test_a_member_of_another_tree_only_is_none_of_this_ones():
    tree = voted(2, 2)
    three = group("beta-factor", [BETA], 3)
    changed = apply(tree, [three], elsewhere={"B2"})
    assert {event.name for event in changed.events} == {"B0-alone", "B1-alone", "CCF-B0-B1-B2"}
    with pytest.raises(TreeError, match='names "B2", which is no basic event'):
        apply(tree, [three])


def test_a_group_with_a_total_gives_it_to_members_without_one():
    names = ("B0", "B1")
    tree = FaultTree("t", "top", (Gate("top", "and", names),), tuple(map(BasicEvent, names)))
    assert solve(apply(tree, [group("beta-factor", [BETA], 2)])).probability is None
    given = apply(tree, [group("beta-factor", [BETA], 2, total=Q)])
    assert given.nodes["CCF-B0-B1"].probability == BETA * Q


@pytest.mark.parametrize(
    ("model", "factors", "n", "message"),
    [
        ("gamma", {2: BETA}, 2, "is of model 'gamma', expected one of beta-factor"),
        ("beta-factor", {2: BETA}, 3, r"levels \[2\], expected level 3"),
        ("beta-factor", {2: 1.2}, 2, "the factor at level 2 1.2, expected 0 to 1"),
        ("beta-factor", {2: "x"}, 2, "the factor at level 2 of .* is 'x', expected a number"),
        ("beta-factor", {}, 2, r"levels \[\], expected level 2"),
        ("beta-factor", {1: BETA}, 1, "has 1 members, expected 2 or more"),
        ("MGL", {3: BETA}, 3, r"levels \[3\], expected every level from 2 on, at most to 3"),
        ("MGL", {2: BETA, 3: BETA, 4: BETA}, 3, "expected every level from 2 on"),
        ("alpha-factor", {1: 0.5, 3: 0.5}, 3, "expected every level from 1 on"),
        ("alpha-factor", {1: 0.5, 2: 0.4}, 2, "add up to 0.9, expected 1"),
        ("phi-factor", {1: 0.7, 2: 0.1, 3: 0.1}, 3, "add up to 0.9, expected 1"),
    ],
)
def test_a_group_that_is_none(model, factors, n, message):
    with pytest.raises(TreeError, match=message):
        CcfGroup("alike", model, tuple(f"B{i}" for i in range(n)), factors)


def test_members_twice_or_unlike():
    with pytest.raises(TreeError, match='names "B0" more than once'):
        CcfGroup("alike", "beta-factor", ("B0", "B0"), {2: BETA})
    one, other = group("beta-factor", [BETA], 2), CcfGroup("second", "beta-factor", ("B1", "B2"), {2: BETA})
    with pytest.raises(TreeError, match=r'"B1" is a member of common cause group "alike" and of .*"second"'):
        apply(voted(3, 2), [one, other])
    with pytest.raises(TreeError, match=r'"B0" has probability 0.1, but .* has 0.2; give them the same'):
        apply(voted(2, 2), [group("beta-factor", [BETA], 2, total=Fraction(1, 5))])
    tree = voted(2, 2)
    unlike = FaultTree("t", "top", tree.gates, (tree.events[0], BasicEvent("B1", Fraction(1, 3))))
    with pytest.raises(TreeError, match=r'"B1" has probability 0.333333, but'):
        apply(unlike, [one])
    with pytest.raises(TreeError, match="would become 1048575 events"):
        apply(voted(20, 2), [group("MGL", [BETA] * 19, 20)])


# --- SCRAM ------------------------------------------------------------------------------------------------------------


def scram_common_cause(cases, folder):
    """The file of all cases (name, k, group), and the top probability of each by SCRAM's `--ccf`, to about 12 digits.

    It prints six. So each tree is "top if a coin falls heads, else an event of our own probability rounded to six
    digits": the importance of the coin is then the difference, and that is printed to six digits again.
    """
    parts, rounded = [], {}
    for name, k, made in cases:
        ours = solve(apply(voted(made.size, k), [made])).probability
        rounded[name] = float(f"{ours:.6g}") * (1 + 2**-20)  # never equal, for 0 would show no digit
        members = "".join(f'<basic-event name="{name}-{member}"/>' for member in made.members)
        inner = "or" if k == 1 else "and" if k == made.size else "atleast"
        least = f' min="{k}"' if inner == "atleast" else ""
        levels = "".join(f'<factor level="{k}"><float value="{float(f)!r}"/></factor>' for k, f in made.factors.items())
        parts.append(
            f'<define-fault-tree name="{name}"><define-gate name="{name}-top"><or>'
            f'<and><basic-event name="{name}-coin"/><{inner}{least}>{members}</{inner}></and>'
            f'<and><not><basic-event name="{name}-coin"/></not><basic-event name="{name}-near"/></and></or>'
            f"</define-gate></define-fault-tree>"
            f'<define-CCF-group name="{name}-group" model="{made.model}"><members>{members}</members>'
            f'<distribution><float value="{float(Q)}"/></distribution><factors>{levels}</factors></define-CCF-group>'
            f'<model-data><define-basic-event name="{name}-coin"><float value="0.5"/></define-basic-event>'
            f'<define-basic-event name="{name}-near"><float value="{rounded[name]!r}"/></define-basic-event>'
            f"</model-data>"
        )
    path = folder / "groups.xml"
    path.write_text(f"<opsa-mef>{''.join(parts)}</opsa-mef>")
    printed = subprocess.run(
        [SCRAM, "--ccf", "1", "--probability", "1", "--importance", "1", "--bdd", str(path)],
        check=True, capture_output=True, text=True, timeout=120,
    ).stdout  # fmt: skip
    coins = re.findall(r'<basic-event name="([\w-]+)-coin" occurrence="\d+" probability="0.5" MIF="([^"]+)"', printed)
    return path, {name: rounded[name] + float(difference) for name, difference in coins}


@pytest.mark.skipif(SCRAM is None, reason="the program scram is not installed (Debian package scram)")
def test_scram_reads_the_groups_alike(tmp_path):
    rng = random.Random(7)
    cases = [
        (f"c{number}", rng.randint(1, n), random_group(rng, model, n))
        for number, (model, n) in enumerate(case for case in EVERY for _ in range(3))
    ]
    path, theirs = scram_common_cause(cases, tmp_path)
    assert len(theirs) == len(cases)
    study = read_study(path)
    for name, k, made in cases:
        ours = solve(apply(voted(made.size, k), [made])).probability
        assert ours == pytest.approx(theirs[name], rel=1e-9), (name, k, made)
        read = study.quantified(f"{name}-top")
        near = next(event.chance[0] for event in read.events if event.name == f"{name}-near")
        assert 2 * solve(read).probability - near == pytest.approx(ours, rel=1e-12)


# --- expressions ------------------------------------------------------------------------------------------------------


def test_uncertain_factors_and_totals_are_one_variable_each():
    beta, total = Uniform(Fraction(1, 10), Fraction(3, 10)), Exponential(Fraction(1, 10**4), MissionTime())
    made = CcfGroup("alike", "beta-factor", ("B0", "B1"), {2: beta}, total=total)
    names = ("B0", "B1")
    tree = FaultTree("t", "top", (Gate("top", "and", names),), tuple(map(BasicEvent, names)), mission_time_h=1000)
    changed = apply(tree, [made])
    q = total.value(1000)
    assert changed.nodes["CCF-B0-B1"].chance[0] == pytest.approx(0.2 * q, rel=1e-15)
    parameters = [set(event.expression.parameters) for event in changed.events]
    assert parameters == [{'the factor at level 2 of common cause group "alike"'}] * 3
    alone, common = 0.8 * q, 0.2 * q
    assert solve(changed).probability == pytest.approx(common + (1 - common) * alone**2, rel=1e-14)


@pytest.mark.parametrize(("model", "n"), EVERY)
def test_factors_as_parameters_give_the_same_figures(model, n):
    made = random_group(random.Random(n), model, n)
    named = {k: Parameter(f"factor {k}", factor) for k, factor in made.factors.items()}
    expressed = CcfGroup("alike", model, made.members, named, total=Parameter("q", Q))
    plain, other = (apply(voted(n, 1), [one]) for one in (made, expressed))
    assert [event.name for event in plain.events] == [event.name for event in other.events]
    for one, same in zip(plain.events, other.events, strict=True):
        assert same.exact_chance == one.exact_chance and "q" in same.expression.parameters


def test_a_rate_is_scaled_as_a_probability():
    names = ("B0", "B1")
    events = tuple(BasicEvent(name, rate_per_hour=Fraction(1, 10**4)) for name in names)
    tree = FaultTree("t", "top", (Gate("top", "and", names),), events, mission_time_h=1000)
    changed = apply(tree, [group("beta-factor", [BETA], 2)])
    assert changed.nodes["CCF-B0-B1"].chance[0] == pytest.approx(0.2 * tree.events[0].chance[0], rel=1e-15)
    with pytest.raises(TreeError, match=r"has the distribution 1.2, expected 0 to 1"):
        group("beta-factor", [BETA], 2, total=Parameter("q", Fraction(6, 5)))


def test_shares_of_a_rate_follow_the_mission():
    """A group of events with rates is the one with their law: 2 of 2, beta 0.1."""
    laws = {"rate_per_hour": Fraction(1, 10**5)}, {"expression": Exponential("1e-5", MissionTime())}
    group = CcfGroup("G", "beta-factor", ("a", "b"), {2: "0.1"})
    found = []
    for law in laws:
        events = tuple(BasicEvent(name, **law) for name in group.members)
        tree = FaultTree("t", "top", (Gate("top", "and", group.members),), events, mission_time_h=1000)
        found.append(averages(Mission(apply(tree, [group]))))
    assert found[0] == found[1] and found[0].frequency.high < 1.1e-6

    def q(hours):
        alone, common = (share * -math.expm1(-1e-5 * hours) for share in (0.9, 0.1))
        return 1 - (1 - common) * (1 - alone**2)

    assert sum(found[0].expected_failures) / 2 == pytest.approx(q(1000), rel=1e-12)
    own = tuple(BasicEvent(name, rate_per_hour="1e-5", mission_time_h=10) for name in group.members)
    apart = averages(Mission(apply(replace(tree, events=own), [group])))
    assert apart.frequency is None and "of a fixed time" in apart.unknown


STAGGERED = """<opsa-mef><define-fault-tree name="t"><define-gate name="top"><and><event name="a"/><event name="b"/>
</and></define-gate></define-fault-tree><define-CCF-group name="G" model="alpha-factor">{attributes}<members>
<basic-event name="a"/><basic-event name="b"/></members><distribution><float value="0.1"/></distribution><factors>
<factor level="1"><float value="0.9"/></factor><factor level="2"><float value="0.1"/></factor></factors>
</define-CCF-group></opsa-mef>"""
TESTING = '<attributes><attribute name="testing" value="{0}"/></attributes>'


@pytest.mark.parametrize(
    ("attributes", "q1", "q2"),
    [
        ("", Fraction(9, 110), Fraction(2, 110)),
        (TESTING.format("non-staggered"), Fraction(9, 110), Fraction(2, 110)),
        (TESTING.format("staggered"), Fraction(9, 100), Fraction(1, 100)),
    ],
)
def test_an_attribute_of_the_file_says_that_testing_is_staggered(tmp_path, attributes, q1, q2):
    (tmp_path / "t.xml").write_text(STAGGERED.format(attributes=attributes))
    study = read_study(tmp_path / "t.xml")
    assert solve(study.quantified()).exact == 1 - (1 - q2) * (1 - q1**2)
    for again in ("again.xml", "again.json"):
        write(study, tmp_path / again)
        assert read_study(tmp_path / again).ccf_groups == study.ccf_groups


def test_an_unknown_kind_of_testing_is_refused(tmp_path):
    (tmp_path / "t.xml").write_text(STAGGERED.format(attributes=TESTING.format("monthly")))
    with pytest.raises(TreeError, match="has testing 'monthly', expected non-staggered or staggered"):
        read_study(tmp_path / "t.xml")
