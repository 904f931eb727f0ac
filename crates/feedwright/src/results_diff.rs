//! Two results, or two programs, side by side: their figures with the ratio, and one plot.
//!
//! Results are the JSON of `run`, `correct` and `plan`. For a run, the cut that is judged
//! counts. The plot has the distribution of the contour error of two runs, or the
//! paths of two programs.

use std::io::{self, Write};

use feedwright_gcode::canon::Canon;
use feedwright_gcode::{CheckError, Program, Settings};
use feedwright_sim::path_steps;
use serde_json::Value;

use crate::report::Role;
use crate::report::figure::{
    COLORS, CaptionedFigure, Figure, LineStyle, Panel, Polyline, figure_parts, write_figure_part,
};
use crate::report::plain_page::{
    PagePart, write_foot, write_head, write_table_end, write_table_head,
};
use crate::report::text::{change, escaped, number};

/// Figures by their keys in the JSON results, and their names.
const KEYS: [(&str, &str); 11] = [
    ("time_s", "time s"),
    ("cutting_s", "cutting s"),
    ("rapid_s", "rapids s"),
    ("waiting_s", "waiting s"),
    ("rms_um", "RMS um"),
    ("max_um", "max um"),
    ("uncut_um", "uncut um"),
    ("max_deviation_um", "command off um"),
    ("max_command_accel_mm_s2", "acceleration mm/s2"),
    ("blocks", "blocks"),
    ("cutting_length_mm", "cutting length mm"),
];

