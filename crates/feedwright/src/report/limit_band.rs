//! The limits that bind along the path: a row for each limit over the time of the plan, below its
//! feedrate.
//!
//! The band is an SVG in the page, drawn here, so that it is there without scripts. A stretch shows
//! its place and its lines when the pointer rests on it.

use std::fmt::Write as _;
use std::io::{self, Write};

use feedwright_sim::cycle_time::along::{BindingAlong, BindingStretch, LIMITS};

use super::page_units::PageUnits;
use super::text::escaped;

/// Size of the drawing: width, height of the feedrate, of a row, and of the numbers below; the
/// names stand to the left.
const WIDTH: f64 = 1200.0;
const FEED: f64 = 120.0;
const ROW: f64 = 18.0;
const BELOW: f64 = 34.0;
const LEFT: f64 = 150.0;
const RIGHT: f64 = 12.0;
const ABOVE: f64 = 14.0;

/// Largest number of stretches that are drawn: about one for two pixels.
const DRAWN: usize = 600;

/// A stretch is colored if a limit binds for more than this fraction of its time.
const LEAST: f64 = 0.02;
/// Levels of opacity that show this fraction, in equal steps.
const LEVELS: u32 = 4;

/// Limits that bind along the path of a plan, for the page.
#[derive(Debug, Clone, Default)]
pub struct LimitBand {
    /// Names of the limits.
    pub(crate) names: Vec<String>,
    /// The plan.
    pub(crate) along: BindingAlong,
}

impl LimitBand {
    /// Returns each limit that binds: its name, its part of the time in percent, and the line of
    /// the stretch in which it binds longest. Largest parts first.
    pub fn shares(&self) -> Vec<(&str, f64, u32)> {
        let stretches = self.along.stretches();
        let mut shares: Vec<_> = self
            .names
            .iter()
            .enumerate()
            .map(|(limit, name)| {
                let longest = stretches
                    .iter()
                    .max_by(|a, b| a.bound_s[limit].total_cmp(&b.bound_s[limit]));
                (
                    name.as_str(),
                    percent(stretches, limit),
                    longest.map_or(0, |stretch| stretch.lines[0]),
                )
            })
            .filter(|(_, percent, _)| *percent > 0.0)
            .collect();
        shares.sort_by(|a, b| b.1.total_cmp(&a.1));
        shares
    }
}

/// Returns the part of the time in which a limit binds, percent.
fn percent(stretches: &[BindingStretch], limit: usize) -> f64 {
    let [bound_s, total_s] = stretches
        .iter()
        .fold([0.0, 0.0], |[bound_s, total_s], stretch| {
            [
                bound_s + stretch.bound_s[limit],
                total_s + stretch.duration_s,
            ]
        });
    100.0 * bound_s / total_s.max(f64::MIN_POSITIVE)
}

/// Returns the color of a limit by its kind, from colors that remain distinct for the color-blind.
fn color(name: &str) -> &'static str {
    match name {
        "feedrate" => "#00805f",
        "tolerance" => "#a8568a",
        name if name.ends_with("velocity") => "#0067a8",
        name if name.ends_with("acceleration") => "#c8500a",
        _ => "#c98a00",
    }
}

/// Writes the section, if there is anything to show.
pub(super) fn write(
    out: &mut impl Write,
    band: Option<&LimitBand>,
    units: PageUnits,
) -> io::Result<()> {
    let Some(band) = band.filter(|band| !band.along.stretches().is_empty()) else {
        return Ok(());
    };
    out.write_all(
        b"<section aria-labelledby=\"h-limits\">\n<h2 id=\"h-limits\">What binds along the path</h2>\n\
          <p>Feedrate of the plan over its time, rests left out, and which limit holds it down where. Several bind at once; a pale stretch is one in which a limit \
          binds for a part of the time.</p>\n",
    )?;
    writeln!(
        out,
        "<div class=\"scroll\" tabindex=\"0\">{}</div></section>",
        units.text(&drawing(band))
    )
}

