//! Figure and page of an advice.

use std::io::{self, Write};

use super::{Advice, FeedCut, NearestCut, STRETCH_LEGEND, StretchAdvice, WAYS, WayAdvice};
use crate::report::PageUnits;
use crate::report::figure::{COLORS, Figure, LineStyle, Panel, Polyline};
use crate::report::plain_page::{
    PagePart, write_foot, write_head, write_table_end, write_table_head,
};
use crate::report::text::escaped;

/// Largest number of rows in the table of stretches: the stretches that hold the tolerance
/// uncorrected at the smallest fraction of their feedrate.
const ROWS: usize = 200;
impl Advice {
    /// Draws the largest error over the feedrate, for each way, and the feedrates that hold the
    /// tolerance, stretch by stretch.
    pub fn figure(&self, units: PageUnits) -> Figure {
        let per_minute = 60.0 * units.factor();
        let largest_per_minute = per_minute * self.programmed_mm_s[1];
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
            let at = |cut: &FeedCut| {
                [
                    log(largest_per_minute * cut.factor.unwrap_or(1.0)),
                    log(units.factor() * cut.max_um),
                ]
            };
            let name = way.way.name(self.controller);
            let line = [LineStyle::Dashed, LineStyle::Solid, LineStyle::Dotted][k];
            curves.push(curve(
                name,
                COLORS[k],
                line,
                way.cuts.iter().map(at).collect(),
            ));
            let of_stretch = |(n, stretch): (usize, &StretchAdvice)| {
                let feed = stretch.holds_mm_s[k].map_or(f64::NAN, |mm_s| per_minute * mm_s);
                [[n as f64 + 0.5, feed], [n as f64 + 1.5, feed]]
            };
            by_stretch.push(curve(
                name,
                COLORS[k],
                line,
                self.stretches
                    .iter()
                    .enumerate()
                    .flat_map(of_stretch)
                    .collect(),
            ));
        }
        let ends = |axis: usize| {
            let all = || {
                curves
                    .iter()
                    .flat_map(|curve| &curve.points)
                    .map(|point| point[axis])
            };
            [
                all().fold(f64::INFINITY, f64::min),
                all().fold(f64::NEG_INFINITY, f64::max),
            ]
        };
        let tolerance = ends(0)
            .map(|x| [x, log(units.factor() * self.tolerance_um)])
            .to_vec();
        curves.push(curve("tolerance", COLORS[4], LineStyle::Thin, tolerance));
        let panel = |title: &str, x_title: &str, y_title: &str, curves, powers_of_ten| Panel {
            title: title.to_owned(),
            x_title: x_title.to_owned(),
            y_title: y_title.to_owned(),
            curves,
            powers_of_ten,
            ..Panel::default()
        };
        let feedrate = format!("Feedrate [{}]", units.feed());
        let error = format!("Largest contour error [{}]", units.error());
        let panels = vec![
            panel("(a) Whole program", &feedrate, &error, curves, true),
            panel(
                "(b) Feedrate that holds",
                "Stretch",
                &feedrate,
                by_stretch,
                false,
            ),
        ];
        Figure {
            panels,
            columns: 1,
            aspect: 0.45,
        }
    }

    /// Writes the page: the table, the figure, and the stretches.
    ///
    /// # Errors
    /// A write to `out` that fails.
    pub fn write_page(
        &self,
        out: &mut impl Write,
        part: &str,
        machine: &str,
        units: PageUnits,
    ) -> io::Result<()> {
        let tolerance = format!("{} {}", units.number(self.tolerance_um), units.error());
        let introduction = format!(
            "Simulated. Feedrates at which the largest contour error stays within {tolerance}: of the program as it is and of a corrected program, both cut without feedback as \
             the control plans them ({}, planner {}), and with the controller {}. A corrected program is made for its feedrate.",
            self.control, self.planner, self.controller
        );
        let assumed = self.assumed.as_ref().map_or_else(String::new, |assumed| {
            format!(" {}.", units.text(&assumed.sentence()))
        });
        let introduction = introduction + &assumed;
        let parts = [
            PagePart::new("program", "The whole program"),
            PagePart::new("feedrates", "Errors and feedrates"),
            PagePart::new("stretches", "Stretch by stretch"),
        ];
        let [program, feedrates, stretches] = &parts;
        let title = format!("{part} within {tolerance} on {machine}");
        write_head(out, "tables", &title, &introduction, &parts)?;
        program.begin(out)?;
        let (error, feed) = (units.error(), units.feed());
        let [rms, largest, own] =
            ["RMS", "max", "its max"].map(|figure| format!("{figure} {error}"));
        let own_time = "each stretch at its own: time s";
        write_table_head(
            out,
            [
                "cut",
                "feed, of programmed",
                feed,
                "time s",
                &rms,
                &largest,
                own_time,
                &own,
            ],
        )?;
        self.ways
            .iter()
            .try_for_each(|way| self.write_way(out, way, units))?;
        write_table_end(out)?;
        PagePart::end(out)?;
        feedrates.begin(out)?;
        writeln!(
            out,
            "<figure>{}<figcaption><b>Largest contour error over the feedrate</b>, the largest of the program; below, the feedrate at which each stretch \
             holds the tolerance, in the order of the program. Gaps hold it at no feedrate that was cut.</figcaption></figure>",
            self.figure(units).to_html()
        )?;
        PagePart::end(out)?;
        stretches.begin(out)?;
        self.write_stretches(out, units)?;
        PagePart::end(out)?;
        write_foot(out)
    }

    fn write_way(&self, out: &mut impl Write, way: &WayAdvice, units: PageUnits) -> io::Result<()> {
        let name = escaped(way.way.name(self.controller)).to_string();
        write!(out, "<tr><td class=\"words\">{name}</td>")?;
        match &way.whole {
            Some(FeedCut {
                factor,
                time_s,
                rms_um,
                max_um,
            }) => {
                let factor = factor.unwrap_or(1.0);
                let feed = units.fixed(60.0 * factor * self.programmed_mm_s[1], 0);
                write!(
                    out,
                    "<td>{:.0} %</td><td>{feed}</td><td>{time_s:.3}</td><td>{}</td><td>{}</td>",
                    100.0 * factor,
                    units.number(*rms_um),
                    units.number(*max_um)
                )?;
            }
            None => {
                let sentence =
                    |cut: NearestCut| units.text(&cut.sentence("µm", self.programmed_mm_s[1]));
                let nearest = way.nearest.map_or_else(|| "-".to_owned(), sentence);
                write!(out, "<td colspan=\"5\" class=\"words\">{nearest}</td>")?;
            }
        }
        match &way.by_stretch {
            Some(cut) => writeln!(
                out,
                "<td>{:.3}</td><td>{}</td></tr>",
                cut.time_s,
                units.number(cut.max_um)
            ),
            None => writeln!(out, "<td>-</td><td>-</td></tr>"),
        }
    }

    fn write_stretches(&self, out: &mut impl Write, units: PageUnits) -> io::Result<()> {
        let shown = self.slowest(ROWS);
        if shown.len() < self.stretches.len() {
            writeln!(
                out,
                "<p>The {} of {} stretches that hold the least:</p>",
                shown.len(),
                self.stretches.len()
            )?;
        }
        let names = WAYS.iter().map(|way| way.name(self.controller));
        let programmed = format!("programmed {}", units.feed());
        write_table_head(
            out,
            ["lines", &programmed]
                .into_iter()
                .chain(names)
                .chain(["left"]),
        )?;
        for stretch in &shown {
            let [first, last] = stretch.lines;
            let cells: String = (0..WAYS.len())
                .map(|way| format!("<td>{}</td>", stretch.cell(way, units)))
                .collect();
            let lines = if first == last {
                first.to_string()
            } else {
                format!("{first} to {last}")
            };
            let remark = units.text(&stretch.remark("µm").unwrap_or_default());
            let feed = units.fixed(60.0 * stretch.feed_mm_s, 0);
            writeln!(
                out,
                "<tr><td>{lines}</td><td>{feed}</td>{cells}<td class=\"words\">{remark}</td></tr>"
            )?;
        }
        write_table_end(out)?;
        let remarks = shown
            .iter()
            .any(|stretch| stretch.nearest.iter().any(Option::is_some));
        if remarks {
            writeln!(out, "<p>{}</p>", escaped(STRETCH_LEGEND))
        } else {
            Ok(())
        }
    }

    /// Selects at most `most` stretches, in the order of the program: those that hold the tolerance
    /// uncorrected only at the smallest fractions of their programmed feedrates.
    pub fn slowest(&self, most: usize) -> Vec<&StretchAdvice> {
        let part =
            |stretch: &StretchAdvice| stretch.holds_mm_s[0].unwrap_or(0.0) / stretch.feed_mm_s;
        let mut order: Vec<usize> = (0..self.stretches.len()).collect();
        order.sort_by(|&a, &b| part(&self.stretches[a]).total_cmp(&part(&self.stretches[b])));
        order.truncate(most);
        order.sort_unstable();
        order.into_iter().map(|k| &self.stretches[k]).collect()
    }
}
