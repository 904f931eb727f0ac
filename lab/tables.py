#!/usr/bin/env python3
"""Makes the tables of docs/results.md and of examples/*/README.md from the results that are kept beside them.

    lab/tables.py           writes every table in its place
    lab/tables.py --show    prints them as JSON, for the golden tests of the laboratory
"""

import json
import math
import pathlib
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
BASELINE = "uncorrected"
LIMIT = "lqg-preview"
END = "<!-- end of table -->\n"
# Controllers that docs/results.md shows.
SHOWN = (
    "uncorrected two-dimensional contour-compensation cross-coupled cross-coupled-feedrate corner-contour constrained-feedrate "
    "fuzzy-h-infinity feedforward-as-delivered feedforward feedforward-cross-coupled model-predictive lqg-identified"
).split()
# Controllers that are shown on machines with the effects of real axes.
REAL = (
    "uncorrected feedforward-as-delivered contour-compensation cross-coupled cross-coupled-feedrate corner-contour "
    "constrained-feedrate fuzzy-h-infinity disturbance-observer kalman-disturbance feedforward feedforward-cross-coupled "
    "feedforward-cross-coupled+identified feedforward-cross-coupled+20%off feedforward-cross-coupled+log lqg-identified "
    "lqg-identified+log lqg-preview"
).split()
# Controllers that know nothing of a machine, or what was identified from a recording.
WITHOUT_MODEL = (
    "cross-coupled contour-compensation fuzzy-feedrate cross-coupled-feedrate magnitude-only two-dimensional lqg-identified"
).split()
# Places named where a claim falls short.
NAMED = 6


class Comparison:
    """The results of `feedwright-lab compare`, as docs/json.md describes them."""

    def __init__(self, file):
        vars(self).update(json.loads((ROOT / file).read_text()))
        self.lines = {(row["machine"], row["controller"]): row for row in self.rows}
        self.machines, self.controllers = ([*dict.fromkeys(key[k] for key in self.lines)] for k in (0, 1))

    def each(self, machine, controller, *columns):
        """The first of the columns that there is, contour by contour; none unless all was cut to its end."""
        row = self.lines.get((machine, controller))
        if row and not any(row.get("diverged", ())):
            return next(row[column] for column in columns if column in row)
        return None

    def rms_um(self, machine, controller, *columns):
        """RMS error over all contours; none unless all was cut to its end."""
        each = self.each(machine, controller, *columns)
        return each and quadratic_mean(each)


def quadratic_mean(values):
    total = 0.0  # In the order of the values: `sum` of newer versions rounds once.
    for value in values:
        total += value * value
    return math.sqrt(total / len(values))


def to_four_digits(value):
    """Four digits at most, without zeros that say nothing."""
    value = float(f"{value:.3e}")
    if value == 0 or 1e-3 <= abs(value) < 1e6:
        return f"{value:.9f}".rstrip("0").rstrip(".")
    mantissa, exponent = f"{value:.3e}".split("e")
    return f"{mantissa.rstrip('0').rstrip('.')}e{int(exponent)}"


def markdown(first, columns, rows):
    lines = [[first, *columns], *rows]
    text = ["| " + " | ".join(line) + " |" for line in lines]
    return "\n".join([text[0], "|---|" + "--:|" * len(columns), *text[1:], ""])


def contours(comparison, controllers):
    """A line for each controller, a column for each contour, on the nominal machine."""
    base_s = comparison.lines[comparison.nominal, BASELINE]["time_s"]

    def cells(controller):
        row = comparison.lines[comparison.nominal, controller]
        for rms_um, max_um, time_s, base in zip(row["rms_um"], row["max_um"], row["time_s"], base_s):
            late = f" in {time_s / base:.2f}" if abs(time_s / base - 1) > 0.005 else ""
            yield f"{rms_um:.2f} / {max_um:.1f}{late}"

    return markdown("RMS / max, µm", comparison.contours, [[name, *cells(name)] for name in controllers])


def machines(comparison):
    """A line for each machine: RMS over all contours."""

    def row(machine):
        rms_um, name = min((comparison.rms_um(machine, name, "rms_um"), name) for name in WITHOUT_MODEL)
        return machine, f"{comparison.rms_um(machine, BASELINE, 'rms_um'):.2f}", f"{rms_um:.2f} ({name})"

    columns = ["uncorrected", "best of those without model"]
    return markdown("RMS over all contours, µm", columns, map(row, comparison.machines))


def tuned(comparison):
    """The values that the searches found."""

    def words(tuned):
        ends = {"low": " (low end)", "high": " (high end)", None: ""}
        for value in tuned["values"]:
            yield f"{value['name']} {to_four_digits(value['value'])}{ends[value.get('at_end')]}"
        if tuned.get("switched_off"):
            yield "switched off: no better than uncorrected"

    head = "| controller | machine | evaluations | RMS, µm | uncorrected, µm | values |\n|---|---|--:|--:|--:|---|\n"
    return head + "".join(
        f"| {it['controller']} | {it['machine']} | {it['cuts']} | {it['rms_um']:.3f} | {it['open_um']:.2f} | {', '.join(words(it))} |\n"
        for it in comparison.tuned
    )


def claims(comparison):
    """A line for each claim: on how many contours and machines it holds, and where it does not."""

    def row(claim):
        unit = claim.get("unit", "").replace("um", "µm")
        places = [f"{contour} on {machine} ({value:.2f})" for contour, machine, value in claim["short"]]
        more = [f"and {len(places) - NAMED} more"] if len(places) > NAMED else []
        held = f"{claim['held']} of {claim['of']}"
        limit = to_four_digits(claim["limit"])
        return f"| {claim['claim']} | {limit} {unit} | {held} | {claim['worst']:.3f} | {', '.join(places[:NAMED] + more)} |\n"

    head = "| claim | limit | holds | worst | falls short on |\n|---|--:|--:|--:|---|\n"
    return head + "".join(map(row, comparison.claims))


