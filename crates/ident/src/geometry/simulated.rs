//! A ball bar on a simulated machine: cuts its program on the plant, and writes what the bar would
//! show.

use std::f64::consts::TAU;
use std::fmt::Write;

use feedwright_gcode::{Reader, Settings};
use feedwright_sim::{AXIS_NAMES, Machine, Plant, RunError, Sample, Stages, joints_of, path_steps};
use rand::{RngExt, SeedableRng};

use super::programs::BallBarProgram;
use crate::identify::Rng;

/// A ball bar in its place.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SimulatedBallBar {
    /// Its program, about a center at machine zero plus `center_mm`.
    pub program: BallBarProgram,
    /// Machine position of the center, mm.
    pub center_mm: [f64; 3],
    /// Standard deviation of a sample, um.
    pub noise_um: f64,
    /// Samples of a circle, about.
    pub samples: u32,
    /// True where its length is known.
    pub calibrated: bool,
    /// True where the radius by the encoders is recorded with it.
    pub has_encoders: bool,
    /// Seed of the noise of bar and machine.
    pub seed: u64,
}

impl SimulatedBallBar {
    /// The text that the bar writes on a machine without compensation.
    ///
    /// # Errors
    /// A machine without a plan.
    pub fn text(&self, machine: &Machine) -> Result<String, RunError> {
        self.text_of(machine, &self.program.text())
    }

    /// The same with a program in the place of its own, such as that one corrected.
    ///
    /// # Errors
    /// A program that cannot be read, or a machine without a plan.
    pub fn text_of(&self, machine: &Machine, program: &str) -> Result<String, RunError> {
        let [x, y, z] = self.center_mm;
        if self.program.plane == [0, 1] && z == 0.0 {
            return self.cut::<2>(machine, format!("G10 L2 P1 X{x} Y{y}\nG54\n") + program);
        }
        self.cut::<3>(
            machine,
            format!("G10 L2 P1 X{x} Y{y} Z{z}\nG54\n") + program,
        )
    }

    fn cut<const N: usize>(&self, machine: &Machine, program: String) -> Result<String, RunError> {
        let machine = machine.with_noise_seed(self.seed);
        // A stop of the program is a rest in which the bar is mounted. What cannot be read ends it.
        let program = program.replace("M0 (", "G4 P0.5 (");
        let canon = Reader::from_text("ballbar.ngc", program.as_str(), Settings::default())?
            .map_while(Result::ok);
        let mut reference = Stages::of(&machine).reference(path_steps(canon), &machine)?;
        let mut plant = Plant::<N>::new(&machine, joints_of(reference.at(0.0).position_mm));
        let mut record = BarRecord::new(self);
        for n in 0_u32.. {
            let t_s = f64::from(n) * machine.period.servo_s;
            let sample = reference.at(t_s);
            if reference.end_s().is_some_and(|end_s| t_s > end_s) {
                break;
            }
            reference.forget_before(t_s);
            let seen = plant.step(joints_of(sample.position_mm));
            record.take(
                &sample,
                self.polar(seen.position_mm),
                self.polar(seen.measured_mm),
            );
        }
        Ok(record.text)
    }

    /// Radius (mm) and angle (degrees) of a position about the center.
    fn polar<const N: usize>(&self, position_mm: [f64; N]) -> [f64; 2] {
        let [a, b] = self
            .program
            .plane
            .map(|axis| position_mm[axis] - self.center_mm[axis]);
        [libm::hypot(a, b), libm::atan2(b, a).to_degrees()]
    }
}

/// Record of a bar.
struct BarRecord<'b> {
    bar: &'b SimulatedBallBar,
    text: String,
    rng: Rng,
    /// Directions of the arcs that come.
    ways: std::array::IntoIter<f64, 2>,
    /// State on an arc: its direction, the last angle, this angle counted on over full turns, and
    /// the angle of the next sample.
    arc: Option<[f64; 4]>,
}

/// Largest distance of the command from the circle at which the bar is on it, mm: beyond the
/// rounding of its corners, and beyond what a corrected program departs from it.
const ON_CIRCLE_MM: f64 = 0.5;

impl<'b> BarRecord<'b> {
    fn new(bar: &'b SimulatedBallBar) -> Self {
        let BallBarProgram {
            radius_mm,
            feed_mm_min,
            plane: [a, b],
        } = bar.program;
        let calibrated = if bar.calibrated { "yes" } else { "no" };
        let encoder = if bar.has_encoders { ",encoder_um" } else { "" };
        let [x, y, z] = bar.center_mm;
        let text = format!(
            "# ball bar, simulated\n# plane: {}{}\n# radius_mm: {radius_mm}\n# center_mm: {x} {y} {z}\n# calibrated: {calibrated}\n\
             # feed_mm_min: {feed_mm_min}\nangle_deg,direction,deviation_um{encoder}\n",
            AXIS_NAMES[a], AXIS_NAMES[b]
        );
        Self {
            bar,
            text,
            rng: Rng::seed_from_u64(bar.seed),
            ways: [1.0, -1.0].into_iter(),
            arc: None,
        }
    }

    fn take(&mut self, sample: &Sample, [tool_mm, angle_deg]: [f64; 2], [encoder_mm, _]: [f64; 2]) {
        let SimulatedBallBar {
            program,
            noise_um,
            samples,
            has_encoders,
            ..
        } = *self.bar;
        let center_mm = self.bar.center_mm;
        let [a, b] = program
            .plane
            .map(|axis| sample.position_mm[axis] - center_mm[axis]);
        if (libm::hypot(a, b) - program.radius_mm).abs() > ON_CIRCLE_MM || sample.rapid {
            self.arc = None;
            return;
        }
        let ([first, last], over) = program.arc_deg();
        let begins = || {
            let way = self.ways.next().unwrap_or(-1.0);
            let [from, next] = if way > 0.0 {
                [first - over, first]
            } else {
                [last + over, last]
            };
            [way, angle_deg, from, next]
        };
        let [way, before_deg, turned_deg, mut next_deg] = self.arc.unwrap_or_else(begins);
        let moved_deg = angle_deg - before_deg;
        let turned_deg = turned_deg + moved_deg - 360.0 * (moved_deg / 360.0).round();
        if way * (turned_deg - next_deg) >= 0.0 && (first..=last).contains(&turned_deg) {
            next_deg += way * 360.0 / f64::from(samples.max(1));
            let deviation_um =
                1e3 * (tool_mm - program.radius_mm) + noise_um * normal(&mut self.rng);
            let shown_deg = turned_deg - 360.0 * (turned_deg / 360.0).floor();
            // Writing to a string cannot fail.
            let _ = write!(self.text, "{shown_deg:.4},{way},{deviation_um:.3}");
            if has_encoders {
                let _ = write!(self.text, ",{:.3}", 1e3 * (encoder_mm - program.radius_mm));
            }
            self.text.push('\n');
        }
        self.arc = Some([way, angle_deg, turned_deg, next_deg]);
    }
}

/// A normal number, by the method of Box and Muller (1958).
fn normal(rng: &mut Rng) -> f64 {
    let [u, v]: [f64; 2] = [rng.random(), rng.random()];
    (-2.0 * libm::log1p(-u)).sqrt() * libm::cos(TAU * v)
}
