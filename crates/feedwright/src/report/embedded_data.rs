//! The page's data: one JSON object, deflated and in base64, in a script element that browsers do
//! not run.
//!
//! Every column is an array of integers, the first value and then the differences, in the units of
//! [`units`]: differences of smooth signals are short, and sums of integers come back without
//! drift. Deflated (RFC 1951), the data of a long program have a third of the bytes. Base64 (RFC
//! 4648) has no character that ends a script element.

use std::io::{self, Write};

use base64::display::Base64Display;
use base64::engine::general_purpose::STANDARD;
use miniz_oxide::deflate::compress_to_vec;
use serde_json::json;

use super::series::SeriesPoint;
use super::{
    DrawnLimits, FullCircle, Histogram, PageUnits, ProgramLine, Report, ReportedRun, RunSummary,
};

/// Level of the compression, of 10: the default of zlib.
const LEVEL: u8 = 6;

/// Value of one count of a column.
mod units {
    pub(super) const TIME_S: f64 = 1e-5;
    pub(super) const LENGTH_MM: f64 = 1e-3;
    /// Coordinates of the path: a tenth of the smallest contour error worth drawing.
    pub(super) const POINT_MM: f64 = 1e-4;
    /// Contour errors and deviations: largest unit, see [`super::error_unit_mm`].
    pub(super) const ERROR_MM: f64 = 1e-5;
    pub(super) const FEED_MM_S: f64 = 1e-2;
    pub(super) const TORQUE_NM: f64 = 1e-4;
    pub(super) const ACCEL_MM_S2: f64 = 1.0;
}

/// Writes the object, deflated and in base64.
pub(super) fn write(out: &mut impl Write, report: &Report, units: PageUnits) -> io::Result<()> {
    let mut json = Vec::new();
    write_json(&mut json, report, units)?;
    let deflated = compress_to_vec(&json, LEVEL);
    write!(out, "{}", Base64Display::new(&deflated, &STANDARD))
}

/// Writes the object as it is.
pub(super) fn write_json(
    out: &mut impl Write,
    report: &Report,
    units: PageUnits,
) -> io::Result<()> {
    write!(out, "{{\"meta\":{},\"outline\":", meta(report, units))?;
    match report.basis() {
        Some(run) => write_outline(out, run)?,
        None => out.write_all(b"null")?,
    }
    out.write_all(b",\"runs\":[")?;
    for (i, run) in report.runs.iter().enumerate() {
        if i > 0 {
            out.write_all(b",")?;
        }
        write_run(out, run)?;
    }
    out.write_all(b"]}")
}

/// Lengths, errors and speeds are in units of the page; the keys keep their metric names.
fn meta(report: &Report, of: PageUnits) -> serde_json::Value {
    let factor = of.factor();
    let runs: Vec<_> = report
        .runs
        .iter()
        .map(|run| run_meta(run, factor))
        .collect();
    json!({
        "axes": report.runs.iter().map(|r| r.summary.axes).max().unwrap_or(2),
        "tolerance_um": report.tolerance_um.map(|um| factor * um),
        "names": [of.error(), of.length(), of.feed()],
        "units": {
            "time_s": units::TIME_S, "length_mm": factor * units::LENGTH_MM, "point_mm": factor * units::POINT_MM,
            "feed_mm_s": factor * units::FEED_MM_S, "torque_nm": units::TORQUE_NM,
            "accel_m_s2": units::ACCEL_MM_S2 * 1e-3,
        },
        "limits": report.axis_limits.iter().map(limits_meta).collect::<Vec<_>>(),
        "runs": runs,
        "circles": report.circles.iter().enumerate().map(|(i, circle)| circle_meta(report, (i, circle), factor)).collect::<Vec<_>>(),
        "program": listing(report),
    })
}

