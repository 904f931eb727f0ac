//! The identification programme, cut by a simulated machine: laps of circles under a controller
//! that disturbs the command and records.

use feedwright_control::{Command, Controller, Measured, Schedule, SelfReport, Window};
use feedwright_gcode::canon::{AuxiliaryAxes, Canon, Corner, Motion, MotionKind, Plane, Shape};
use feedwright_plan::vector::{add_scaled, sub};
use feedwright_sim::{Machine, Run, Stages, path_steps};
use rand::RngExt;

use super::recording::{RecordedKnot, Recording};
use super::{Excitation, Rng};

/// Every third lap runs undisturbed: the network sees the plain circle as well.
const UNDISTURBED_EVERY: u32 = 3;

/// Cuts all laps.
pub(super) fn record<const N: usize>(
    machine: &Machine,
    excitation: &Excitation,
    rng: &mut Rng,
) -> Recording<N> {
    let stretches = (0..excitation.laps)
        .map(|lap| {
            let motion = circle::<N>(excitation, lap, rng);
            let undisturbed = lap.is_multiple_of(UNDISTURBED_EVERY);
            let mut excitation = ExcitationController {
                excitation,
                servo_periods: machine.period.servo_periods(excitation.feed_period_s),
                reach_mm: if undisturbed {
                    0.0
                } else {
                    excitation.offset_mm
                },
                rng,
                from_mm: [0.0; N],
                to_mm: [0.0; N],
                lap: Vec::new(),
            };
            // A lap that diverges simply ends.
            cut_on(machine)
                .cut(
                    || Ok(path_steps([Canon::Motion(motion.clone())])),
                    &mut excitation,
                    &mut [],
                )
                .expect("a circle on a machine that was checked, no sinks");
            excitation.lap
        })
        .collect();
    let (servo_s, feed_period_s) = (machine.period.servo_s, excitation.period_s(machine));
    Recording {
        servo_s,
        feed_period_s,
        stretches,
    }
}

/// Planned with constant accelerations on every machine: offsets excite the axes more than any
/// plan, and a circle is planned in no time.
fn cut_on(machine: &Machine) -> Run<'_> {
    Run::on(machine).uncompensated().stages(Stages::default())
}

/// Cuts all laps one after the other, with offsets in all of them.
pub(super) fn record_in_one<const N: usize>(
    machine: &Machine,
    excitation: &Excitation,
    rng: &mut Rng,
) -> Recording<N> {
    let motions: Vec<Canon> = (0..excitation.laps)
        .map(|lap| Canon::Motion(circle::<N>(excitation, lap, rng)))
        .collect();
    let mut excitation_controller = ExcitationController {
        excitation,
        servo_periods: machine.period.servo_periods(excitation.feed_period_s),
        reach_mm: excitation.offset_mm,
        rng,
        from_mm: [0.0; N],
        to_mm: [0.0; N],
        lap: Vec::new(),
    };
    cut_on(machine)
        .cut(
            || Ok(path_steps(motions.clone())),
            &mut excitation_controller,
            &mut [],
        )
        .expect("circles on a machine that was checked, no sinks");
    let (servo_s, feed_period_s) = (machine.period.servo_s, excitation.period_s(machine));
    Recording {
        servo_s,
        feed_period_s,
        stretches: vec![excitation_controller.lap],
    }
}

/// One lap: radii, senses and planes in turn, feed and starting point at random.
fn circle<const N: usize>(excitation: &Excitation, lap: u32, rng: &mut Rng) -> Motion {
    let lap_index = lap as usize;
    let radius = excitation.radii_mm[lap_index % excitation.radii_mm.len()];
    let plane = match (N, lap % 3) {
        (3, 1) => Plane::Zx,
        (3, 2) => Plane::Yz,
        _ => Plane::Xy,
    };
    let [first, second, _] = plane.axes();
    let [slow, fast] = excitation.feed_mm_s;
    let angle: f64 = rng.random_range(0.0..std::f64::consts::TAU);
    let mut center_mm = [0.0; 3];
    (center_mm[first], center_mm[second]) = (radius * libm::cos(angle), radius * libm::sin(angle));
    Motion {
        line: lap + 1,
        kind: MotionKind::Feed,
        start_mm: [0.0; 3],
        end_mm: [0.0; 3],
        shape: Shape::Arc {
            plane,
            center_mm,
            turns: excitation.turns[lap_index % excitation.turns.len()],
        },
        feed_mm_s: rng.random_range(slow..=fast),
        corner: Corner::ExactStop,
        others: AuxiliaryAxes::default(),
    }
}

/// Uncorrected with random offsets; records.
struct ExcitationController<'a, const N: usize> {
    excitation: &'a Excitation,
    servo_periods: u32,
    reach_mm: f64,
    rng: &'a mut Rng,
    /// Offset at the start and at the end of a ramp.
    from_mm: [f64; N],
    to_mm: [f64; N],
    lap: Vec<RecordedKnot<N>>,
}

impl<const N: usize> Controller<N> for ExcitationController<'_, N> {
    fn schedule(&self) -> Schedule {
        Schedule {
            servo_periods: self.servo_periods,
            preview: 0,
        }
    }

    fn reset(&mut self) {
        self.lap.clear();
    }

    fn report(&self) -> SelfReport<N> {
        SelfReport {
            corrects: false,
            ..SelfReport::CORRECTS
        }
    }

    fn command(&mut self, window: &Window<'_, N>, measured: &Measured<N>) -> Command<N> {
        let since = self.lap.len() % self.excitation.renewal_periods as usize;
        if since == 0 {
            let reach = self.reach_mm;
            self.from_mm = self.to_mm;
            self.to_mm = std::array::from_fn(|_| self.rng.random_range(-reach..=reach));
        }
        self.lap.push(RecordedKnot {
            command_mm: add_scaled(window.now().position_mm, 1.0, window.offset_mm),
            tool_mm: measured.position_mm,
            contour_mm: measured.contour.vector_mm,
        });
        let (gone, ramp) = (since + 1, self.excitation.ramp_periods as usize);
        let part = gone as f64 / ramp as f64;
        let under_way = gone < ramp;
        Command::straight(
            1.0,
            if under_way {
                lerp(self.from_mm, self.to_mm, part)
            } else {
                self.to_mm
            },
        )
    }
}

/// A part of the way from one point to another.
fn lerp<const N: usize>(from_mm: [f64; N], to_mm: [f64; N], part: f64) -> [f64; N] {
    add_scaled(from_mm, part, sub(to_mm, from_mm))
}
