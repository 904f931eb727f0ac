//! The page: one HTML file, readable without a network and without scripts.
//!
//! Headings, verdict and tables are written here, so that the numbers are there before any script
//! runs; the drawings are made in the browser by `assets/report/*.js` from the data that
//! [`embedded_data`] writes.

use std::io::{self, Write};

use super::embedded_data;
use super::limit_band;
use super::page_frame::{PageFrame, in_one_scope};
use super::text::escaped;
use super::{Assumptions, PageUnits, Report, Role};

mod tables;
mod circularity;
mod verdict;

const COLORS_CSS: &str = include_str!("../../assets/report/colors.css");
const PAGE_CSS: &str = include_str!("../../assets/report/page.css");
const UPLOT_CSS: &str = include_str!("../../assets/vendor/uplot/uPlot.min.css");
const UPLOT_JS: &str = include_str!("../../assets/vendor/uplot/uPlot.iife.min.js");

/// The page's scripts in the order in which they build on each other; they share one function
/// scope.
const SCRIPTS: [&str; 11] = [
    include_str!("../../assets/report/data.js"),
    include_str!("../../assets/report/theme.js"),
    include_str!("../../assets/report/camera.js"),
    include_str!("../../assets/report/path_view.js"),
    include_str!("../../assets/report/path_input.js"),
    include_str!("../../assets/report/plot_definitions.js"),
    include_str!("../../assets/report/plots.js"),
    include_str!("../../assets/report/circularity.js"),
    include_str!("../../assets/report/player.js"),
    include_str!("../../assets/report/view_state.js"),
    include_str!("../../assets/report/main.js"),
];

/// Writes `report` as one HTML page that refers to nothing outside it.
///
/// # Errors
/// A write to `out` that fails.
pub fn write_html(out: &mut impl Write, report: &Report) -> io::Result<()> {
    write_html_in(out, report, PageUnits::Metric)
}

/// Writes the same page as [`write_html`], with lengths and speeds in other units.
///
/// # Errors
/// A write to `out` that fails.
pub fn write_html_in(out: &mut impl Write, report: &Report, units: PageUnits) -> io::Result<()> {
    let frame = PageFrame::new(
        &[UPLOT_CSS, COLORS_CSS, PAGE_CSS],
        vec![UPLOT_JS.to_owned(), in_one_scope(&SCRIPTS)],
    );
    frame.write_head(out, &report.title)?;
    out.write_all(b"<body>\n")?;
    write_header(out, report, units)?;
    out.write_all(b"<main>\n")?;
    out.write_all(DRAWINGS.as_bytes())?;
    tables::write_summary(out, report, units, &assumed(report, units))?;
    limit_band::write(out, report.limits.as_ref(), units)?;
    circularity::write_circularity(out, report, units)?;
    tables::write_worst(out, report, units)?;
    tables::write_notes(out, report, units)?;
    out.write_all(
        b"</main>\n<footer>Simulated and written by feedwright. Charts: uPlot (MIT).</footer>\n",
    )?;
    out.write_all(b"<script type=\"text/plain\" id=\"data\">")?;
    embedded_data::write(out, report, units)?;
    out.write_all(b"</script>\n")?;
    frame.write_end(out)
}

/// Writes the data that the scripts of the page draw, as JSON.
///
/// # Errors
/// A write to `out` that fails.
pub fn write_html_data(out: &mut impl Write, report: &Report) -> io::Result<()> {
    embedded_data::write_json(out, report, PageUnits::Metric)
}

fn write_header(out: &mut impl Write, report: &Report, units: PageUnits) -> io::Result<()> {
    let machine = report.basis().map_or("", |run| &run.summary.machine);
    let measured = report.run(Role::Measured).is_some();
    write!(
        out,
        r#"<header>
<div class="top"><p class="brand">feedwright <span>contour report</span></p>
<button type="button" id="theme" class="quiet needs-script">Theme: auto</button></div>
<h1>{title} <span class="badge">{how}</span></h1>
<p class="subject"><span>Part <b>{part}</b></span> <span>Machine <b>{machine}</b></span></p>
<p class="verdict">{verdict}</p>
{band}</header>
"#,
        title = escaped(&report.title),
        part = escaped(&report.part),
        machine = escaped(machine),
        how = if measured {
            "simulated, beside a log"
        } else {
            "simulated"
        },
        verdict = verdict::verdict(report, units),
        band = band(report, units),
    )
}

/// Returns the band of the prediction, in one paragraph.
fn band(report: &Report, units: PageUnits) -> String {
    report.band.as_ref().map_or_else(String::new, |band| {
        format!(
            "<p class=\"assumed\"><b>Predicted</b> {}.</p>\n",
            escaped(&units.text(&band.sentence().replace(" um", " µm")))
        )
    })
}

/// Returns the assumptions, in one paragraph.
fn assumed(report: &Report, units: PageUnits) -> String {
    let assumed = &report.assumed;
    if assumed.machine.is_empty() {
        return String::new();
    }
    let machine = format!("{}: {}", assumed.machine_sentence(), assumed.description);
    let mut sentences = vec![
        machine,
        assumed.simulation_sentence(),
        assumed.model_sentence(),
    ];
    sentences.extend(
        report
            .geometry
            .as_ref()
            .map(|geometry| units.text(&geometry.sentence().replace(" um", " µm"))),
    );
    let cut = Assumptions::cut_sentence(report.run(Role::Measured).is_some());
    format!(
        "<p class=\"assumed\"><b>Assumed</b> {}. {cut}</p>\n",
        escaped(&sentences.join("; "))
    )
}

/// The elements that the scripts fill.
const DRAWINGS: &str = include_str!("../../assets/report/drawings.html");
