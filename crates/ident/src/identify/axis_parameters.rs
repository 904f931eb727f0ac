//! Inertia and friction of an axis from commanded and measured positions, where the drive settings
//! are known.
//!
//! ```text
//! minimise  V(p) = sum_k (y(k) - y_s(k; c, p))^2        over all knots of all stretches but their beginnings
//! dp = (S^T S)^-1 S^T (y - y_s),   S = dy_s / dp         Gauss and Newton, in shorter steps where V grows
//! ```
//!
//! y measured position, c commands, y_s the free run of the axis model on the commands alone
//! (`axis_parameters/free_run.rs`), p the parameters. This is the output error of the closed loop.
//! Encoder noise and torque noise do not depend on the command. They are uncorrelated with S and do
//! not move the minimum. Linear least squares on a torque that is recomputed from measured
//! positions would have the noise in its regressors, twice differentiated (errors in variables).
//! Error of the inertia, measured over both axes (`crates/ident/tests/oracle_axis_parameters.rs`
//! has the method, the bounds, and holds them):
//!
//! | Machine | output error | least squares on the torque |
//! |---|--:|--:|
//! | tnv40 | -0.04 to 0.0 % | +0.2 % |
//! | tnv40, encoder noise 0.1 um | -0.04 to 0.0 % | -20 to -24 % |
//! | tnv40, encoder noise 0.5 um | -0.05 to 0.0 % | -86 to -88 % |
//! | workshop | 0.0 % | +4 to +6 % |
//! | stiff | 0.0 % | +8 % |
//! | router, with backlash and a late bus | +4 to +6 % | -64 to -65 % |
//!
//! Standard errors count each stretch as one observation, because the residuals are correlated
//! within a stretch (a vibration, torque noise):
//!
//! ```text
//! cov p = H^-1 (sum_stretches g g^T) H^-1 n / (n - 1),   H = S^T S,  g = S^T (y - y_s) over a stretch
//! ```
//!
//! They show the effect of the noise, not of effects that the model lacks: Stribeck's curve goes
//! into the Coulomb friction and the presliding, a bus that is late at random into all parameters.
//!
//! | File | What |
//! |---|---|
//! | `axis_parameters/free_run.rs` | response of the model to the commands alone |
//! | `axis_parameters/output_error_fit.rs` | the steps of Gauss and Newton, and the standard errors |
//! | `axis_parameters/screw_fit.rs` | compliance of the ball screw, if it shows |
//!
//! Source: Gautier, Janot and Vandanjon (2013), A new closed-loop output error method for parameter
//! identification of robot dynamics, IEEE Trans. Control Systems Technology 21(2), for the output
//! error of an axis in its loop with known gains; Landau and Karimi (1997), Recursive algorithms
//! for identification in closed loop, Automatica 33(8), for why it is unbiased; Young (1970), An
//! instrumental variable method for real-time identification of a noisy process, for what errors in
//! variables do; Liang and Zeger (1986), Longitudinal data analysis using generalized linear
//! models, Biometrika 73(1), for the standard errors.

mod free_run;
mod output_error_fit;
mod screw_fit;

use feedwright_control::{AxisModel, Parameters, Part};
use feedwright_sim::{Known, KnownAxis};
use serde::{Deserialize, Serialize};
use thiserror::Error;

use super::recording::Recording;
use output_error_fit::{OutputErrorFit, START_KNOTS, Stretch};

/// Speed over which Coulomb friction changes its sign where no presliding shows, mm/s of travel:
/// the value of tnv40. It only keeps the model smooth. No recording could determine it, since it
/// acts for a millisecond of a reversal.
const SMOOTHING_MM_S: f64 = 0.08;

/// The numbers that are identified: inertia, friction and the screw.
const IDENTIFIED: [fn(&mut Parameters) -> &mut f64; 9] = [
    |axis| &mut axis.inertia_kg_m2,
    |axis| &mut axis.viscous_friction_nm_s,
    |axis| &mut axis.coulomb_friction_nm,
    |axis| &mut axis.coulomb_asymmetry_nm,
    |axis| &mut axis.presliding_rad,
    |axis| &mut axis.table_share,
    |axis| &mut axis.resonance_rad_s,
    |axis| &mut axis.damping_ratio,
    |axis| &mut axis.backlash_rad,
];
/// Number of identified numbers of an axis with a rigid screw.
const RIGID: usize = 5;

