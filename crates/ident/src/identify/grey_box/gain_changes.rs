//! Effects of other settings of the drive on the motions of the log: by formula, and simulated.
//!
//! ```text
//! e(t) = ((Kv + B) / J - f Kv / J) / a v + acc / a + (Fc sign v + offset) / (a J)      a = Kp Kv / J
//! ```
//!
//! e following error, v and acc of the command, f velocity feedforward: the model after its
//! transients have decayed. With an integral part of the speed loop friction has no share. Only
//! changes that the log supports are tried: its own motions, and gains within bounds that keep the
//! loops apart.
//!
//! Source: steady error of a cascaded loop as in Altintas (2012), Manufacturing Automation, section
//! 5.5.

use super::axis_record::AxisRecord;
use super::axis_run::{AxisRun, Commands};
use super::terms::{ModelTerm, TermValues};
use crate::average::rms;

/// Settings that differ from those that were found.
#[derive(Debug, Clone, PartialEq)]
pub struct GainChange {
    /// Kp, 1/s, where it is another one.
    pub(crate) kp_1_s: Option<f64>,
    /// Velocity feedforward, where it is another one.
    pub(crate) velocity_feedforward: Option<f64>,
    /// RMS of the following error by formula, um.
    pub predicted_um: f64,
    /// RMS of the following error of a free run, um.
    pub simulated_um: f64,
    /// The same with the settings as they are, um.
    pub now_um: f64,
}

/// Velocity feedforward that is tried: some is left, so that corners do not overshoot.
const FEEDFORWARD: f64 = 0.95;
/// Factor on Kp that is tried, and most that it becomes of (Kv + B) / J: a damping ratio of 1.
const FASTER: f64 = 1.5;
const LOOPS_APART: f64 = 0.25;
/// A change of a gain by less than this factor is not tried. A change that leaves more than this
/// part of the error is not reported.
const WORTH_TRYING: f64 = 1.1;
const WORTH_REPORTING: f64 = 0.8;

impl GainChange {
    /// Returns the changes that are worth reporting, the least error last.
    pub(super) fn find(record: &AxisRecord<'_>, values: &TermValues, counts: &[bool]) -> Vec<Self> {
        let now_um = simulated_um(record, values, counts);
        let feedforward = (values.get(ModelTerm::VelocityFeedforward) * WORTH_TRYING < FEEDFORWARD)
            .then_some(FEEDFORWARD);
        let kp_1_s = (FASTER * values.kp_1_s()).min(LOOPS_APART * values.get(ModelTerm::Damping));
        let faster = (kp_1_s > WORTH_TRYING * values.kp_1_s()).then_some(kp_1_s);
        let tried = [(faster, None), (None, feedforward), (faster, feedforward)];
        let mut changes: Vec<Self> = vec![];
        for (kp_1_s, velocity_feedforward) in tried {
            let is_new = kp_1_s.is_some() || velocity_feedforward.is_some();
            if !is_new
                || changes
                    .iter()
                    .any(|c| (c.kp_1_s, c.velocity_feedforward) == (kp_1_s, velocity_feedforward))
            {
                continue;
            }
            let loop_gain = kp_1_s.map_or(values.get(ModelTerm::LoopGain), |kp_1_s| {
                kp_1_s * values.speed_gain_1_s()
            });
            let part = velocity_feedforward.unwrap_or(values.get(ModelTerm::VelocityFeedforward));
            let other = values
                .with(ModelTerm::LoopGain, loop_gain)
                .with(ModelTerm::VelocityFeedforward, part);
            let (predicted_um, simulated_um) = (
                predicted_um(record, &other, counts),
                simulated_um(record, &other, counts),
            );
            if simulated_um < WORTH_REPORTING * now_um {
                changes.push(Self {
                    kp_1_s,
                    velocity_feedforward,
                    predicted_um,
                    simulated_um,
                    now_um,
                });
            }
        }
        changes.sort_by(|a, b| b.simulated_um.total_cmp(&a.simulated_um));
        changes
    }

    /// `Kp 60.1 1/s and a velocity feedforward of 0.95`.
    pub fn words(&self) -> String {
        let kp = self.kp_1_s.map(|kp_1_s| format!("Kp {kp_1_s:.1} 1/s"));
        let feedforward = self
            .velocity_feedforward
            .map(|part| format!("a velocity feedforward of {part}"));
        [kp, feedforward]
            .into_iter()
            .flatten()
            .collect::<Vec<_>>()
            .join(" and ")
    }
}

