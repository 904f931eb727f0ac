//! The identification programme, cut: laps of circles under a controller that disturbs the command and records.

use feedwright_control::controller::{Command, Controller, Measured, Schedule};
use feedwright_control::identifier::{ERROR_SCALE_MM, History};
use feedwright_control::vector::{add_scaled, scale, sub};
use feedwright_control::window::Window;
use rand::RngExt;

use super::{Programme, Rng, Sample};
use crate::gcode::canon::{Canon, Corner, Motion, MotionKind, Others, Plane, Shape};
use crate::machine::Machine;
use crate::reference::Reference;
use crate::simulate::simulate;

/// Every third lap runs undisturbed: the network sees the plain circle as well.
const UNDISTURBED_EVERY: u32 = 3;

/// Cuts all laps and collects the samples.
pub(super) fn record<const N: usize>(machine: &Machine, programme: &Programme, rng: &mut Rng) -> Vec<Sample<N>> {
    let mut samples = Vec::new();
    for lap in 0..programme.laps {
        let motion = circle::<N>(programme, lap, rng);
        let mut reference = Reference::new(std::iter::once(Canon::Motion(motion)), &(&machine.limits).into())
            .expect("the limits of a machine file are checked when it is read");
        let mut excitation = Excitation {
            offset_mm: if lap % UNDISTURBED_EVERY == 0 { 0.0 } else { programme.offset_mm },
            renewal_periods: programme.renewal_periods,
            servo_periods: programme.servo_periods,
            rng,
            periods: 0,
            offset: [0.0; N],
            history: History::default(),
            last_knot_mm: None,
            samples: &mut samples,
        };
        // A lap that diverges simply ends.
        simulate(machine, &mut reference, &mut excitation, &mut []).expect("without sinks nothing is written");
    }
    samples
}

/// One lap: radii and planes in turn, feed, direction and starting point at random.
fn circle<const N: usize>(programme: &Programme, lap: u32, rng: &mut Rng) -> Motion {
    let radius = programme.radii_mm[lap as usize % programme.radii_mm.len()];
    let plane = match (N, lap % 3) {
        (3, 1) => Plane::Zx,
        (3, 2) => Plane::Yz,
        _ => Plane::Xy,
    };
    let [first, second, _] = plane.axes();
    let [slow, fast] = programme.feed_mm_s;
    let angle: f64 = rng.random_range(0.0..std::f64::consts::TAU);
    let mut center_mm = [0.0; 3];
    (center_mm[first], center_mm[second]) = (radius * angle.cos(), radius * angle.sin());
    Motion {
        line: lap + 1,
        kind: MotionKind::Feed,
        start_mm: [0.0; 3],
        end_mm: [0.0; 3],
        shape: Shape::Arc { plane, center_mm, turns: programme.turns[lap as usize % programme.turns.len()] },
        feed_mm_s: rng.random_range(slow..=fast),
        corner: Corner::ExactStop,
        others: Others::default(),
    }
}

/// Open loop with random offsets; records what the identifier would have seen.
struct Excitation<'a, const N: usize> {
    offset_mm: f64,
    renewal_periods: u32,
    servo_periods: u32,
    rng: &'a mut Rng,
    periods: u32,
    offset: [f64; N],
    history: History<N>,
    last_knot_mm: Option<[f64; N]>,
    samples: &'a mut Vec<Sample<N>>,
}

impl<const N: usize> Controller<N> for Excitation<'_, N> {
    fn schedule(&self) -> Schedule {
        Schedule { servo_periods: self.servo_periods, preview: 0 }
    }

    fn reset(&mut self) {
        self.periods = 0;
        self.history = History::default();
        self.last_knot_mm = None;
    }

    fn observe(&mut self, _: &Measured<N>) {}

    fn command(&mut self, window: &Window<'_, N>, measured: &Measured<N>) -> Command<N> {
        let knot_mm = add_scaled(window.now().position_mm, 1.0, window.offset_mm);
        if let Some(last_mm) = self.last_knot_mm.replace(knot_mm) {
            let feed_mm_s = scale(1.0 / window.feed_period_s, sub(knot_mm, last_mm));
            let error_mm = measured.contour.vector_mm;
            self.samples.push(Sample {
                inputs: self.history.inputs(feed_mm_s),
                error: error_mm.map(|e| e / ERROR_SCALE_MM),
            });
            self.history.push(feed_mm_s, error_mm);
        }
        if self.periods.is_multiple_of(self.renewal_periods) {
            let reach = self.offset_mm;
            self.offset = std::array::from_fn(|_| self.rng.random_range(-reach..=reach));
        }
        self.periods += 1;
        Command { rate: 1.0, offset_mm: self.offset }
    }
}