/// The identified numbers as a row, which is what files hold.
mod identified {
    use super::{Deserialize, IDENTIFIED, Parameters};
    use serde::{Deserializer, Serialize, Serializer};

    pub(super) fn row(mut axis: Parameters) -> [f64; IDENTIFIED.len()] {
        IDENTIFIED.map(|of| *of(&mut axis))
    }

    pub(super) fn of_row(row: [f64; IDENTIFIED.len()]) -> Parameters {
        let mut axis = Parameters::NOTHING;
        IDENTIFIED
            .iter()
            .zip(row)
            .for_each(|(of, value)| *of(&mut axis) = value);
        axis
    }

    pub(super) fn serialize<S: Serializer>(axis: &Parameters, to: S) -> Result<S::Ok, S::Error> {
        row(*axis).serialize(to)
    }

    pub(super) fn deserialize<'d, D: Deserializer<'d>>(from: D) -> Result<Parameters, D::Error> {
        Deserialize::deserialize(from).map(of_row)
    }
}

/// Returns an axis whose drive is known with its identified numbers. The torque that the drive
/// feeds forward does not depend on what the inertia is taken for.
fn with_identified(known: &Parameters, found: &Parameters) -> Parameters {
    let fed_kg_m2 = known.acceleration_feedforward * known.inertia_kg_m2;
    Parameters {
        acceleration_feedforward: fed_kg_m2 / found.inertia_kg_m2,
        inertia_kg_m2: found.inertia_kg_m2,
        viscous_friction_nm_s: found.viscous_friction_nm_s,
        coulomb_friction_nm: found.coulomb_friction_nm,
        coulomb_smoothing_rad_s: SMOOTHING_MM_S * known.rad_per_mm,
        ..known.taking(&[Part::Friction, Part::Screw], found)
    }
}

/// Result of the identification of an axis.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct AxisEstimate {
    /// The identified parameters, all others zero: inertia, viscous and Coulomb friction, its
    /// asymmetry, which includes a weight that hangs on the axis, presliding and the screw, zero
    /// where the recording does not show them.
    #[serde(with = "identified")]
    pub parameters: Parameters,
    /// Their standard errors.
    #[serde(with = "identified")]
    pub standard_errors: Parameters,
    /// RMS of what is left of the measured position, um.
    pub left_um: f64,
    /// Steps that it took.
    pub(crate) steps: u32,
}

impl AxisEstimate {
    /// Returns the axis as known after the identification. Only the drive comes from its data
    /// sheets.
    #[must_use]
    pub fn assumed(&self, axis: &KnownAxis) -> KnownAxis {
        let nominal = with_identified(&axis.nominal, &self.parameters);
        let less_nm = axis.nominal.coulomb_friction_nm - nominal.coulomb_friction_nm;
        KnownAxis {
            nominal,
            spare_torque_nm: (axis.spare_torque_nm + less_nm).max(0.0),
            ..*axis
        }
    }
}

/// Why nothing was found.
#[derive(Debug, Clone, Copy, PartialEq, Error)]
pub enum NotIdentified {
    /// The knots are not one servo period apart. The model needs every command that the drive had.
    #[error(
        "the recording has a knot each {found_s} s, and the servo period is {needed_s} s\n  hint: record in every servo period"
    )]
    Period {
        /// Time between the knots of the recording, s.
        found_s: f64,
        /// Servo period of the drive, s.
        needed_s: f64,
    },
    /// No stretch is left behind its beginning, or one alone, which says nothing of the errors.
    #[error(
        "{stretches} stretches are longer than {settled_s:.3} s, in which an axis settles, and {LEAST_STRETCHES} are needed\n  hint: record for longer"
    )]
    TooShort {
        /// Stretches that are long enough.
        stretches: usize,
        /// Time in which an axis settles at the start of a stretch, s.
        settled_s: f64,
    },
    /// The axis does not move so that a parameter shows.
    #[error(
        "the axis does not move so that its parameters show\n  hint: record both directions and several speeds"
    )]
    NotExcited,
}

/// Stretches that standard errors need.
const LEAST_STRETCHES: usize = 2;
/// Time constants of the position loop after which the beginning is forgotten: what the drive had
/// summed up is not recorded. e^-5 is 0.7 %.
const SETTLED_CONSTANTS: f64 = 5.0;