fn drawing(band: &LimitBand) -> String {
    let stretches = band.along.in_parts(DRAWN);
    let total_s: f64 = stretches.iter().map(|stretch| stretch.duration_s).sum();
    let rows: Vec<usize> = (0..LIMITS)
        .filter(|&limit| stretches.iter().any(|s| s.bound_s[limit] > 0.0))
        .collect();
    let height = ABOVE + FEED + ROW * rows.len() as f64 + BELOW;
    let mut svg = format!(
        "<svg viewBox=\"0 0 {WIDTH} {height}\" width=\"100%\" role=\"img\" aria-label=\"Which limit binds where\" \
         font-size=\"12\" fill=\"currentColor\">\n"
    );
    let scale = (WIDTH - LEFT - RIGHT) / total_s.max(f64::MIN_POSITIVE);
    write_feed(&mut svg, &stretches, scale);
    for (row, &limit) in rows.iter().enumerate() {
        write_row(&mut svg, band, &stretches, [row, limit], scale);
    }
    write_times(&mut svg, total_s, scale, height);
    svg.push_str("</svg>\n");
    svg
}

/// Draws the mean feedrate of each stretch, mm/min as in programs.
fn write_feed(svg: &mut String, stretches: &[BindingStretch], scale: f64) {
    let feed = |stretch: &BindingStretch| {
        60.0 * stretch.way_mm / stretch.duration_s.max(f64::MIN_POSITIVE)
    };
    let most = stretches.iter().map(feed).fold(1.0, f64::max);
    let (mut points, mut x) = (String::new(), LEFT);
    for stretch in stretches {
        let middle = x + 0.5 * scale * stretch.duration_s;
        x += scale * stretch.duration_s;
        let y = ABOVE + FEED * (1.0 - feed(stretch) / most);
        let _ = write!(points, "{middle:.1},{y:.1} ");
    }
    let (end, bottom, text) = (WIDTH - RIGHT, ABOVE + FEED, LEFT - 8.0);
    let _ = write!(
        svg,
        "<path d=\"M{LEFT} {ABOVE}V{bottom}H{end}\" fill=\"none\" stroke=\"currentColor\" opacity=\"0.4\"/>\n\
         <text x=\"{text}\" y=\"{top:.0}\" text-anchor=\"end\">{most:.0} mm/min</text>\n\
         <text x=\"{text}\" y=\"{bottom}\" text-anchor=\"end\">0</text>\n\
         <polyline points=\"{}\" fill=\"none\" stroke=\"currentColor\" stroke-width=\"1.5\"/>\n",
        points.trim_end(),
        top = ABOVE + 10.0,
    );
}

/// Draws the row of one limit, with its name and its part of the time.
fn write_row(
    svg: &mut String,
    band: &LimitBand,
    stretches: &[BindingStretch],
    [row, limit]: [usize; 2],
    scale: f64,
) {
    let name = band.names.get(limit).map_or("", String::as_str);
    let y = ABOVE + FEED + 8.0 + ROW * row as f64;
    let _ = writeln!(
        svg,
        "<text x=\"{:.0}\" y=\"{:.0}\" text-anchor=\"end\">{} {:.0} %</text>",
        LEFT - 8.0,
        y + 11.0,
        escaped(name),
        percent(stretches, limit)
    );
    let _ = writeln!(
        svg,
        "<g fill=\"{}\" shape-rendering=\"crispEdges\" transform=\"translate(0 {y:.0})\">",
        color(name)
    );
    let (mut x, mut run): (f64, Option<(f64, u32, BindingStretch)>) = (LEFT, None);
    for stretch in stretches {
        let level = level(stretch, limit);
        run = match run {
            Some((from, same, before)) if same == level => {
                Some((from, same, before.merged(stretch)))
            }
            other => {
                write_run(svg, name, limit, other, scale);
                Some((x, level, *stretch))
            }
        };
        x += scale * stretch.duration_s;
    }
    write_run(svg, name, limit, run, scale);
    svg.push_str("</g>\n");
}

/// Returns the part of a stretch in which a limit binds, in steps; 0 for a part up to [`LEAST`].
fn level(stretch: &BindingStretch, limit: usize) -> u32 {
    let part = stretch.bound_s[limit] / stretch.duration_s.max(f64::MIN_POSITIVE);
    if part > LEAST {
        (part * f64::from(LEVELS))
            .ceil()
            .clamp(1.0, f64::from(LEVELS)) as u32
    } else {
        0
    }
}

