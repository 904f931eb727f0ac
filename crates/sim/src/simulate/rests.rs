//! Rests that are not simulated from one end to the other.
//!
//! Of a rest longer than [`LONGEST_S`] the first and the last [`SIMULATED_S`] are simulated: in the
//! first the tool settles, in the last everything that follows the machine takes hold of it again.
//! Between them tool, controller and identifier stay as they are; time, and with it the
//! disturbance, goes on. A tool change or a dwell so costs a second of simulation, however long it
//! is.

use crate::reference::Reference;

/// Rests up to this long are simulated as a whole, s.
const LONGEST_S: f64 = 1.0;
/// Simulated time at either end of a long rest, s.
const SIMULATED_S: f64 = 0.5;

/// Returns the number of servo periods after plan time `tau_s` that need no simulation: a multiple
/// of `feed_periods`. The tool has at least `settled_s` to settle.
pub(super) fn left_out(
    reference: &mut Reference<'_>,
    tau_s: f64,
    servo_s: f64,
    feed_periods: u32,
    settled_s: f64,
) -> u64 {
    let Some((from_s, to_s)) = reference.rest(tau_s) else {
        return 0;
    };
    if to_s - from_s <= LONGEST_S || tau_s - from_s < SIMULATED_S.max(settled_s) {
        return 0;
    }
    // The servo period after those left out is the first of the last stretch. A cast of a negative
    // number gives 0.
    let left_out = ((to_s - SIMULATED_S - tau_s) / servo_s).floor() - 1.0;
    left_out as u64 / u64::from(feed_periods) * u64::from(feed_periods)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::machine::Machine;
    use feedwright_gcode::{Reader, Settings};

    const SERVO_S: f64 = 1e-3;

    #[test]
    fn half_a_second_at_either_end_of_a_long_rest_is_left() {
        let machine = Machine::load("tnv40".as_ref()).unwrap();
        for (dwell_s, wanted) in [
            (0.9, 0),
            (1.0, 0),
            (1.1, 99),
            (4.0, 2997),
            (1e6, 999_998_997),
        ] {
            let text = format!("G21 G90 F600\nG1 X1\nG4 P{dwell_s}\nG1 X2\nM2\n");
            let program = Reader::from_text("dwell.ngc", text, Settings::default())
                .unwrap()
                .map(Result::unwrap);
            let mut reference = Reference::of_program(program, &machine).unwrap();
            let end_s = reference.read_to_end_s();
            let (mut tau_s, mut found) = (0.0, 0);
            while tau_s < end_s {
                let periods = left_out(&mut reference, tau_s, SERVO_S, 3, 0.1);
                assert!(periods == 0 || found == 0, "a second gap");
                found += periods;
                tau_s += (periods + 1) as f64 * SERVO_S;
            }
            // What is not a whole number of feed periods stays.
            assert!(
                found % 3 == 0 && found <= wanted && found + 4 > wanted,
                "{dwell_s} s: {found} of {wanted}"
            );
        }
    }
}
