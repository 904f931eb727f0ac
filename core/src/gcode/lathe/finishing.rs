//! G70: along the profile, from the first distance to the last in even steps.

use super::Lathe;
use super::profile::Profile;
use crate::gcode::diagnostic::Read;
use crate::gcode::state::Interpreter;
use crate::gcode::travel::Speed;

impl Interpreter {
    pub(super) fn finish_profile(&mut self, lathe: &Lathe, [first_mm, last_mm]: [f64; 2], passes: u32) -> Read<()> {
        let profile = Profile::new(lathe)?;
        for pass in 1..=passes {
            // The first pass already takes its share: D is what roughing has left.
            let distance_mm = first_mm + (last_mm - first_mm) * (f64::from(pass) / f64::from(passes));
            let offset = profile.offset(lathe, distance_mm)?;
            self.lathe_line(lathe, offset.side, offset.start, Speed::Rapid)?;
            self.lathe_line(lathe, offset.side, offset.entry(), Speed::Rapid)?;
            self.lathe_cut(lathe, &offset)?;
        }
        Ok(())
    }
}
