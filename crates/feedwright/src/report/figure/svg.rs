//! The drawing: frame, ticks, curves and legend of each panel.

use std::fmt::Write as _;

use super::{Figure, LineStyle, Panel, Polyline, axis};
use crate::report::text::escaped;

/// Width of a figure, px: a text column at 96 px/in.
pub(super) const WIDTH: f64 = 720.0;
/// Width of a figure on a phone, px; its panels stand below each other.
pub(super) const NARROW: f64 = 350.0;
const FONT_PX: f64 = 12.5;
/// Mean width of a digit, for the room that labels need.
const DIGIT_PX: f64 = 7.0;
/// Room above a panel with a title, below it for labels and title, and between panels.
const TITLE_PX: f64 = 24.0;
const LABELS_PX: f64 = 26.0;
const AXIS_TITLE_PX: f64 = 20.0;
const GAP_PX: f64 = 22.0;
const LEGEND_PX: f64 = 28.0;
/// Height of each further line of the legend, px.
const LEGEND_LINE_PX: f64 = 18.0;
const TICK_PX: f64 = 5.0;
/// Target distance between ticks, px.
const X_TICK_PX: f64 = 75.0;
const Y_TICK_PX: f64 = 42.0;
const DEFAULT_ASPECT: f64 = 0.62;
/// Part of the span that curves leave free above and below. Horizontally they fill the panel,
/// unless its axes are equal.
const MARGIN: f64 = 0.04;
/// Points closer than this to the last one drawn are left out, px: less than print shows.
const THIN_PX: f64 = 0.3;

/// `write!` to a string, which cannot fail.
macro_rules! put {
    ($out:expr, $($arg:tt)*) => { let _ = write!($out, $($arg)*); };
}

/// Position of a panel's area, px, and its ranges and ticks.
struct Area {
    left: f64,
    top: f64,
    width: f64,
    height: f64,
    x: [f64; 2],
    y: [f64; 2],
    ticks: fn([f64; 2], f64) -> Vec<(f64, String)>,
}

impl Area {
    fn px(&self, x: f64) -> f64 {
        (x - self.x[0]) / (self.x[1] - self.x[0]) * self.width
    }

    fn py(&self, y: f64) -> f64 {
        (self.y[1] - y) / (self.y[1] - self.y[0]) * self.height
    }
}

/// Returns the figure as SVG, `page_px` wide.
pub(super) fn write(figure: &Figure, page_px: f64) -> String {
    let columns = if page_px < WIDTH {
        1
    } else {
        figure.columns.max(1)
    };
    let aspect = if figure.aspect > 0.0 {
        figure.aspect
    } else {
        DEFAULT_ASPECT
    };
    let entries = legend(figure);
    let mut body = String::new();
    let lines = put_legend(&mut body, &entries, page_px);
    let mut top = if lines == 0 {
        2.0
    } else {
        LEGEND_PX + LEGEND_LINE_PX * (lines - 1) as f64
    };
    let left = figure
        .panels
        .iter()
        .map(|p| left_room(p, aspect, page_px / columns as f64))
        .fold(0.0, f64::max);
    let cell = (page_px - GAP_PX * (columns - 1) as f64) / columns as f64;
    for row in figure.panels.chunks(columns) {
        let title = if row.iter().all(|p| p.title.is_empty()) {
            4.0
        } else {
            TITLE_PX
        };
        let (width, height) = (cell - left - 8.0, (cell - left - 8.0) * aspect);
        for (i, panel) in row.iter().enumerate() {
            let x = (cell + GAP_PX) * i as f64 + left;
            put_panel(
                &mut body,
                panel,
                &fitted(panel, x, top + title, width, height),
                13.0 - left,
            );
        }
        let titled = row.iter().any(|p| !p.x_title.is_empty());
        top += title + height + LABELS_PX + if titled { AXIS_TITLE_PX } else { 0.0 };
    }
    format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {page_px} {top:.0}\" width=\"{page_px}\" height=\"{top:.0}\" \
         role=\"img\" aria-label=\"{}\" font-family=\"'Helvetica Neue', Helvetica, Arial, 'Liberation Sans', sans-serif\" \
         font-size=\"{FONT_PX}\" fill=\"currentColor\">\n\
         <rect class=\"plate\" width=\"100%\" height=\"100%\" fill=\"#fff\"/>\n{body}</svg>\n",
        escaped(&spoken(figure))
    )
}