/// Draws adjacent stretches of one color: their start, their step, and all of them merged.
fn write_run(
    svg: &mut String,
    name: &str,
    limit: usize,
    run: Option<(f64, u32, BindingStretch)>,
    scale: f64,
) {
    let Some((x, level, stretch)) = run.filter(|(_, level, _)| *level > 0) else {
        return;
    };
    let [first, last] = stretch.lines;
    let lines = if first == last {
        format!("line {first}")
    } else {
        format!("lines {first} to {last}")
    };
    let _ = writeln!(
        svg,
        "<rect x=\"{x:.1}\" y=\"0\" width=\"{:.1}\" height=\"{:.0}\" opacity=\"{:.2}\"><title>{}, {lines}, up to {:.2} mm: {:.0} %</title></rect>",
        scale * stretch.duration_s,
        ROW - 5.0,
        f64::from(level) / f64::from(LEVELS),
        escaped(name),
        stretch.to_mm,
        100.0 * stretch.bound_s[limit] / stretch.duration_s.max(f64::MIN_POSITIVE)
    );
}

/// Draws the times below the rows.
fn write_times(svg: &mut String, total_s: f64, scale: f64, height: f64) {
    const TICKS: u32 = 5;
    for tick in 0..=TICKS {
        let t_s = total_s * f64::from(tick) / f64::from(TICKS);
        let (x, y) = (LEFT + scale * t_s, height - 8.0);
        let anchor = if tick == TICKS { "end" } else { "middle" };
        let unit = if tick == TICKS { " s" } else { "" };
        let _ = writeln!(
            svg,
            "<text x=\"{x:.0}\" y=\"{y:.0}\" text-anchor=\"{anchor}\">{t_s:.2}{unit}</text>"
        );
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn limits_have_their_part_of_the_time_and_the_line_where_they_bind_longest() {
        let mut along = BindingAlong::default();
        for (line, bound_s) in [
            (1, [0.5, 0.0, 0.2]),
            (2, [0.0, 0.0, 0.5]),
            (3, [0.5, 0.0, 0.3]),
        ] {
            let mut stretch = BindingStretch {
                duration_s: 1.0,
                lines: [line; 2],
                ..BindingStretch::default()
            };
            stretch.bound_s[..3].copy_from_slice(&bound_s);
            along.push(&stretch);
        }
        let band = LimitBand {
            names: ["a", "b", "c"].map(str::to_owned).to_vec(),
            along,
        };
        let third = 100.0 / 3.0;
        assert_eq!(band.shares(), [("a", third, 3), ("c", third, 2)]);
        assert!(
            LimitBand {
                along: BindingAlong::default(),
                ..band
            }
            .shares()
            .is_empty()
        );
    }

    #[test]
    fn neighbours_of_one_colour_are_one_bar_with_its_place() {
        let stretch = |bound: f64, line: u32| {
            let mut stretch = BindingStretch {
                duration_s: 0.1,
                to_mm: f64::from(line),
                way_mm: 1.0,
                lines: [line; 2],
                bound_s: [0.0; LIMITS],
            };
            stretch.bound_s[0] = 0.1 * bound;
            stretch
        };
        let mut svg = String::new();
        let band = LimitBand {
            names: vec!["feed<rate".to_owned()],
            along: BindingAlong::default(),
        };
        write_row(
            &mut svg,
            &band,
            &[
                stretch(1.0, 1),
                stretch(1.0, 2),
                stretch(0.0, 3),
                stretch(0.3, 4),
            ],
            [0, 0],
            100.0,
        );
        assert_eq!(svg.matches("<rect").count(), 2, "{svg}");
        assert!(
            svg.contains("lines 1 to 2, up to 2.00 mm: 100 %")
                && svg.contains("line 4, up to 4.00 mm: 30 %"),
            "{svg}"
        );
        assert!(
            svg.contains("feed&lt;rate 58 %") && !svg.contains("feed<rate"),
            "{svg}"
        );
    }
}
