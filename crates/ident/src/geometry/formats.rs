//! Recognizes a measurement by its content, and reads its rows.

use feedwright_sim::{AXIS_NAMES, MeasuredSet};

use super::comp_file;
use super::text::{MeasurementError, TextBlock, blocks};

/// Content of a file.
#[derive(Debug, Clone, PartialEq)]
pub enum GeometryInput {
    /// Sets to fit.
    Sets(Vec<MeasuredSet>),
    /// The table of a compensation file: axis, rows, and type.
    Table(usize, Vec<[f64; 3]>, u8),
}

/// Formats that are read, for messages.
const FORMATS: &str = "feedwright reads a ball bar (columns angle_deg, direction, deviation_um), a laser or scale (position_mm, \
                       direction, deviation_um), a test part (name, nominal_mm, measured_mm), a grid encoder (x_mm, y_mm, \
                       x_measured_mm, y_measured_mm), and a compensation file of LinuxCNC (three numbers in a row): see \
                       docs/measure-geometry.md";

impl GeometryInput {
    /// The measurement in a text; `axis` says which axis a compensation file or a positioning table
    /// is of.
    ///
    /// # Errors
    /// A text of another kind, or with a fault.
    pub fn parse(file: &str, text: &str, axis: Option<usize>) -> Result<Self, MeasurementError> {
        let blocks: Vec<TextBlock> = blocks(file, text)
            .into_iter()
            .filter(|block| !block.rows.is_empty())
            .collect();
        let mut sets = Vec::new();
        for block in &blocks {
            let reader = reader(block).ok_or_else(|| unknown(block, block.line()))?;
            if let MeasurementFormat::CompFile = reader {
                let axis = axis_of(block, axis)?;
                let (table, kind) = comp_file::table(block)?;
                return Ok(Self::Table(axis, table, kind));
            }
            let mut set = match reader {
                MeasurementFormat::BallBar => ball_bar(block)?,
                MeasurementFormat::Grid => grid(block)?,
                MeasurementFormat::TestPart => test_part(block)?,
                _ => positioning(block, axis)?,
            };
            set.source = file.to_owned();
            set.date = block.keys.get("date").cloned().unwrap_or_default();
            set.noise_um = 1.0;
            set.name = format!("{} {} {}", set.kind, set.axes, sets.len() + 1);
            sets.push(set);
        }
        if sets.is_empty() {
            let empty = TextBlock {
                file: file.to_owned(),
                ..TextBlock::default()
            };
            return Err(unknown(&empty, 1));
        }
        Ok(Self::Sets(sets))
    }
}

#[derive(Clone, Copy)]
enum MeasurementFormat {
    BallBar,
    Grid,
    TestPart,
    Positioning,
    CompFile,
}

fn reader(block: &TextBlock) -> Option<MeasurementFormat> {
    let has = |begins: &str| {
        block
            .columns
            .iter()
            .any(|column| column.starts_with(begins))
    };
    let measured_of = |axis: &&'static str| {
        has(&format!("{axis}_mm"))
            && (has(&format!("{axis}_measured")) || has(&format!("d{axis}_")))
    };
    if has("angle") {
        Some(MeasurementFormat::BallBar)
    } else if AXIS_NAMES.into_iter().filter(measured_of).count() == 2 {
        Some(MeasurementFormat::Grid)
    } else if has("name") && has("nominal") && has("measured") {
        Some(MeasurementFormat::TestPart)
    } else if has("position") || has("target") {
        Some(MeasurementFormat::Positioning)
    } else if block.columns.is_empty() && block.rows.iter().all(|(_, cells)| cells.len() == 3) {
        Some(MeasurementFormat::CompFile)
    } else {
        None
    }
}

fn unknown(block: &TextBlock, line: usize) -> MeasurementError {
    let is_log = block
        .columns
        .iter()
        .any(|column| column.ends_with(".cmd") || column.ends_with(".act"));
    if is_log {
        let message =
            "this is a log of commanded and actual positions, which show no geometry".to_owned();
        return block.error(
            line,
            message,
            "leave --geometry out to identify the axes from it",
        );
    }
    let columns = if block.columns.is_empty() {
        "none".to_owned()
    } else {
        block.columns.join(", ")
    };
    block.error(
        line,
        format!("this is no measurement that is known; its columns are: {columns}"),
        FORMATS,
    )
}

fn axis_of(block: &TextBlock, given: Option<usize>) -> Result<usize, MeasurementError> {
    let named = block.keys.get("axis").and_then(|name| {
        AXIS_NAMES
            .iter()
            .position(|axis| *axis == name.to_lowercase())
    });
    named.or(given).ok_or_else(|| {
        let message = "which axis this is of is not said".to_owned();
        block.error(
            block.line(),
            message,
            "give the file as x=FILE, or put a line '# axis: x' into it",
        )
    })
}