/// RMS of the following error of a free run over samples that count, um; infinite where it is lost.
fn simulated_um(record: &AxisRecord<'_>, values: &TermValues, counts: &[bool]) -> f64 {
    let run = AxisRun::new(values, record.sample_s);
    let mut errors_mm = vec![];
    for stretch in record.stretches {
        let commands = Commands::new(&record.command_mm[stretch.clone()]);
        let [mm, mm_s] = record.start(stretch, stretch.start);
        let mut state = run.state(&commands, 0, mm, mm_s);
        for k in stretch.clone() {
            if counts[k] {
                errors_mm.push(record.command_mm[k] - state.position_mm());
            }
            run.step(&commands, k - stretch.start, &mut state);
        }
    }
    let um = 1e3 * rms(errors_mm);
    if um.is_finite() { um } else { f64::INFINITY }
}

/// Predicts the same error by the model without its transients.
fn predicted_um(record: &AxisRecord<'_>, values: &TermValues, counts: &[bool]) -> f64 {
    let get = |term| values.get(term);
    let [speeds, accelerations] = [
        record.command_speed_mm_s(),
        record.command_acceleration_mm_s2(),
    ];
    let loop_gain = get(ModelTerm::LoopGain);
    let slides = if get(ModelTerm::Integral) > 0.0 {
        0.0
    } else {
        1.0
    };
    let drag_1_s = if get(ModelTerm::Integral) > 0.0 {
        values.speed_gain_1_s()
    } else {
        get(ModelTerm::Damping)
    } - get(ModelTerm::VelocityFeedforward) * values.speed_gain_1_s();
    let error_mm = |k: usize| {
        let sign = if speeds[k] == 0.0 {
            0.0
        } else {
            speeds[k].signum()
        };
        let friction =
            slides * (sign * get(ModelTerm::Coulomb) + sign.abs() * get(ModelTerm::Offset));
        let inertia = (1.0 - get(ModelTerm::AccelerationFeedforward)) * accelerations[k];
        (drag_1_s * speeds[k] + inertia + friction) / loop_gain
            + values.commands_late_s() * speeds[k]
    };
    1e3 * rms((0..counts.len()).filter(|&k| counts[k]).map(error_mm))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::identify::grey_box::terms::TERMS;

    #[test]
    fn formula_and_simulation_agree_on_a_slow_motion_and_feedforward_takes_the_lag_away() {
        let command_mm: Vec<f64> = (0..4000)
            .map(|k| 20.0 * libm::sin(f64::from(k) * 1e-3))
            .collect();
        let whole = 0..4000;
        let record = AxisRecord {
            name: "x",
            sample_s: 1e-3,
            stretches: std::slice::from_ref(&whole),
            command_mm: &command_mm,
            actual_mm: &command_mm,
            step_mm: 0.0,
        };
        let values = TermValues([0.0; TERMS])
            .with(ModelTerm::LoopGain, 20.0 * 200.0)
            .with(ModelTerm::Damping, 200.0)
            .with(ModelTerm::Coulomb, 10.0);
        let counts: Vec<bool> = (0..4000).map(|k| k > 1000).collect();
        let (formula, run) = (
            predicted_um(&record, &values, &counts),
            simulated_um(&record, &values, &counts),
        );
        assert!((formula / run - 1.0).abs() < 0.02, "{formula} {run}");
        let changes = GainChange::find(&record, &values, &counts);
        assert_eq!(changes.len(), 2 + 1, "{changes:?}");
        let [faster, fed, both] = [&changes[0], &changes[1], &changes[2]];
        assert_eq!(
            (faster.kp_1_s, fed.velocity_feedforward),
            (Some(30.0), Some(0.95))
        );
        assert!(
            (faster.simulated_um * 1.5 / run - 1.0).abs() < 0.02,
            "{faster:?}"
        );
        assert!(
            both.simulated_um < fed.simulated_um && fed.simulated_um < 0.2 * run,
            "{changes:?}"
        );
        assert_eq!(
            both.words(),
            "Kp 30.0 1/s and a velocity feedforward of 0.95"
        );
    }
}