/// Finds the parameters of the i-th axis, whose drive is set as it is known. What is known of its
/// inertia and friction is used only for the torque that the drive feeds forward.
///
/// # Errors
/// Fails if the recording does not determine them.
pub fn identify_axis<const N: usize>(
    recording: &Recording<N>,
    i: usize,
    known: &Known,
) -> Result<AxisEstimate, NotIdentified> {
    let axis = known.axis(i);
    let axis_model = AxisModel::new(axis.nominal, known.period.periods());
    let servo_s = axis_model.periods.servo_s;
    if (recording.feed_period_s - servo_s).abs() > 1e-9 * servo_s {
        return Err(NotIdentified::Period {
            found_s: recording.feed_period_s,
            needed_s: servo_s,
        });
    }
    let settled_s = SETTLED_CONSTANTS / axis.nominal.kp_1_s;
    let settled = (settled_s / servo_s).ceil() as usize;
    let stretches: Vec<Stretch> = recording
        .of_axis(i, axis.nominal.command_periods(servo_s))
        .into_iter()
        .filter(|rows| rows.len() > settled + START_KNOTS)
        .map(|rows| {
            let (commands_mm, measured_mm) = rows.into_iter().map(<(f64, f64)>::from).unzip();
            Stretch {
                commands_mm,
                measured_mm,
            }
        })
        .collect();
    if stretches.len() < LEAST_STRETCHES {
        return Err(NotIdentified::TooShort {
            stretches: stretches.len(),
            settled_s,
        });
    }
    let fit = OutputErrorFit {
        known: axis_model,
        stretches,
        settled,
    };
    let rigid = fit.rigid()?;
    // A scale on the table sees what the screw does, and the loops hold the table.
    if axis.scale_on_table {
        return Ok(rigid);
    }
    Ok(screw_fit::with_screw(&fit, &rigid).unwrap_or(rigid))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::identify::recording::RecordedKnot;
    use feedwright_sim::Machine;

    fn known() -> Known {
        Machine::load("stiff".as_ref()).unwrap().known()
    }

    fn recording(
        knots: usize,
        stretches: usize,
        command_mm: impl Fn(usize) -> f64,
    ) -> Recording<1> {
        let knot = |k| RecordedKnot {
            command_mm: [command_mm(k)],
            tool_mm: [command_mm(k)],
            contour_mm: [0.0],
        };
        let stretch: Vec<_> = (0..knots).map(knot).collect();
        let servo_s = known().period.servo_s;
        Recording {
            servo_s,
            feed_period_s: servo_s,
            stretches: vec![stretch; stretches],
        }
    }

    #[test]
    fn a_log_that_does_not_determine_the_parameters_is_refused_with_the_reason() {
        let known = known();
        let refused = |recording: &Recording<1>| identify_axis(recording, 0, &known).unwrap_err();
        let sine = |k: usize| libm::sin(0.01 * k as f64);
        // Five time constants of 1/120 s are 84 servo periods.
        assert!(matches!(
            refused(&recording(80, 5, sine)),
            NotIdentified::TooShort { stretches: 0, .. }
        ));
        assert!(matches!(
            refused(&recording(200, 1, sine)),
            NotIdentified::TooShort { stretches: 1, .. }
        ));
        assert_eq!(
            refused(&recording(200, 5, |_| 1.0)),
            NotIdentified::NotExcited
        );
        let coarse = Recording {
            feed_period_s: 0.003,
            ..recording(200, 5, sine)
        };
        assert_eq!(
            refused(&coarse),
            NotIdentified::Period {
                found_s: 0.003,
                needed_s: 0.0005
            }
        );
    }

    #[test]
    fn the_torque_that_a_drive_feeds_forward_does_not_depend_on_what_the_inertia_is_taken_for() {
        let known = known();
        let axis = known.axis(0);
        let found = AxisEstimate {
            parameters: Parameters {
                inertia_kg_m2: 2.0 * axis.nominal.inertia_kg_m2,
                ..Parameters::NOTHING
            },
            standard_errors: Parameters::NOTHING,
            left_um: 0.0,
            steps: 0,
        };
        let assumed = found.assumed(axis);
        assert_eq!(
            assumed.nominal.acceleration_feedforward,
            0.5 * axis.nominal.acceleration_feedforward
        );
        assert_eq!(
            assumed.nominal.kv_nm_s_per_rad,
            axis.nominal.kv_nm_s_per_rad
        );
        let more_nm = assumed.spare_torque_nm - axis.spare_torque_nm;
        assert!(
            (more_nm - axis.nominal.coulomb_friction_nm).abs() < 1e-12,
            "{more_nm}"
        );
    }
}
