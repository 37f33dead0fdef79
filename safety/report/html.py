"""The report as one HTML file: no request leaves it, and it reads the same on paper and without its one script.

The script unfolds fault trees; the page allows it by its hash and nothing else to run.
"""

from __future__ import annotations

import base64
import hashlib
import re
from collections import Counter
from collections.abc import Callable, Iterable, Mapping, Sequence
from pathlib import Path

from jinja2 import Environment, FileSystemLoader, StrictUndefined
from markupsafe import Markup

from safety.report import results as documents
from safety.report.assumed import MARK, assumed_mode, assumed_set, rests_on_assumed
from safety.report.bars_svg import CLASSES, classes_bar, interval_svg
from safety.report.event_tree_svg import event_tree_svg
from safety.report.figures import by_paper, counted, published, unjudged, word
from safety.report.gaps import gaps, parameters
from safety.report.histogram_svg import bins, histogram_svg
from safety.report.numbers import TAGS, bracket_text, cell_text, clean, exact_text, faults_text, number
from safety.report.plot_svg import plot_svg
from safety.report.sarif import replay_command
from safety.report.schema import SECTIONS, Entry
from safety.report.standing import WORDS, exit_code, judge, standing
from safety.report.timing_svg import timing_svg
from safety.report.trace import Trace
from safety.report.tree_layout import SIZES
from safety.report.tree_shapes import STYLE
from safety.report.tree_svg import tree_pages, tree_svg
from safety.report.uncertainty_svg import distribution_svg, tornado_svg

TEMPLATES = Path(__file__).parent / "templates"
SCRIPT = (TEMPLATES / "trees.js").read_text(encoding="utf-8")
STYLES = ("style.css", "timing.css", "trees.css")
VERDICTS = ("proved", "bounded", "vacuous", "refuted", "undecided")
CELLS = 12  # ticks in a table of changed cells
TREE_PAGES = 30  # of a fault tree; its own file has all
LISTED = 40  # cut sets and events of a tree; results.json may have more
BOUNDS = "Bounds over reals"
MEASURES = ("fussell_vesely", "birnbaum", "criticality", "risk_achievement_worth", "risk_reduction_worth")
FIGURES = {
    "lambda_s": ("λS /h", "rate of safe failures"),
    "lambda_dd": ("λDD /h", "rate of dangerous failures that are detected"),
    "lambda_du": ("λDU /h", "rate of dangerous failures that are not detected"),
    "diagnostic_coverage": ("DC", "diagnostic coverage"),
    "safe_failure_fraction": ("SFF", "safe failure fraction"),
}  # of a failure mode
SHOWN = 8  # items of a gap that stand open; the rest unfolds


def html(results: documents.Results, timings: bool = False) -> str:
    """The whole page. With timings it also shows seconds, solver versions and runs, and is no longer reproducible."""
    fixed = documents.canonical(results)
    shown = documents.merge({section: [] for section in SECTIONS}, results) if timings else fixed
    shown = shown | {"parameters": parameters(shown)}
    page = (
        _environment(shown)
        .get_template("report.html.j2")
        .render(
            results=shown,
            timings=timings,
            title=shown.get("project") or "Safety evidence",
            code=exit_code(shown),
            judged=list(judge(shown)),
            gaps=gaps(shown),
            papers=by_paper(shown.get("figures", ())),
            printed=published(shown.get("figures", ())),
            figure_counts=counted(published(shown.get("figures", ()))),
            unjudged=unjudged(shown.get("figures", ())),
            models=_models(shown.get("claims", [])),
            verdicts=Counter(claim["verdict"] for claim in shown.get("claims", ())),
            refuted=[claim for claim in shown.get("claims", ()) if claim.get("counterexample")],
            digest=hashlib.sha256(documents.dumps(fixed).encode()).hexdigest(),
        )
    )
    return clean(page)


def slugs(entries: Iterable[Entry]) -> list[str]:
    """A name for each entry that is fit for files and anchors, and unique even where case does not count."""
    taken: set[str] = set()
    names = []
    for entry in entries:
        name = slug = re.sub(r"[^A-Za-z0-9_.]+", "-", "-".join(filter(None, documents.key(entry)))).strip("-.") or "x"
        count = 1
        while slug.casefold() in taken:
            count += 1
            slug = f"{name}-{count}"
        taken.add(slug.casefold())
        names.append(slug)
    return names


def picture(tree: Entry) -> str:
    """A fault tree as one SVG, empty without a structure; ResultsError when the structure is none."""
    return "".join(_drawn(tree, lambda: [tree_svg(tree)]))


def _drawn(tree: Entry, draw: Callable[[], list[str]]) -> list[str]:
    try:
        return draw()
    except (AttributeError, KeyError, RecursionError, TypeError, ValueError) as bad:
        raise documents.ResultsError(f"trees ({tree['id']}): structure: cannot be drawn: {bad}") from None


