//! G71 and G72: straight passes from the surface down to the profile, then once along it.

use super::profile::{Profile, SLACK_MM, end_of, start_of};
use super::{Lathe, MOST_PASSES};
use crate::gcode::diagnostic::{Fault, Read};
use crate::gcode::plane::{Curve, length, minus};
use crate::gcode::state::Interpreter;
use crate::gcode::travel::Speed;

impl Interpreter {
    pub(super) fn rough(&mut self, lathe: &Lathe, depth_mm: f64, retraction_mm: f64, left_mm: f64) -> Read<()> {
        let mut profile = Profile::new(lathe)?.offset(lathe, left_mm)?;
        let (start, entry) = (profile.start, profile.entry());
        // The last pass must meet something: a profile that ends below the surface goes up to it.
        if let Some(last) = profile.curves.last().map(end_of)
            && last[1] < start[1] - SLACK_MM
        {
            profile.curves.push(Curve::Line { start: last, end: [last[0], start[1]] });
        }
        let passes = ((start[1] - entry[1]) / depth_mm).max(0.0);
        if passes > MOST_PASSES {
            let message = format!("the depth of a pass of {depth_mm} mm makes more than {MOST_PASSES} passes");
            return Err(Fault::new("gcode::lathe", lathe.block.at(b'q'), message).hint("make I larger"));
        }
        let side = profile.side;
        self.lathe_line(lathe, side, start, Speed::Rapid)?;
        let mut pass = 0_u32;
        loop {
            let level = start[1] - f64::from(pass) * depth_mm;
            if level <= entry[1] + SLACK_MM {
                break;
            }
            let share = (start[1] - level) / (start[1] - entry[1]);
            let begin = [start[0] + share * (entry[0] - start[0]), level];
            let hit = [first_at(&profile.curves, level), level];
            self.lathe_line(lathe, side, begin, Speed::Rapid)?;
            self.lathe_line(lathe, side, hit, Speed::Programmed)?;
            // Never past the middle of a short pass: the way back leads back.
            let away_mm = retraction_mm.min(0.5 * (hit[0] - begin[0]).max(0.0));
            let above = level + away_mm;
            self.lathe_line(lathe, side, [hit[0] - away_mm, above], Speed::Rapid)?;
            self.lathe_line(lathe, side, [begin[0] + away_mm, above], Speed::Rapid)?;
            self.lathe_line(lathe, side, begin, Speed::Rapid)?;
            pass += 1;
        }
        let speed = Self::lathe_entry_speed(&profile);
        self.lathe_line(lathe, side, entry, speed)?;
        self.lathe_cut(lathe, &profile)
    }
}

/// Where curves that never go down first reach `level`.
fn first_at(curves: &[Curve], level: f64) -> f64 {
    let Some(curve) = curves.iter().find(|curve| end_of(curve)[1] >= level - SLACK_MM) else {
        return curves.last().map_or(0.0, |last| end_of(last)[0]);
    };
    let (start, end) = (start_of(curve), end_of(curve));
    if start[1] >= level - SLACK_MM {
        return start[0];
    }
    match *curve {
        Curve::Line { .. } => start[0] + (end[0] - start[0]) * ((level - start[1]) / (end[1] - start[1])).min(1.0),
        Curve::Arc { center, turn, .. } => {
            let radius = length(minus(start, center));
            let half = (radius * radius - (level - center[1]).powi(2)).max(0.0).sqrt();
            // Rising, a left turn is on the right of its centre and a right turn on the left.
            (center[0] + turn * half).clamp(start[0], end[0])
        }
    }
}
