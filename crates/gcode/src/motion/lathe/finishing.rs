//! G70: along the profile, from the first distance to the last in even steps.

use crate::motion::feed::Speed;
use crate::motion::lathe::profile::Profile;
use crate::state::Interpreter;
use crate::state::lathe::{LatheCycle, MAX_MOTIONS};
use crate::text::codes::bit;
use crate::text::diagnostic::{LineFault, Read};

impl Interpreter {
    pub(super) fn finish_profile(
        &mut self,
        lathe: &LatheCycle,
        [first_mm, last_mm]: [f64; 2],
        passes: u32,
    ) -> Read<()> {
        let profile = Profile::new(lathe)?;
        let motions = lathe.motions.len() as u64 * u64::from(passes);
        if motions > MAX_MOTIONS as u64 {
            let message = format!(
                "{passes} passes along {} motions in one line",
                lathe.motions.len()
            );
            let fault = LineFault::new(
                "gcode::lathe",
                lathe.block.at_any(bit(b'p') | bit(b'q')),
                message,
            );
            return Err(fault
                .hint("the product may be 100000: cut the last passes with a G70 of their own"));
        }
        for pass in 1..=passes {
            // The first pass already takes its share: D is what roughing has left.
            let distance_mm =
                first_mm + (last_mm - first_mm) * (f64::from(pass) / f64::from(passes));
            let offset = profile.offset(lathe, distance_mm)?;
            self.lathe_line(lathe, offset.plane, offset.start, Speed::Rapid)?;
            self.lathe_line(lathe, offset.plane, offset.entry(), Speed::Rapid)?;
            self.lathe_cut(lathe, &offset)?;
        }
        Ok(())
    }
}
