//! The figure and the page of an advice.

use std::io::{self, Write};

use super::{Advice, FeedCut, STRETCH_LEGEND, StretchAdvice, WAYS, WayAdvice};
use crate::report::figure::{COLORS, Figure, LineStyle, Panel, Polyline};
use crate::report::plain_page::{PagePart, write_foot, write_head, write_table_end, write_table_head};
use crate::report::text::{escaped, number};

/// Rows of the table of stretches at the most: those that hold the least feed, uncorrected.
const ROWS: usize = 200;
const WAY_HEADS: [&str; 8] = [
    "cut",
    "feed, of programmed",
    "mm/min",
    "time s",
    "RMS µm",
    "max µm",
    "each stretch at its own: time s",
    "its max µm",
];

impl Advice {
    /// Largest error over the feedrate, for each way, and the feedrates that hold, stretch by stretch.
    pub fn figure(&self) -> Figure {
        let [_, largest_mm_s] = self.programmed_mm_s;
        let log = |x: f64| libm::log10(x.max(1e-9));
        let curve = |label: &str, color: &str, line: LineStyle, points: Vec<[f64; 2]>| Polyline {
            label: label.to_owned(),
            points,
            color: color.to_owned(),
            line,
        };
        let mut curves = Vec::new();
        let mut by_stretch = Vec::new();
        for (k, way) in self.ways.iter().enumerate() {
            let at = |cut: &FeedCut| [log(60.0 * largest_mm_s * cut.factor.unwrap_or(1.0)), log(cut.max_um)];
            let name = way.way.name(self.controller);
            let line = [LineStyle::Dashed, LineStyle::Solid, LineStyle::Dotted][k];
            curves.push(curve(name, COLORS[k], line, way.cuts.iter().map(at).collect()));
            let of_stretch = |(n, stretch): (usize, &StretchAdvice)| {
                let feed = stretch.holds_mm_s[k].map_or(f64::NAN, |mm_s| 60.0 * mm_s);
                [[n as f64 + 0.5, feed], [n as f64 + 1.5, feed]]
            };
            by_stretch.push(curve(
                name,
                COLORS[k],
                line,
                self.stretches.iter().enumerate().flat_map(of_stretch).collect(),
            ));
        }
        let ends = |axis: usize| {
            let all = || curves.iter().flat_map(|curve| &curve.points).map(|point| point[axis]);
            [all().fold(f64::INFINITY, f64::min), all().fold(f64::NEG_INFINITY, f64::max)]
        };
        let tolerance = ends(0).map(|x| [x, log(self.tolerance_um)]).to_vec();
        curves.push(curve("tolerance", COLORS[4], LineStyle::Thin, tolerance));
        let panel = |title: &str, x_title: &str, y_title: &str, curves, powers_of_ten| Panel {
            title: title.to_owned(),
            x_title: x_title.to_owned(),
            y_title: y_title.to_owned(),
            curves,
            powers_of_ten,
            ..Panel::default()
        };
        let panels = vec![
            panel("(a) Whole program", "Feedrate [mm/min]", "Largest contour error [µm]", curves, true),
            panel("(b) Feedrate that holds", "Stretch", "Feedrate [mm/min]", by_stretch, false),
        ];
        Figure { panels, columns: 1, aspect: 0.45 }
    }