def plotted(exhibit: Entry, ident: str) -> str:
    """A plot as SVG, `ident` unique in a page; ResultsError when its marks or axes are none."""
    try:
        return plot_svg(exhibit, ident)
    except (AttributeError, KeyError, OverflowError, TypeError, ValueError, ZeroDivisionError) as bad:
        raise documents.ResultsError(f"exhibits ({exhibit['id']}): cannot be drawn: {bad}") from None


def _environment(results: documents.Results) -> Environment:
    environment = Environment(
        loader=FileSystemLoader(TEMPLATES),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    anchors = {
        (section, *documents.key(entry)): f"{section}-{slug}"
        for section in SECTIONS
        for entry, slug in zip(results.get(section, ()), slugs(results.get(section, ())), strict=True)
    }
    environment.filters["number"] = number
    environment.filters["exact"] = exact_text
    environment.filters["bracket"] = bracket_text
    environment.filters["faults"] = faults_text
    environment.filters["cell"] = cell_text
    environment.globals.update(
        anchor=lambda section, entry: anchors[section, *documents.key(entry)],
        standing=standing,
        rests_on_assumed=rests_on_assumed,
        assumed_mode=assumed_mode,
        assumed_set=assumed_set,
        mark=_mark,
        word=word,
        words=WORDS,
        all_verdicts=VERDICTS,
        classes=CLASSES,
        tags=TAGS,
        shown=SHOWN,
        listed=LISTED,
        measures=MEASURES,
        figures=FIGURES,
        replay_command=replay_command,
        clock=_clock,
        status=_status,
        table=lambda counterexample: Trace(counterexample).table(CELLS),
        style=Markup("\n".join((*((TEMPLATES / name).read_text(encoding="utf-8") for name in STYLES), STYLE))),
        timing=lambda claim, ident: Markup(
            timing_svg(claim["counterexample"], f"Counterexample to {claim['id']}", ident)
        ),
        bar=lambda campaign, ident: Markup(classes_bar(campaign["classes"], ident)),
        histogram=lambda latency, what: Markup(histogram_svg(bins(dict(latency["histogram"])), latency["unit"], what)),
        distribution=lambda tree, ident: Markup(
            "".join(_drawn(tree, lambda: [distribution_svg(tree, f"{ident}-distribution")]))
        ),
        event_tree=lambda tree: Markup("".join(_drawn(tree, lambda: [event_tree_svg(tree)]))),
        spread=lambda sequence, what, ident: Markup(
            "".join(_drawn(sequence, lambda: [distribution_svg(sequence, ident, "event_trees", what)]))
        ),
        tornado=lambda tree: Markup("".join(_drawn(tree, lambda: [tornado_svg(tree)]))),
        interval=lambda *values, **options: Markup(interval_svg(*values, **options)),
        is_number=_is_number,
        plot=lambda exhibit, ident: Markup(plotted(exhibit, ident)),
        tree_pages=lambda tree, ident: [
            Markup(page) for page in _drawn(tree, lambda: tree_pages(tree, ident, style=False, most=TREE_PAGES))
        ],
        sizes=SIZES,
        script=Markup(SCRIPT),
        script_digest=base64.b64encode(hashlib.sha256(SCRIPT.encode()).digest()).decode(),
    )
    return environment


def _models(claims: list[Entry]) -> dict[str, list[Entry]]:
    """Claims by model, those of bounds first, each twin right below the claim that it belongs to."""
    models: dict[str, list[Entry]] = {}
    for claim in sorted(claims, key=_beside_its_twin):
        models.setdefault(claim["model"] or BOUNDS, []).append(claim)
    return models


def _beside_its_twin(claim: Entry) -> tuple[str, str, bool, str]:
    return claim["model"] or "", claim.get("twin_of") or claim["id"], bool(claim.get("twin_of")), claim["id"]


def _status(tree: Entry, cut_set: Entry) -> str:
    """Whether a cut set was replayed on the model; said by the set itself, or by the cut sets found on the model."""
    found = {frozenset(found["faults"]): found["status"] for found in tree.get("cut_sets", ())}
    return str(cut_set.get("status") or found.get(frozenset(cut_set["events"])) or "from the tree")


def _is_number(rows: Sequence[Sequence[object]], column: int) -> bool:
    """Whether a column of a table has numbers, and nothing else where it has something."""
    cells = [row[column] for row in rows if row[column] is not None]
    return bool(cells) and all(isinstance(c, int | float | Mapping) and not isinstance(c, bool) for c in cells)


def _mark(assumed: bool) -> Markup:
    """What stands behind a figure that rests on assumed inputs."""
    sign = Markup(' <span class="tag tag-A" title="rests on assumed inputs">{}</span>')
    return sign.format(MARK) if assumed else Markup("")


def _clock(clock: Mapping[str, str] | None) -> str:
    if not clock:
        return "clock not stated"
    return f"one step = {clock['tick_s']} s" if "tick_s" in clock else f"one step at each {clock['event']}"