/// Returns the description of the figure for screen readers: the contents of its panels.
fn spoken(figure: &Figure) -> String {
    let panel = |panel: &Panel| match (panel.title.as_str(), panel.y_title.as_str()) {
        (title, "") => title.to_owned(),
        ("", y) => format!("{y} over {}", panel.x_title),
        (title, y) => format!("{title}: {y} over {}", panel.x_title),
    };
    let panels: Vec<String> = figure
        .panels
        .iter()
        .map(panel)
        .filter(|text| !text.is_empty())
        .collect();
    if panels.is_empty() {
        "Chart".to_owned()
    } else {
        format!("Chart. {}", panels.join("; "))
    }
}

/// Returns the room for the vertical axis: its title and its widest label.
fn left_room(panel: &Panel, aspect: f64, cell_px: f64) -> f64 {
    // The width of the plotting area is not known yet; a tenth more or less makes the same labels.
    let width = 0.85 * cell_px;
    let area = fitted(panel, 0.0, 0.0, width, width * aspect);
    let labels = (area.ticks)(area.y, area.height / Y_TICK_PX);
    let widest = labels
        .iter()
        .map(|t| t.1.chars().count())
        .max()
        .unwrap_or(1);
    DIGIT_PX * widest as f64 + 8.0 + if panel.y_title.is_empty() { 0.0 } else { 22.0 }
}

fn fitted(panel: &Panel, left: f64, top: f64, width: f64, height: f64) -> Area {
    let values = |k: usize| {
        panel
            .curves
            .iter()
            .flat_map(move |c| c.points.iter().map(move |p| p[k]))
    };
    let given =
        |r: Option<[f64; 2]>| r.filter(|r| r[0] < r[1] && r[0].is_finite() && r[1].is_finite());
    let mut x = given(panel.x_range)
        .unwrap_or_else(|| axis::range(values(0), if panel.equal_axes { MARGIN } else { 0.0 }));
    let mut y = given(panel.y_range).unwrap_or_else(|| axis::range(values(1), MARGIN));
    if panel.equal_axes {
        let per_px = ((x[1] - x[0]) / width).max((y[1] - y[0]) / height);
        let about = |r: [f64; 2], px: f64| {
            [
                0.5 * (r[0] + r[1] - per_px * px),
                0.5 * (r[0] + r[1] + per_px * px),
            ]
        };
        (x, y) = (about(x, width), about(y, height));
    }
    let ticks = if panel.powers_of_ten {
        axis::ticks_of_powers
    } else {
        axis::ticks
    };
    Area {
        left,
        top,
        width,
        height,
        x,
        y,
        ticks,
    }
}

/// Draws a panel. `title_x` is the position of the title of the vertical axis, from the left of the
/// area.
fn put_panel(out: &mut String, panel: &Panel, area: &Area, title_x: f64) {
    let Area {
        left,
        top,
        width,
        height,
        ..
    } = *area;
    put!(out, "<g transform=\"translate({left:.1} {top:.1})\">\n");
    if !panel.title.is_empty() {
        put!(
            out,
            "<text x=\"0\" y=\"-8\" font-weight=\"600\">{}</text>\n",
            escaped(&panel.title)
        );
    }
    if area.y[0] < 0.0 && area.y[1] > 0.0 && !panel.equal_axes && !panel.powers_of_ten {
        let zero = area.py(0.0);
        put!(
            out,
            "<path d=\"M0 {zero:.2}H{width:.2}\" stroke=\"currentColor\" stroke-opacity=\"0.25\" fill=\"none\"/>\n"
        );
    }
    // A nested drawing clips the parts outside the area, without ids that would clash in a page of
    // several figures.
    put!(
        out,
        "<svg width=\"{width:.2}\" height=\"{height:.2}\" fill=\"none\" stroke-linejoin=\"round\">\n"
    );
    for curve in &panel.curves {
        let d = path_data(curve, area);
        if !d.is_empty() {
            put!(out, "<path d=\"{d}\" {}/>\n", stroke(curve));
        }
    }
    put!(out, "</svg>\n");
    put_axes(out, area);
    let middle = width / 2.0;
    put!(
        out,
        "<text x=\"{middle:.1}\" y=\"{:.1}\" text-anchor=\"middle\">{}</text>\n",
        height + 37.0,
        escaped(&panel.x_title)
    );
    let y = height / 2.0;
    put!(
        out,
        "<text transform=\"translate({title_x:.1} {y:.1}) rotate(-90)\" text-anchor=\"middle\">{}</text>\n</g>\n",
        escaped(&panel.y_title)
    );
}

