//! Depth to which LinuxCNC's compensated tool cuts into the contour where this reader rejects the
//! program.

use feedwright_gcode::canon::{Canon, Plane};
use feedwright_gcode::{Dialect, Reader, Settings};

use crate::linuxcnc::{
    Spiral, Theirs, away_from, compensated_radius, path_of, point, without_compensation,
};

/// Number of points of a motion at which the depth of a cut is computed.
const CUT_POINTS: u32 = 65;

/// Returns the depth to which LinuxCNC's compensated tool cuts into the contour near a line, mm:
/// its motions of this line and of the line before, into the contour from the line before to the
/// line after. The entry has no contour.
pub(crate) fn cut_mm(text: &str, theirs: &Theirs, line: u32) -> f64 {
    let settings = Settings {
        dialect: Some(Dialect::LinuxCnc),
        max_motions: 1_000_000,
        ..Settings::default()
    };
    let Ok(reader) = Reader::from_text("contour", without_compensation(text), settings) else {
        return 0.0;
    };
    let lines: Vec<String> = text
        .lines()
        .map(|line| line.to_ascii_uppercase().replace(' ', ""))
        .collect();
    let begins = |line: &String| ["G41", "G42"].iter().any(|code| line.contains(code));
    let moves = |line: &String| line.contains(['X', 'Y', 'Z', 'I', 'J', 'K']);
    let begin = lines.iter().position(begins).unwrap_or(0);
    let entry = lines[begin..]
        .iter()
        .position(moves)
        .map_or(0, |behind| (begin + behind + 1) as u32);
    let mut contour = Vec::new();
    for step in reader {
        if let Ok(Canon::Motion(motion)) = step
            && (line - 1..=line + 1).contains(&motion.line)
            && motion.line != entry
        {
            contour.extend(path_of(&motion));
        }
    }
    let (mut start, mut nearest_mm) = ([0.0; 3], f64::INFINITY);
    for value in &theirs.moves {
        let end = point(&value[2]);
        let from = std::mem::replace(&mut start, std::array::from_fn(|axis| end[axis]));
        if !value[1]
            .as_u64()
            .is_some_and(|number| (u64::from(line) - 1..=u64::from(line)).contains(&number))
        {
            continue;
        }
        let spiral = (value[0] == "arc").then(|| {
            let plane = [Plane::Xy, Plane::Yz, Plane::Zx][match value[3].as_u64() {
                Some(2) => 1,
                Some(1) => 2,
                _ => 0,
            }];
            let center = [
                value[4][0].as_f64().unwrap_or(f64::NAN),
                value[4][1].as_f64().unwrap_or(f64::NAN),
            ];
            Spiral::new(
                from,
                end,
                center,
                plane,
                value[5].as_i64().unwrap_or(1) as i32,
            )
        });
        for number in 0..CUT_POINTS {
            let share = f64::from(number) / f64::from(CUT_POINTS - 1);
            let straight =
                || std::array::from_fn(|axis| from[axis] + share * (end[axis] - from[axis]));
            let at = spiral
                .as_ref()
                .map_or_else(straight, |spiral| spiral.at(share));
            nearest_mm = nearest_mm.min(away_from(&contour, at));
        }
    }
    compensated_radius(text) - nearest_mm
}
