//! Mistakes of a program, its totals, and its path.

use feedwright::gcode::{CheckError, Diagnostic, Program, Settings, Severity, Summary};
use feedwright::plan::{Piece, Step};
use feedwright::sim::path_steps;
use serde_json::{Value, json};

use crate::request::{Outputs, PageRequest, json};

/// Largest number of points of a path that is drawn: 16 MB.
const MOST_POINTS: usize = 1_000_000;
/// Angle between two points of a curve, rad: a chord of a circle as large as a screen deviates from
/// it by half a pixel.
const TURN: f64 = 0.08;
/// Largest number of points of a piece.
const MOST_OF_PIECE: f64 = 256.0;

pub(crate) fn check(request: &mut PageRequest) -> miette::Result<Outputs> {
    let program = request.take_program();
    let mut answer = match program.check(Settings::default()) {
        Ok(summary) => {
            json!({ "findings": findings(&summary.warnings), "amounts_to": amounts_to(&summary) })
        }
        Err(CheckError::Read(error)) => return Err(error.into()),
        Err(CheckError::Faults(faults)) => {
            json!({ "findings": findings(&faults), "amounts_to": null })
        }
    };
    let path = Path::of(&program)?;
    answer["is_whole"] = path.is_whole.into();
    if let Some(machine) = request.machine_of_text()? {
        answer["machine"] = json!({ "name": machine.name, "about": machine.description });
    }
    Ok(vec![json(&answer), path.points, path.kinds])
}

fn findings(all: &[Diagnostic]) -> Vec<Value> {
    let finding = |found: &Diagnostic| {
        json!({
            "severity": if found.severity == Severity::Error { "error" } else { "warning" },
            "line": found.line,
            "column": found.column,
            "length": found.span,
            "message": found.message,
            "hint": found.hint,
        })
    };
    all.iter().map(finding).collect()
}

fn amounts_to(summary: &Summary) -> Value {
    let (dialect, reason) = summary.dialect;
    json!({
        "lines": summary.lines,
        "motions": summary.motions,
        "feed_mm": summary.feed_mm,
        "rapid_mm": summary.rapid_mm,
        "box_mm": summary.box_mm,
        "dialect": format!("{dialect}: {reason}"),
    })
}

/// Programmed path up to the first mistake, as numbers in little-endian order.
struct Path {
    /// x, y and z, mm, 32-bit floats.
    points: Vec<u8>,
    /// Twice the line, 32 bits; odd if the tool cuts on its way to the point.
    kinds: Vec<u8>,
    count: usize,
    /// True if it is the whole path.
    is_whole: bool,
}

impl Path {
    fn of(program: &Program) -> miette::Result<Self> {
        let mut path = Self {
            points: Vec::new(),
            kinds: Vec::new(),
            count: 0,
            is_whole: true,
        };
        let mut faults = 0;
        let canon = program.reader(Settings::default())?;
        let canon = canon.map_while(|step| step.inspect_err(|_| faults += 1).ok());
        for step in path_steps(canon) {
            match step {
                Ok(Step::Piece(piece)) if path.count < MOST_POINTS => path.push(&piece),
                Ok(Step::Piece(_)) | Err(_) => {
                    path.is_whole = false;
                    break;
                }
                Ok(_) => {}
            }
        }
        path.is_whole &= faults == 0;
        Ok(path)
    }

    fn push(&mut self, piece: &Piece) {
        if self.count == 0 {
            self.point(piece.start_mm, 2 * piece.line);
        }
        let turn = piece.curve.curvature(0.5 * piece.length_mm) * piece.length_mm;
        let chords = if piece.curve.is_straight() {
            1.0
        } else {
            (turn / TURN).ceil().clamp(2.0, MOST_OF_PIECE)
        };
        for chord in 1..=chords as u32 {
            let s_mm = piece.length_mm * f64::from(chord) / chords;
            self.point(
                piece.curve.at(s_mm).position_mm,
                2 * piece.line + u32::from(piece.cutting),
            );
        }
    }

    fn point(&mut self, position_mm: [f64; 3], kind: u32) {
        self.points
            .extend(position_mm.iter().flat_map(|mm| (*mm as f32).to_le_bytes()));
        self.kinds.extend(kind.to_le_bytes());
        self.count += 1;
    }
}