fn plane_of(block: &TextBlock) -> String {
    block
        .keys
        .get("plane")
        .map_or_else(|| "xy".to_owned(), |plane| plane.to_lowercase())
}

/// A set without rows, in its place.
fn set_of(
    block: &TextBlock,
    kind: &str,
    axes: String,
    at: &str,
) -> Result<MeasuredSet, MeasurementError> {
    let [x_mm, y_mm, z_mm] = block.place_mm(at)?;
    let calibrated = block.flag("calibrated");
    let set = MeasuredSet {
        kind: kind.to_owned(),
        axes,
        calibrated,
        x_mm,
        y_mm,
        z_mm,
        ..MeasuredSet::default()
    };
    if set.axis_numbers().is_none() {
        let message = format!("the plane is '{}'", set.axes);
        return Err(block.error(block.line(), message, "write '# plane: xy', xz or yz"));
    }
    Ok(set)
}

/// 1 or -1 of a direction.
fn way(block: &TextBlock, line: usize, cell: &str) -> Result<f64, MeasurementError> {
    match cell.to_lowercase().as_str() {
        "1" | "+1" | "+" | "ccw" | "g3" | "forward" | "up" => Ok(1.0),
        "-1" | "-" | "cw" | "g2" | "backward" | "reverse" | "down" => Ok(-1.0),
        other => {
            let message = format!("the direction is '{other}'");
            Err(block.error(
                line,
                message,
                "write 1 or -1, ccw or cw for a circle, forward or backward for an axis",
            ))
        }
    }
}

fn ball_bar(block: &TextBlock) -> Result<MeasuredSet, MeasurementError> {
    let mut set = set_of(block, "bar", plane_of(block), "center_mm")?;
    let radius = block
        .keys
        .get("radius_mm")
        .and_then(|value| value.parse::<f64>().ok())
        .filter(|mm| *mm > 0.0);
    let radius_mm = radius.ok_or_else(|| {
        block.error(
            block.line(),
            "the nominal radius is not said".to_owned(),
            "put a line '# radius_mm: 100' before the columns",
        )
    })?;
    set.radius_mm = radius_mm;
    let angle = block.column("angle", "").map_or(0, |(at, _)| at);
    let direction = block.column("direction", "").map(|(at, _)| at);
    let deviation = block
        .column("deviation", "um")
        .map(|of| (of, 0.0))
        .or(block.column("radius", "um").map(|of| (of, 1e3 * radius_mm)));
    let ((deviation, factor), nominal_um) = deviation.ok_or_else(|| {
        block.error(
            block.line(),
            "there is no column of deviations".to_owned(),
            "name it deviation_um or radius_mm",
        )
    })?;
    // What the encoders see is no geometry.
    let encoder = block.column("encoder", "um");
    for row in &block.rows {
        let cell = direction
            .and_then(|at| row.1.get(at))
            .or_else(|| block.keys.get("direction"))
            .map_or("", String::as_str);
        let encoder_um = encoder.map_or(Ok(0.0), |(at, factor)| {
            block.number(row, at).map(|value| factor * value)
        })?;
        let deviation_um = factor * block.number(row, deviation)? - nominal_um - encoder_um;
        set.rows.push(vec![
            block.number(row, angle)?,
            way(block, row.0, cell)?,
            deviation_um,
        ]);
    }
    if let Some(at) = set
        .rows
        .iter()
        .position(|row| row[2].abs() > 1e4 * 0.1 * radius_mm)
    {
        let message = format!(
            "a deviation of {} um is no reading of a ball bar of {radius_mm} mm",
            set.rows[at][2]
        );
        return Err(block.error(
            block.rows[at].0,
            message,
            "is the unit right? columns end with _um or _mm",
        ));
    }
    Ok(set)
}