def tolerance(comparison):
    """Machining time at equal tolerance, against uncorrected."""
    rows = {(row["controller"], row["contour"]): row for row in comparison.at_tolerance}
    names, columns = ([*dict.fromkeys(key[k] for key in rows)] for k in (0, 1))

    def cell(row):
        known = row["feed_mm_s"] is not None and row["time_ratio"] is not None
        return f"{row['feed_mm_s']:.0f}, {row['time_ratio']:.2f}" if known else "never"

    lines = [[name, *(cell(rows[name, contour]) for contour in columns)] for name in names]
    return markdown("feedrate in mm/s, time against uncorrected", columns, lines)


def held_out(comparison):
    """A line for each controller, a column for each machine: errors by encoders, and the median at the tool."""

    def cell(machine, controller):
        rms_um = comparison.each(machine, controller, "joint_rms_um", "rms_um")
        if not rms_um:
            return "lost"
        at_tool_um = comparison.each(machine, controller, "rms_um")
        max_um = comparison.each(machine, controller, "joint_max_um", "max_um")
        half = len(rms_um) // 2
        medians = f"{sorted(rms_um)[half]:.2f} / {sorted(at_tool_um)[half]:.2f}"
        return f"{medians} / {quadratic_mean(rms_um):.2f} / {max(max_um):.1f}"

    names = [name for name in REAL if name in comparison.controllers]
    rows = [[name, *(cell(machine, name) for machine in comparison.machines)] for name in names]
    return markdown("median RMS / at the tool / RMS of all / max, µm", comparison.machines, rows)


def imperfections(comparison):
    """A line for each machine, a column for each controller: RMS over all contours."""
    names = [name for name in REAL if name in comparison.controllers]

    def cells(machine):
        found = (comparison.rms_um(machine, name, "rms_um") for name in names)
        return ["lost" if rms_um is None else f"{rms_um:.3f}" for rms_um in found]

    rows = [[machine, *cells(machine)] for machine in comparison.machines]
    return markdown("RMS over all contours, µm", names, rows)


def seeds(paper):
    """A line for each seed of the paper's experiment."""
    columns = (
        "seed | fit | uncorrected | magnitude only, same time | magnitude only, same rho | two-dimensional | RMS ratio | max ratio "
        "| time ratio | exact gradient"
    )
    text = f"| {columns} |\n|{'--:|' * 10}\n"
    for seed in paper["seeds"]:
        open_, magnitude, both = (seed[name] for name in ("uncorrected", "magnitude_only", "two_dimensional"))
        cuts = [open_, magnitude, seed["magnitude_only_same_rho"], both, seed["two_dimensional_exact_gradient"]]
        *cells, exact = (f"{cut['time_s']:.3f} s, {cut['rms_um']:.1f} / {cut['max_um']:.1f}" for cut in cuts)
        pairs = [(both, magnitude, "rms_um"), (both, magnitude, "max_um"), (both, open_, "time_s")]
        ratios = [f"{cut[key] / base[key]:.3f}" for cut, base, key in pairs]
        text += "| " + " | ".join([str(seed["seed"]), f"{seed['fit_um']:.1f}", *cells, *ratios, exact]) + " |\n"
    worst = " | ".join(f"{paper[f'worst_{what}_ratio']:.3f}" for what in ("rms", "max", "time"))
    return text + f"| worst | | | | | | {worst} | |\n"


def all_tables(paper):
    """Document, name and text of every table."""
    without_noise = Comparison("examples/02_contours/compare.json")
    with_noise = Comparison("examples/03_realism/held_out.json")
    study, realism = "examples/02_contours/README.md", "examples/03_realism/README.md"
    return [
        ("docs/results.md", "contours", contours(without_noise, SHOWN)),
        ("docs/results.md", "held-out work", held_out(with_noise)),
        (study, "contours", contours(without_noise, [c for m, c in without_noise.lines if m == without_noise.nominal])),
        (study, "machines", machines(without_noise)),
        (study, "tuned", tuned(without_noise)),
        (study, "claims", claims(without_noise)),
        (study, "tolerance", tolerance(without_noise)),
        (realism, "held-out work", held_out(with_noise)),
        (realism, "imperfections", imperfections(Comparison("examples/03_realism/imperfections.json"))),
        (realism, "claims", claims(with_noise)),
        (realism, "tuned", tuned(with_noise)),
        ("examples/01_paper_circle/README.md", "seeds", seeds(json.loads(paper.read_text()))),
    ]


def replaced(text, name, table, recipe="tables"):
    """The text of a document with another table in the place of this name."""
    begin = f"<!-- table of {name}, made by `just {recipe}` -->\n"
    before, found, rest = text.partition(begin)
    _, end, after = rest.partition(END)
    if not found or not end:
        sys.exit(f"there is no line {begin}or no line {END}")
    return before + begin + table + END + after


def main(arguments):
    if arguments[:1] == ["--show"]:
        kept = all_tables(pathlib.Path(arguments[1]))
        print(json.dumps({"tables": kept, "without_model": WITHOUT_MODEL}))
        return
    for file, name, table in all_tables(ROOT / "examples/01_paper_circle/paper.json"):
        (ROOT / file).write_text(replaced((ROOT / file).read_text(), name, table))
        print(f"{file}, {name}\n{table}")


if __name__ == "__main__":
    main(sys.argv[1:])