/// Draws the frame, and ticks to the inside on all four sides.
fn put_axes(out: &mut String, area: &Area) {
    let (width, height) = (area.width, area.height);
    let (mut marks, mut labels) = (String::new(), String::new());
    for (value, text) in (area.ticks)(area.x, width / X_TICK_PX) {
        let x = area.px(value);
        put!(marks, "M{x:.2} {height:.2}v-{TICK_PX}M{x:.2} 0v{TICK_PX}");
        put!(
            labels,
            "<text x=\"{x:.1}\" y=\"{:.1}\" text-anchor=\"middle\">{text}</text>\n",
            height + 17.0
        );
    }
    for (value, text) in (area.ticks)(area.y, height / Y_TICK_PX) {
        let y = area.py(value);
        put!(marks, "M0 {y:.2}h{TICK_PX}M{width:.2} {y:.2}h-{TICK_PX}");
        put!(
            labels,
            "<text x=\"-7\" y=\"{:.1}\" text-anchor=\"end\">{text}</text>\n",
            y + 0.34 * FONT_PX
        );
    }
    put!(
        out,
        "<path d=\"M0 0H{width:.2}V{height:.2}H0Z{marks}\" fill=\"none\" stroke=\"currentColor\"/>\n{labels}"
    );
}

fn path_data(curve: &Polyline, area: &Area) -> String {
    let mut d = String::new();
    let mut last: Option<[f64; 2]> = None;
    for (i, p) in curve.points.iter().enumerate() {
        let [x, y] = [area.px(p[0]), area.py(p[1])];
        if !(x.is_finite() && y.is_finite()) {
            last = None;
            continue;
        }
        let near = last.is_some_and(|[u, v]| libm::hypot(x - u, y - v) < THIN_PX);
        if near && i + 1 < curve.points.len() {
            continue;
        }
        put!(d, "{}{x:.2} {y:.2}", if last.is_some() { 'L' } else { 'M' });
        last = Some([x, y]);
    }
    d
}

fn stroke(curve: &Polyline) -> String {
    let color = if curve.color.is_empty() {
        "currentColor".to_owned()
    } else {
        escaped(&curve.color)
    };
    let (width, dash) = match curve.line {
        LineStyle::Solid => (1.4, ""),
        LineStyle::Dashed => (1.4, " stroke-dasharray=\"6 3\""),
        LineStyle::Dotted => (1.4, " stroke-dasharray=\"1.5 2.5\""),
        LineStyle::Thin => (0.7, ""),
    };
    format!("stroke=\"{color}\" stroke-width=\"{width}\"{dash}")
}

/// Returns the first curve of each name.
fn legend(figure: &Figure) -> Vec<&Polyline> {
    let mut entries: Vec<&Polyline> = Vec::new();
    for curve in figure.panels.iter().flat_map(|p| &p.curves) {
        if !curve.label.is_empty() && entries.iter().all(|e| e.label != curve.label) {
            entries.push(curve);
        }
    }
    entries
}

/// Draws the legend and returns the number of its lines.
fn put_legend(out: &mut String, entries: &[&Polyline], page_px: f64) -> usize {
    let (mut x, mut lines) = (0.0, usize::from(!entries.is_empty()));
    for curve in entries {
        let end = x + 35.0 + text_px(&curve.label);
        if x > 0.0 && end > page_px {
            (x, lines) = (0.0, lines + 1);
        }
        let down = LEGEND_LINE_PX * (lines - 1) as f64;
        put!(
            out,
            "<path d=\"M{x:.1} {}h28\" fill=\"none\" {}/>\n",
            11.0 + down,
            stroke(curve)
        );
        put!(
            out,
            "<text x=\"{:.1}\" y=\"{}\">{}</text>\n",
            x + 35.0,
            15.5 + down,
            escaped(&curve.label)
        );
        x += 35.0 + text_px(&curve.label) + 22.0;
    }
    lines
}

/// Estimates the width of a text: the width in the reader's font is not known here.
fn text_px(text: &str) -> f64 {
    let em = |c: char| match c {
        'f' | 'i' | 'j' | 'l' | 'r' | 't' | ' ' | '.' | ',' | ':' | '(' | ')' | '\'' => 0.36,
        'm' | 'w' | 'M' | 'W' => 0.92,
        c if c.is_uppercase() => 0.70,
        _ => 0.61,
    };
    FONT_PX * text.chars().map(em).sum::<f64>()
}