/// One of the two results or programs.
#[derive(Debug, Clone, Default, PartialEq)]
pub(crate) struct DiffSide {
    /// Name of the result or program.
    pub(crate) name: String,
    /// Figures by their names.
    pub(crate) figures: Vec<(&'static str, f64)>,
    /// Its curve in the plot; empty if it has none.
    pub(crate) curve: Vec<[f64; 2]>,
    /// True where the curve is a path, mm; false where it is a distribution.
    pub(crate) is_path: bool,
}

impl DiffSide {
    /// Reads a JSON result; `None` if it is not a result of `run`, `correct` or `plan`.
    pub(crate) fn of_result(name: &str, result: &Value) -> Option<Self> {
        let run = Role::Exported
            .of_results(result)
            .or_else(|| Role::Corrected.of_results(result));
        let exported = result.get("as_exported");
        let of = run
            .or(exported)
            .or(result.get("cutting_s").map(|_| result))?;
        let figure = |(key, name): &(&str, &'static str)| Some((*name, of[*key].as_f64()?));
        let figures: Vec<_> = KEYS.iter().filter_map(figure).collect();
        let controller = of["controller"]
            .as_str()
            .map_or_else(String::new, |controller| format!(", {controller}"));
        Some(Self {
            name: format!("{name}{controller}"),
            figures,
            curve: distribution(&of["histogram"]),
            is_path: false,
        })
    }

    /// Reads a program.
    ///
    /// # Errors
    /// A program with mistakes.
    pub(crate) fn of_program(program: &Program, settings: &Settings) -> Result<Self, CheckError> {
        let summary = program.check(settings.clone())?;
        let read = program.reader(settings.clone()).map_err(CheckError::Read)?;
        let size_mm = |axis: usize| summary.box_mm[1][axis] - summary.box_mm[0][axis];
        let figures = vec![
            ("lines", summary.lines as f64),
            ("motions", summary.motions as f64),
            ("feed mm", summary.feed_mm),
            ("rapids mm", summary.rapid_mm),
            ("X size mm", size_mm(0)),
            ("Y size mm", size_mm(1)),
            ("Z size mm", size_mm(2)),
        ];
        Ok(Self {
            name: program.name(),
            figures,
            curve: path(read.map_while(Result::ok)),
            is_path: true,
        })
    }
}

/// Number of points of a piece of the path in the plot, so that an arc looks round.
const POINTS: usize = 24;
/// Largest number of points of a path: a page of a few MB.
const MOST_POINTS: usize = 200_000;

/// Returns the path of a program in X and Y, mm.
fn path(steps: impl Iterator<Item = Canon> + Send) -> Vec<[f64; 2]> {
    let mut points = Vec::new();
    for step in path_steps(steps).map_while(Result::ok) {
        let feedwright_plan::Step::Piece(piece) = step else {
            continue;
        };
        for k in 0..=POINTS {
            let at_mm = piece
                .curve
                .at(piece.length_mm * k as f64 / POINTS as f64)
                .position_mm;
            points.push([at_mm[0], at_mm[1]]);
        }
        if points.len() > MOST_POINTS {
            break;
        }
    }
    points
}

/// Returns the distribution of the contour error: share of the servo periods per um, over the
/// error, um.
fn distribution(histogram: &Value) -> Vec<[f64; 2]> {
    let Some(counts) = histogram["counts"].as_array() else {
        return Vec::new();
    };
    let [width_um, first] =
        ["bin_um", "first_bin"].map(|key| histogram[key].as_f64().unwrap_or(0.0));
    let counts: Vec<f64> = counts
        .iter()
        .map(|count| count.as_f64().unwrap_or(0.0))
        .collect();
    let all: f64 = counts.iter().sum();
    let step = |(k, count): (usize, &f64)| {
        let (from, share) = (first + k as f64, 100.0 * count / (all * width_um));
        [[from * width_um, share], [(from + 1.0) * width_um, share]]
    };
    counts.iter().enumerate().flat_map(step).collect()
}

/// A figure of both sides.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct DiffFigure {
    /// Its name with its unit.
    pub(crate) name: &'static str,
    /// Value of the first side.
    pub(crate) before: f64,
    /// Value of the second side.
    pub(crate) after: f64,
}

impl DiffFigure {
    /// Formats the ratio of the second to the first, with three decimals; a dash if the first is
    /// zero.
    pub(crate) fn ratio(&self) -> String {
        let ratio = self.after / self.before;
        if ratio.is_finite() {
            format!("{ratio:.3}")
        } else {
            "-".to_owned()
        }
    }
}

/// Returns the figures that both sides have, in order.
pub(crate) fn diff_figures(before: &DiffSide, after: &DiffSide) -> Vec<DiffFigure> {
    let both = |(name, value): &(&'static str, f64)| {
        let (_, after) = after.figures.iter().find(|(other, _)| other == name)?;
        Some(DiffFigure {
            name,
            before: *value,
            after: *after,
        })
    };
    before.figures.iter().filter_map(both).collect()
}

/// Writes a page with the figures of both sides and their plot.
///
/// # Errors
/// A write to `out` that fails.
pub(crate) fn write_diff_page(
    out: &mut impl Write,
    [before, after]: [&DiffSide; 2],
) -> io::Result<()> {
    let figures = [CaptionedFigure {
        figure: figure([before, after]),
        number: "Figure 1".to_owned(),
        caption: if before.is_path {
            "The paths in X and Y, rapids included".to_owned()
        } else {
            "How often each contour error occurs, in servo periods".to_owned()
        },
    }];
    let has_plot = !before.curve.is_empty() && !after.curve.is_empty();
    let table = PagePart::new("figures", "Figures");
    let plots: Vec<PagePart> = figure_parts(&figures).filter(|_| has_plot).collect();
    let parts: Vec<PagePart> = std::iter::once(table.clone())
        .chain(plots.iter().cloned())
        .collect();
    let title = format!("{} and {}", before.name, after.name);
    write_head(
        out,
        "tables",
        &title,
        "Before and after: their figures, with the ratio, and one plot.",
        &parts,
    )?;
    table.begin(out)?;
    write_table_head(
        out,
        [
            "",
            before.name.as_str(),
            after.name.as_str(),
            "ratio",
            "change",
        ],
    )?;
    for figure in diff_figures(before, after) {
        let DiffFigure {
            name,
            before,
            after,
        } = figure;
        writeln!(
            out,
            "<tr><td class=\"words\">{}</td><td>{}</td><td>{}</td><td>{}</td><td>{}</td></tr>",
            escaped(&name.replace("um", "\u{b5}m")),
            number(before),
            number(after),
            figure.ratio(),
            change(before, after).unwrap_or_else(|| "-".to_owned())
        )?;
    }
    write_table_end(out)?;
    PagePart::end(out)?;
    plots
        .iter()
        .zip(&figures)
        .try_for_each(|(part, entry)| write_figure_part(out, part, entry))?;
    write_foot(out)
}

/// Draws both curves on top of each other.
fn figure(sides: [&DiffSide; 2]) -> Figure {
    let is_path = sides[0].is_path;
    let line = [
        if is_path {
            LineStyle::Thin
        } else {
            LineStyle::Dashed
        },
        LineStyle::Solid,
    ];
    let curve = |k: usize| Polyline {
        label: sides[k].name.clone(),
        points: sides[k].curve.clone(),
        line: line[k],
        color: COLORS[k].to_owned(),
    };
    let titles = if is_path {
        ["X [mm]", "Y [mm]"]
    } else {
        ["Contour error [\u{b5}m]", "Servo periods [% per \u{b5}m]"]
    };
    let panel = Panel {
        x_title: titles[0].to_owned(),
        y_title: titles[1].to_owned(),
        curves: vec![curve(0), curve(1)],
        equal_axes: is_path,
        ..Panel::default()
    };
    Figure {
        panels: vec![panel],
        columns: 1,
        aspect: 0.62,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn the_last_cut_of_a_run_counts_and_its_distribution_sums_to_all() {
        let histogram = json!({ "bin_um": 0.5, "first_bin": -1, "counts": [1, 3] });
        let run = |max_um: f64| json!({ "runs": [{ "max_um": 99.0 }, { "controller": "c", "max_um": max_um, "histogram": histogram }] });
        let [before, after] =
            [4.0, 1.0].map(|max_um| DiffSide::of_result("a.json", &run(max_um)).unwrap());
        let figures = diff_figures(&before, &after);
        assert_eq!(
            figures,
            [DiffFigure {
                name: "max um",
                before: 4.0,
                after: 1.0
            }]
        );
        assert_eq!(
            (figures[0].ratio().as_str(), before.name.as_str()),
            ("0.250", "a.json, c")
        );
        // 25 % and 75 % of the periods, over 0.5 um each.
        assert_eq!(
            before.curve,
            [[-0.5, 50.0], [0.0, 50.0], [0.0, 150.0], [0.5, 150.0]]
        );
        assert_eq!(DiffSide::of_result("x", &json!({ "files": [] })), None);
    }

    #[test]
    fn two_programs_are_compared_by_their_paths() {
        let side = |text: &str| {
            let program = Program::from_text("a.ngc", text);
            DiffSide::of_program(&program, &Settings::default()).unwrap()
        };
        let [before, after] =
            ["G21 G90 F600\nG1 X10\nM2\n", "G21 G90 F600\nG1 X20\nM2\n"].map(side);
        let feed = diff_figures(&before, &after)
            .into_iter()
            .find(|figure| figure.name == "feed mm")
            .unwrap();
        assert_eq!(
            (feed.before, feed.after, feed.ratio().as_str()),
            (10.0, 20.0, "2.000")
        );
        assert_eq!(after.curve.last(), Some(&[20.0, 0.0]));
        let mut page = Vec::new();
        write_diff_page(&mut page, [&before, &after]).unwrap();
        let page = String::from_utf8(page).unwrap();
        assert!(
            page.contains("<svg") && page.contains("2.000") && page.contains("+100 %"),
            "{page}"
        );
    }
}
