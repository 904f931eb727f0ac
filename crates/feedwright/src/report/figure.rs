//! Figures as printed in a paper: line charts in panels, as SVG, and a page that holds several with
//! captions.
//!
//! Equal figures give equal bytes. In a file, the drawing is black on a white plate, so that it is
//! legible on any page. A page removes the plate and has colors for light and dark. Text stays
//! text, so that it can be searched and edited.

mod axis;
mod svg;

use std::io::{self, Write};

use super::plain_page::{PagePart, write_foot, write_head};
use super::text::escaped;

/// Panels side by side or in rows, with one legend for all.
#[derive(Debug, Clone, Default)]
pub struct Figure {
    /// Panels, row by row.
    pub panels: Vec<Panel>,
    /// Panels in a row; 0 counts as 1.
    pub columns: usize,
    /// Height of the plotting area of every panel over its width; 0 counts as 0.62.
    pub aspect: f64,
}

/// One plotting area.
#[derive(Debug, Clone, Default)]
pub struct Panel {
    /// Text above the area, as in "(a) Contour error"; may be empty.
    pub title: String,
    /// Title of the horizontal axis with its unit, as in "Time \[s\]".
    pub x_title: String,
    /// Title of the vertical axis with its unit.
    pub y_title: String,
    /// Curves, the first at the bottom.
    pub curves: Vec<Polyline>,
    /// True where a unit has the same length on both axes, as a path needs it.
    pub equal_axes: bool,
    /// True where both axes are logarithmic: points and ranges are the powers of ten, and ticks
    /// show the numbers.
    pub powers_of_ten: bool,
    /// Range of the horizontal axis; `None` takes it from the curves.
    pub x_range: Option<[f64; 2]>,
    /// Range of the vertical axis; `None` takes it from the curves.
    pub y_range: Option<[f64; 2]>,
}

/// A polyline.
#[derive(Debug, Clone, Default)]
pub struct Polyline {
    /// Name in the legend; curves of equal name in several panels share an entry, an empty name has
    /// none.
    pub label: String,
    /// Points; one that is not finite leaves a gap.
    pub points: Vec<[f64; 2]>,
    /// Stroke.
    pub line: LineStyle,
    /// CSS colour, as in [`COLORS`].
    pub color: String,
}

/// Stroke of a [`Polyline`].
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum LineStyle {
    /// Solid line.
    #[default]
    Solid,
    /// Long dashes.
    Dashed,
    /// Short dashes.
    Dotted,
    /// Thin solid line: a reference, such as the programmed path.
    Thin,
}

/// Colors that remain distinct for the color-blind and in gray print: black, vermilion, blue,
/// green, purple, orange. After Okabe and Ito, "Color Universal Design", 2008, darkened where thin
/// lines need it.
pub const COLORS: [&str; 6] = [
    "#111111", "#c8500a", "#0067a8", "#00805f", "#a8568a", "#c98a00",
];

/// A figure with its number and caption.
#[derive(Debug, Clone, Default)]
pub struct CaptionedFigure {
    /// The figure.
    pub figure: Figure,
    /// Number, as in "Figure 7".
    pub number: String,
    /// Caption.
    pub caption: String,
}

impl Figure {
    /// Returns the figure as an SVG document.
    pub fn to_svg(&self) -> String {
        svg::write(self, svg::WIDTH)
    }

    /// Returns the figure for a page: once as wide as a text column, and once for phones; the style
    /// sheet shows one of the two.
    pub(crate) fn to_html(&self) -> String {
        let [roomy, narrow] = [svg::WIDTH, svg::NARROW].map(|page_px| svg::write(self, page_px));
        format!("<div class=\"roomy\">{roomy}</div><div class=\"narrow\">{narrow}</div>")
    }
}

/// Writes one self-contained HTML page with `introduction`, a paragraph, and the figures below each
/// other.
///
/// # Errors
/// A write to `out` that fails.
pub fn write_figure_page(
    out: &mut impl Write,
    title: &str,
    introduction: &str,
    figures: &[CaptionedFigure],
) -> io::Result<()> {
    let parts: Vec<PagePart> = figure_parts(figures).collect();
    write_head(out, "figures", title, introduction, &parts)?;
    parts
        .iter()
        .zip(figures)
        .try_for_each(|(part, entry)| write_figure_part(out, part, entry))?;
    write_foot(out)
}

/// Returns the parts of a page that contain these figures.
pub(crate) fn figure_parts(figures: &[CaptionedFigure]) -> impl Iterator<Item = PagePart> {
    figures
        .iter()
        .enumerate()
        .map(|(i, entry)| PagePart::new(&format!("figure-{}", i + 1), entry.number.as_str()))
}

/// Writes one part of a page with its figure.
pub(crate) fn write_figure_part(
    out: &mut impl Write,
    part: &PagePart,
    entry: &CaptionedFigure,
) -> io::Result<()> {
    part.begin(out)?;
    let (svg, number, caption) = (
        entry.figure.to_html(),
        escaped(&entry.number),
        escaped(&entry.caption),
    );
    writeln!(
        out,
        "<figure>\n{svg}<figcaption><b>{number}.</b> {caption}</figcaption>\n</figure>"
    )?;
    PagePart::end(out)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sine() -> Figure {
        let points = (0..=100)
            .map(|k| [f64::from(k) * 0.02, 30.0 * libm::sin(f64::from(k) * 0.1)])
            .collect();
        let curve = Polyline {
            label: "a <b>".to_owned(),
            points,
            color: COLORS[0].to_owned(),
            ..Polyline::default()
        };
        Figure {
            panels: vec![Panel {
                curves: vec![curve],
                ..Panel::default()
            }],
            ..Figure::default()
        }
    }

    #[test]
    fn labels_are_escaped() {
        let svg = sine().to_svg();
        assert!(svg.contains("a &lt;b&gt;") && !svg.contains("<b>"), "{svg}");
    }

    #[test]
    fn a_figure_without_points_is_still_a_figure() {
        let empty = Figure {
            panels: vec![Panel::default()],
            ..Figure::default()
        };
        let mut broken = sine();
        broken.panels[0].curves[0].points = vec![[f64::NAN, 1.0], [f64::INFINITY, 0.0], [1.0, 1.0]];
        for svg in [empty.to_svg(), broken.to_svg(), Figure::default().to_svg()] {
            assert!(
                !svg.contains("NaN") && !svg.contains("inf") && svg.ends_with("</svg>\n"),
                "{svg}"
            );
        }
    }

    #[test]
    fn equal_axes_draw_a_circle_round() {
        let circle = (0..=360)
            .map(|k| {
                [
                    libm::cos(f64::from(k).to_radians()),
                    libm::sin(f64::from(k).to_radians()),
                ]
            })
            .collect();
        let mut figure = sine();
        figure.panels[0].curves[0].points = circle;
        figure.panels[0].equal_axes = true;
        let svg = figure.to_svg();
        let curves = svg.split("stroke-linejoin").nth(1).unwrap();
        let path = curves
            .split("<path d=\"M")
            .nth(1)
            .and_then(|s| s.split('"').next())
            .unwrap();
        let numbers: Vec<f64> = path.split(['L', ' ']).map(|n| n.parse().unwrap()).collect();
        let span = |axis: usize| {
            let values = numbers.iter().skip(axis).step_by(2).copied();
            values.clone().fold(f64::MIN, f64::max) - values.fold(f64::MAX, f64::min)
        };
        assert!(
            (span(0) - span(1)).abs() < 0.5,
            "{} by {}",
            span(0),
            span(1)
        );
    }
}