/// Returns the value of one count of an error, mm: a thousandth to a ten-thousandth of the largest
/// error, so that the drawing of a small error has no steps.
fn error_unit_mm(summary: &RunSummary) -> f64 {
    // The largest error of a run that diverged is not known.
    let largest_mm = if summary.max_um.is_finite() {
        (1e-3 * summary.max_um).clamp(1e-6, 1.0)
    } else {
        1.0
    };
    10_f64
        .powi(libm::log10(largest_mm).floor() as i32 - 3)
        .min(units::ERROR_MM)
}

fn run_meta(run: &ReportedRun, factor: f64) -> serde_json::Value {
    let summary = &run.summary;
    let worst: Vec<_> = summary
        .worst
        .iter()
        .map(|w| {
            let position_mm = w.position_mm.map(|mm| factor * mm);
            json!({"t_s": w.t_s, "s_mm": factor * w.s_mm, "error_um": factor * w.error_um, "position_mm": position_mm})
        })
        .collect();
    json!({
        "controller": summary.controller,
        "max_um": factor * summary.max_um,
        "error_mm": factor * error_unit_mm(summary),
        "rows_per_point": run.series.rows_per_point(),
        "histogram": Histogram { bin_um: factor * summary.histogram.bin_um, ..summary.histogram.clone() },
        "worst": worst,
        "measured": summary.role.is_measured(),
        "spectrum": run.spectrum.iter().map(|band| [band.from_hz, band.to_hz, factor * band.rms_um].map(digits)).collect::<Vec<_>>(),
    })
}

/// Returns the limits of an axis, in the units in which they are drawn.
fn limits_meta(limits: &DrawnLimits) -> serde_json::Value {
    json!({"torque_nm": limits.torque_nm, "accel_m_s2": limits.accel_mm_s2.map(|accel_mm_s2| accel_mm_s2 * 1e-3)})
}

/// Returns a circle, and the radial deviation of each run from it in counts of [`error_unit_mm`].
fn circle_meta(
    report: &Report,
    (index, circle): (usize, &FullCircle),
    factor: f64,
) -> serde_json::Value {
    let run = |run: &ReportedRun| {
        let (roundness, unit_mm) = (run.roundness_of(index)?, error_unit_mm(&run.summary));
        let counts = |um: &Option<f64>| um.map(|um| (um * 1e-3 / unit_mm).round() as i64);
        Some(json!({
            "g_um": digits(factor * roundness.circular_deviation_um),
            "radial": roundness.radial_um.iter().map(counts).collect::<Vec<_>>(),
        }))
    };
    json!({
        "plane": circle.plane, "radius_mm": factor * circle.radius_mm, "line": circle.line,
        "runs": report.runs.iter().map(run).collect::<Vec<_>>(),
    })
}

/// Joins successive lines into one text, after the number of the first line.
fn listing(report: &Report) -> serde_json::Value {
    let pieces = report.program.chunk_by(|a, b| a.line + 1 == b.line);
    let piece = |lines: &[ProgramLine]| {
        let texts: Vec<&str> = lines.iter().map(|line| line.text.as_str()).collect();
        json!([lines[0].line, texts.join("\n")])
    };
    pieces.map(piece).collect()
}

/// Rounds to four significant digits: more are not drawn.
fn digits(value: f64) -> f64 {
    if value == 0.0 || !value.is_finite() {
        return 0.0;
    }
    let unit = 10_f64.powi(3 - libm::log10(value.abs()).floor() as i32);
    (value * unit).round() / unit
}

fn write_outline(out: &mut impl Write, run: &ReportedRun) -> io::Result<()> {
    let vertices: Vec<_> = run.series.outline().collect();
    let mut object = Object::begin(out)?;
    for (k, name) in ["x", "y", "z"]
        .into_iter()
        .enumerate()
        .take(run.summary.axes)
    {
        object.column(
            name,
            units::POINT_MM,
            vertices.iter().map(|v| v.point_mm[k]),
        )?;
    }
    object.column(
        "cutting",
        1.0,
        vertices.iter().map(|v| f64::from(u8::from(v.cutting))),
    )?;
    object.end()
}

