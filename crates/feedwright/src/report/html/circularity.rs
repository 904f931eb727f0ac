//! Table of the roundness of the circles of the program; ISO 230-4 names its numbers.

use std::io::{self, Write};

use super::tables::swatch;
use crate::report::text::escaped;
use crate::report::{PageUnits, Report};

/// Writes a row for each circle and run; nothing if the program has no circle.
pub(super) fn write_circularity(
    out: &mut impl Write,
    report: &Report,
    units: PageUnits,
) -> io::Result<()> {
    let mut rows = Vec::new();
    for (c, circle) in report.circles.iter().enumerate() {
        for (i, run) in report.runs.iter().enumerate() {
            rows.extend(
                run.roundness_of(c)
                    .map(|roundness| (circle, i, run, roundness)),
            );
        }
    }
    if rows.is_empty() {
        return Ok(());
    }
    let unit = units.error();
    write!(
        out,
        "<section aria-labelledby=\"h-circles\">\n<h2 id=\"h-circles\">Circularity</h2>\n<div class=\"circles\">\n\
         <div id=\"circularity\" class=\"needs-script\"></div>\n<div class=\"scroll\" tabindex=\"0\"><table class=\"circularity\"><thead><tr>\
         <th scope=\"col\">Circle</th><th scope=\"col\" class=\"run\">Controller</th>\
         <th scope=\"col\">Circular deviation G<i>{unit}</i></th><th scope=\"col\">Fmax<i>{unit}</i></th><th scope=\"col\">Fmin<i>{unit}</i></th>\
         </tr></thead>\n<tbody>\n"
    )?;
    for (circle, run, reported, roundness) in rows {
        let length = units.length();
        let sense = if circle.counter_clockwise {
            "counter-clockwise"
        } else {
            "clockwise"
        };
        writeln!(
            out,
            "<tr><th scope=\"row\">{} R {} {length}, {sense}, line {}</th><td class=\"run\">{}{}</td><td>{}</td><td>{}</td><td>{}</td></tr>",
            circle.plane,
            units.fixed(circle.radius_mm, 3),
            circle.line,
            swatch(run),
            escaped(&reported.summary.controller),
            units.number(roundness.circular_deviation_um),
            units.signed(roundness.radial_max_um, 2),
            units.signed(roundness.radial_min_um, 2)
        )?;
    }
    out.write_all(b"</tbody></table></div>\n</div></section>\n")
}