fn positioning(block: &TextBlock, axis: Option<usize>) -> Result<MeasuredSet, MeasurementError> {
    let axis = axis_of(block, axis)?;
    let mut set = set_of(block, "axis", AXIS_NAMES[axis].to_owned(), "others_mm")?;
    let position = block
        .column("position", "mm")
        .or(block.column("target", "mm"))
        .map_or(0, |(at, _)| at);
    let no_values = || {
        block.error(
            block.line(),
            "there is no column of deviations".to_owned(),
            "name it deviation_um, measured_mm, or run1_forward_um, run1_backward_um",
        )
    };
    let direction = block.column("direction", "").map(|(at, _)| at);
    // Column, factor to um, direction or the column that says it, whether it is the position
    // itself.
    let mut values: Vec<(usize, f64, Option<f64>, bool)> = Vec::new();
    for (at, column) in block
        .columns
        .iter()
        .enumerate()
        .filter(|(at, _)| *at != position && Some(*at) != direction)
    {
        let factor = if column.ends_with("_mm") { 1e3 } else { 1.0 };
        if column.starts_with("deviation")
            || column.starts_with("measured")
            || column.starts_with("actual")
        {
            values.push((at, factor, None, !column.starts_with("deviation")));
        } else if column.contains("forward") || column.ends_with('+') {
            values.push((at, factor, Some(1.0), false));
        } else if column.contains("backward") || column.contains("reverse") || column.ends_with('-')
        {
            values.push((at, factor, Some(-1.0), false));
        }
    }
    if values.is_empty() {
        return Err(no_values());
    }
    for row in &block.rows {
        let at_mm = block.number(row, position)?;
        for &(column, factor, fixed, is_position) in &values {
            let cell = direction
                .and_then(|at| row.1.get(at))
                .map_or("", String::as_str);
            let way = fixed.map_or_else(|| way(block, row.0, cell), Ok)?;
            let value = block.number(row, column)?;
            let deviation_um = if is_position {
                1e3 * (value - at_mm)
            } else {
                factor * value
            };
            set.rows.push(vec![at_mm, way, deviation_um]);
        }
    }
    Ok(set)
}

fn grid(block: &TextBlock) -> Result<MeasuredSet, MeasurementError> {
    let axes: Vec<&str> = AXIS_NAMES
        .into_iter()
        .filter(|axis| {
            block.columns.iter().any(|column| {
                column.starts_with(&format!("{axis}_measured"))
                    || column.starts_with(&format!("d{axis}_"))
            })
        })
        .collect();
    let mut set = set_of(block, "grid", axes.concat(), "origin_mm")?;
    let columns = |axis: &str| {
        let command = block
            .column(&format!("{axis}_mm"), "mm")
            .map_or(0, |(at, _)| at);
        let difference = block.column(&format!("d{axis}_"), "um");
        (
            command,
            difference,
            block
                .column(&format!("{axis}_measured"), "mm")
                .map_or(0, |(at, _)| at),
        )
    };
    let (mut before, mut ways) = (None::<[f64; 2]>, [0.0; 2]);
    for row in &block.rows {
        let (mut at_mm, mut seen_um) = ([0.0; 2], [0.0; 2]);
        for (i, axis) in axes.iter().take(2).enumerate() {
            let (command, difference, measured) = columns(axis);
            at_mm[i] = block.number(row, command)?;
            seen_um[i] = match difference {
                Some((at, factor)) => factor * block.number(row, at)?,
                None => 1e3 * (block.number(row, measured)? - at_mm[i]),
            };
            let moved_mm = before.map_or(0.0, |before| at_mm[i] - before[i]);
            if moved_mm.abs() > 1e-6 {
                ways[i] = moved_mm.signum();
            }
        }
        before = Some(at_mm);
        set.rows.push(vec![
            at_mm[0], at_mm[1], ways[0], ways[1], seen_um[0], seen_um[1],
        ]);
    }
    Ok(set)
}

/// Names of distances of a test part: direction in degrees, and the factor by which each side moves
/// with the size of the tool.
const DISTANCES: [(&str, f64, f64); 8] = [
    ("circle_0", 0.0, 1.0),
    ("circle_45", 45.0, 1.0),
    ("circle_90", 90.0, 1.0),
    ("circle_135", 135.0, 1.0),
    ("square_0", 0.0, 1.0),
    ("square_90", 90.0, 1.0),
    ("diagonal_45", 45.0, std::f64::consts::SQRT_2),
    ("diagonal_135", 135.0, std::f64::consts::SQRT_2),
];

fn test_part(block: &TextBlock) -> Result<MeasuredSet, MeasurementError> {
    let mut set = set_of(block, "distance", plane_of(block), "center_mm")?;
    let column = |begins: &str| block.column(begins, "").map_or(0, |(at, _)| at);
    let [name, nominal, measured] = ["name", "nominal", "measured"].map(column);
    for row in &block.rows {
        let cell = row.1.get(name).map_or("", String::as_str).to_lowercase();
        let Some((_, angle_deg, size)) = DISTANCES.iter().find(|(known, ..)| *known == cell) else {
            let names = DISTANCES.map(|(name, ..)| name).join(", ");
            return Err(block.error(
                row.0,
                format!("no distance is called '{cell}'"),
                &format!("distances are {names}"),
            ));
        };
        let (nominal_mm, measured_mm) = (block.number(row, nominal)?, block.number(row, measured)?);
        let (sin, cos) = libm::sincos(angle_deg.to_radians());
        let [a, b] = [0.5 * nominal_mm * cos, 0.5 * nominal_mm * sin];
        set.rows
            .push(vec![-a, -b, a, b, *size, 1e3 * (measured_mm - nominal_mm)]);
    }
    Ok(set)
}