fn write_run(out: &mut impl Write, run: &ReportedRun) -> io::Result<()> {
    let points: Vec<SeriesPoint> = run.series.points().collect();
    let column = |value: fn(&SeriesPoint) -> f64| points.iter().map(value);
    let error_mm = error_unit_mm(&run.summary);
    let mut object = Object::begin(out)?;
    object.column("t", units::TIME_S, column(|p| p.t_s))?;
    object.column("s", units::LENGTH_MM, column(|p| p.s_mm))?;
    object.column("e", error_mm, column(|p| p.error_mm))?;
    if run.series.rows_per_point() > 1 {
        object.column("lo", error_mm, column(|p| p.error_min_mm))?;
        object.column("hi", error_mm, column(|p| p.error_max_mm))?;
    }
    object.column("plan", units::FEED_MM_S, column(|p| p.feed_plan_mm_s))?;
    object.column("feed", units::FEED_MM_S, column(|p| p.feed_act_mm_s))?;
    object.column("line", 1.0, column(|p| f64::from(p.line)))?;
    object.column("cutting", 1.0, column(|p| f64::from(u8::from(p.cutting))))?;
    for (k, axis) in ["x", "y", "z"]
        .into_iter()
        .enumerate()
        .take(run.summary.axes)
    {
        object.column(
            &format!("f{axis}"),
            units::POINT_MM,
            points.iter().map(|p| p.foot_mm[k]),
        )?;
        object.column(
            &format!("d{axis}"),
            error_mm,
            points.iter().map(|p| p.deviation_mm[k]),
        )?;
        if run.summary.peak_torque_nm.is_some() {
            object.column(
                &format!("torque_{axis}"),
                units::TORQUE_NM,
                points.iter().map(|p| p.torque_nm[k]),
            )?;
            object.column(
                &format!("accel_{axis}"),
                units::ACCEL_MM_S2,
                points.iter().map(|p| p.accel_mm_s2[k]),
            )?;
        }
    }
    object.end()
}

/// A JSON object of columns that is written column by column.
struct Object<'a, W> {
    out: &'a mut W,
    separator: &'static str,
}

impl<'a, W: Write> Object<'a, W> {
    fn begin(out: &'a mut W) -> io::Result<Self> {
        out.write_all(b"{")?;
        Ok(Self { out, separator: "" })
    }

    fn column(
        &mut self,
        name: &str,
        unit: f64,
        values: impl Iterator<Item = f64>,
    ) -> io::Result<()> {
        write!(self.out, "{}\"{name}\":[", self.separator)?;
        self.separator = ",";
        let mut before = 0;
        for (i, value) in values.enumerate() {
            // The cast saturates: a value out of the range of an i64 is outside of any drawing,
            // too.
            let count = (value / unit).round() as i64;
            if i > 0 {
                self.out.write_all(b",")?;
            }
            write!(self.out, "{}", count.wrapping_sub(before))?;
            before = count;
        }
        self.out.write_all(b"]")
    }

    fn end(self) -> io::Result<()> {
        self.out.write_all(b"}")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_add_up_to_the_values() {
        let values = [1.2345, -7.0, 0.000_04, 1e3, 1e3];
        let mut out = Vec::new();
        let mut object = Object::begin(&mut out).unwrap();
        object.column("x", 1e-4, values.iter().copied()).unwrap();
        object.end().unwrap();
        let parsed: serde_json::Value = serde_json::from_slice(&out).unwrap();
        let mut sum = 0;
        for (difference, value) in parsed["x"].as_array().unwrap().iter().zip(values) {
            sum += difference.as_i64().unwrap();
            assert!((sum as f64 * 1e-4 - value).abs() <= 0.5e-4, "{value}");
        }
    }
}