    /// Writes the page: the table, the figure, and the stretches.
    ///
    /// # Errors
    /// Where `out` takes no more.
    pub fn write_page(&self, out: &mut impl Write, part: &str, machine: &str) -> io::Result<()> {
        let introduction = format!(
            "Simulated. Feedrates at which the largest contour error stays within {} µm: of the program as it is and of a corrected program, both cut without feedback as \
             the control plans them ({}, planner {}), and with the controller {}. A corrected program is made for its feedrate.",
            number(self.tolerance_um),
            self.control,
            self.planner,
            self.controller
        );
        let assumed = self.assumed.as_ref().map_or_else(String::new, |assumed| format!(" {}.", assumed.sentence()));
        let introduction = introduction + &assumed;
        let parts = [
            PagePart::new("program", "The whole program"),
            PagePart::new("feedrates", "Errors and feedrates"),
            PagePart::new("stretches", "Stretch by stretch"),
        ];
        let [program, feedrates, stretches] = &parts;
        let title = format!("{part} within {} µm on {machine}", number(self.tolerance_um));
        write_head(out, "tables", &title, &introduction, &parts)?;
        program.begin(out)?;
        write_table_head(out, WAY_HEADS)?;
        self.ways.iter().try_for_each(|way| self.write_way(out, way))?;
        write_table_end(out)?;
        PagePart::end(out)?;
        feedrates.begin(out)?;
        writeln!(
            out,
            "<figure>{}<figcaption><b>Largest contour error over the feedrate</b>, the largest of the program; below, the feedrate at which each stretch \
             holds the tolerance, in the order of the program. Gaps hold it at no feedrate that was cut.</figcaption></figure>",
            self.figure().to_html()
        )?;
        PagePart::end(out)?;
        stretches.begin(out)?;
        self.write_stretches(out)?;
        PagePart::end(out)?;
        write_foot(out)
    }

    fn write_way(&self, out: &mut impl Write, way: &WayAdvice) -> io::Result<()> {
        let name = escaped(way.way.name(self.controller)).to_string();
        write!(out, "<tr><td class=\"words\">{name}</td>")?;
        match &way.whole {
            Some(FeedCut { factor, time_s, rms_um, max_um }) => {
                let factor = factor.unwrap_or(1.0);
                let feed = 60.0 * factor * self.programmed_mm_s[1];
                write!(
                    out,
                    "<td>{:.0} %</td><td>{feed:.0}</td><td>{time_s:.3}</td><td>{}</td><td>{}</td>",
                    100.0 * factor,
                    number(*rms_um),
                    number(*max_um)
                )?;
            }
            None => {
                let nearest =
                    way.nearest.map_or_else(|| "-".to_owned(), |cut| cut.sentence("µm", self.programmed_mm_s[1]));
                write!(out, "<td colspan=\"5\" class=\"words\">{nearest}</td>")?;
            }
        }
        match &way.by_stretch {
            Some(cut) => writeln!(out, "<td>{:.3}</td><td>{}</td></tr>", cut.time_s, number(cut.max_um)),
            None => writeln!(out, "<td>-</td><td>-</td></tr>"),
        }
    }

    fn write_stretches(&self, out: &mut impl Write) -> io::Result<()> {
        let shown = self.slowest(ROWS);
        if shown.len() < self.stretches.len() {
            writeln!(out, "<p>The {} of {} stretches that hold the least:</p>", shown.len(), self.stretches.len())?;
        }
        let names = WAYS.iter().map(|way| way.name(self.controller));
        write_table_head(out, ["lines", "programmed mm/min"].into_iter().chain(names).chain(["left"]))?;
        for stretch in &shown {
            let [first, last] = stretch.lines;
            let cells: String = (0..WAYS.len()).map(|way| format!("<td>{}</td>", stretch.cell(way))).collect();
            let lines = if first == last { first.to_string() } else { format!("{first} to {last}") };
            let remark = stretch.remark("µm").unwrap_or_default();
            let feed = 60.0 * stretch.feed_mm_s;
            writeln!(out, "<tr><td>{lines}</td><td>{feed:.0}</td>{cells}<td class=\"words\">{remark}</td></tr>")?;
        }
        write_table_end(out)?;
        let remarks = shown.iter().any(|stretch| stretch.nearest.iter().any(Option::is_some));
        if remarks { writeln!(out, "<p>{}</p>", escaped(STRETCH_LEGEND)) } else { Ok(()) }
    }

    /// At most `most` stretches, in the order of the program: those that hold the tolerance
    /// uncorrected only at the smallest fractions of their programmed feedrates.
    pub fn slowest(&self, most: usize) -> Vec<&StretchAdvice> {
        let part = |stretch: &StretchAdvice| stretch.holds_mm_s[0].unwrap_or(0.0) / stretch.feed_mm_s;
        let mut order: Vec<usize> = (0..self.stretches.len()).collect();
        order.sort_by(|&a, &b| part(&self.stretches[a]).total_cmp(&part(&self.stretches[b])));
        order.truncate(most);
        order.sort_unstable();
        order.into_iter().map(|k| &self.stretches[k]).collect()
    }
}
