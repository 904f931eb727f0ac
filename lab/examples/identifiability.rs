//! What the paper's identifier learns, and what the machine does: the numbers of
//! examples/01_paper_circle.
//!
//! Prints the effect of the feedrate on the contour error as the simulated machine has it, then as
//! networks have learnt it from several training programmes, and what the two-dimensional
//! controller makes of each on the circle of eq. 11.

use feedwright::Statistics;
use feedwright_control::vector::{add_scaled, dot, scale, sub};
use feedwright_control::{
    Command, ContourIdentifier, Controller, Delays, ERROR_SCALE_MM, FEED_SCALE_MM_S, Gradient,
    INPUTS, Inputs, InvertingSettings, Measured, Schedule, TwoDimensional, Window, seen_feed,
};
use feedwright_gcode::canon::{Corner, Plane, Shape};
use feedwright_ident::{Excitation, TrainContour, Training};
use feedwright_lab::motion;
use feedwright_sim::{Machine, Run, Sink, path_steps};

/// Radius and feed of eq. 11.
const RADIUS_MM: f64 = 10.0;
/// See [`RADIUS_MM`].
const FEED_MM_S: f64 = 50.0;
/// Feed periods of 10 ms on the circle at full feed: away from both ramps of 0.5 s.
const FULL_FEED: std::ops::Range<usize> = 60..110;
/// Offset given to the machine to see what comes of it, mm: as large as those of the training.
const KICK_MM: f64 = 0.03;
/// Feed periods after the kick that are shown.
const SHOWN: usize = 5;
/// Step of the difference quotients, scaled units.
const STEP: f64 = 1e-5;

/// Uncorrected, but for one step of the offset across the path; keeps what an identifier would have
/// seen.
#[derive(Default)]
struct Observer {
    kick_at: Option<usize>,
    offset_mm: [f64; 2],
    delays: Delays<2>,
    last_mm: Option<[f64; 2]>,
    inputs: Vec<Inputs<2>>,
    /// Component of the contour error on the left normal, mm.
    error_mm: Vec<f64>,
}

impl Controller<2> for Observer {
    fn schedule(&self) -> Schedule {
        Schedule {
            servo_periods: 10,
            preview: 0,
        }
    }

    fn reset(&mut self) {}

    fn command(&mut self, window: &Window<'_, 2>, measured: &Measured<2>) -> Command<2> {
        let [tx, ty] = window.now().tangent;
        let normal = [-ty, tx];
        let knot_mm = add_scaled(window.now().position_mm, 1.0, window.offset_mm);
        let error_mm = measured.contour.vector_mm;
        if self.kick_at == Some(self.error_mm.len()) {
            self.offset_mm = scale(KICK_MM, normal);
        }
        let last_mm = self.last_mm.replace(knot_mm).unwrap_or(knot_mm);
        let feed_mm_s = scale(1.0 / window.feed_period_s, sub(knot_mm, last_mm));
        let feed = seen_feed(feed_mm_s);
        self.inputs.push(self.delays.inputs(feed));
        self.delays.push(feed, error_mm.map(|e| e / ERROR_SCALE_MM));
        self.error_mm.push(dot(error_mm, normal));
        Command::straight(1.0, self.offset_mm)
    }
}

/// Cuts the circle, clockwise.
fn cut(machine: &Machine, controller: &mut dyn Controller<2>, sinks: &mut [&mut dyn Sink]) {
    let shape = Shape::Arc {
        plane: Plane::Xy,
        center_mm: [RADIUS_MM, 0.0, 0.0],
        turns: -1,
    };
    let circle = motion(1, [[0.0; 3]; 2], shape, FEED_MM_S, Corner::ExactStop);
    Run::on(machine)
        .cut(|| Ok(path_steps([circle.clone()])), controller, sinks)
        .expect("a circle on a machine that was checked, sinks in memory");
}

/// d eps / d F of the machine, across the path, at the end of the feed period of F and of those
/// after it; scaled.
fn effect_on_the_machine(machine: &Machine, plain: &Observer) -> [f64; SHOWN] {
    let at = FULL_FEED.start;
    let mut kicked = Observer {
        kick_at: Some(at),
        ..Observer::default()
    };
    cut(machine, &mut kicked, &mut []);
    let feed = KICK_MM / (10.0 * machine.period.servo_s) / FEED_SCALE_MM_S;
    std::array::from_fn(|i| {
        let change_mm = kicked.error_mm[at + 1 + i] - plain.error_mm[at + 1 + i];
        change_mm / ERROR_SCALE_MM / feed
    })
}

/// d eps_a / d input of the same axis as a network has learnt it, mean over both axes and the
/// circle at full feed.
fn effect_as_learnt(net: &ContourIdentifier<2>, plain: &Observer) -> [f64; INPUTS] {
    let samples = &plain.inputs[FULL_FEED];
    std::array::from_fn(|input| {
        let mut sum = 0.0;
        for sample in samples {
            for axis in 0..2 {
                let (mut up, mut down) = (*sample, *sample);
                up[axis][input] += STEP;
                down[axis][input] -= STEP;
                let [up, down] = [up, down].map(|inputs| net.predict(&inputs).error[axis]);
                sum += (up - down) / (2.0 * STEP);
            }
        }
        sum / (2 * samples.len()) as f64
    })
}

fn errors(machine: &Machine, net: &ContourIdentifier<2>, gradient: Gradient) -> String {
    let mut settings = InvertingSettings::DEFAULT;
    settings.inversion.gradient = gradient;
    let mut statistics = Statistics::new();
    let mut controller = TwoDimensional::untried(net.clone(), settings);
    cut(machine, &mut controller, &mut [&mut statistics]);
    format!("{:.1} / {:.1}", statistics.rms_um(), statistics.max_um())
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let machine = Machine::load("tnv40".as_ref())?;
    let mut plain = Observer::default();
    cut(&machine, &mut plain, &mut []);
    let effect = effect_on_the_machine(&machine, &plain);
    println!("machine, d eps / d F after 1 to {SHOWN} feed periods: {effect:.2?}\n");
    let paper = Excitation::paper();
    let (mut both, mut without) = (paper.clone(), paper.clone());
    both.turns = vec![-1, 1];
    without.offset_mm = 0.0;
    let programmes = [
        ("one sense, with offsets", paper),
        ("both senses, with offsets", both),
        ("one sense, no offsets", without),
    ];
    println!("| training | seed | fit | F(k) | F(k-1) | F(k-2) | sum | `printed` | `exact` |");
    println!("|---|--:|--:|--:|--:|--:|--:|--:|--:|");
    for (name, excitation) in programmes {
        for seed in 1..=3 {
            let (recording, rng) = excitation.record::<2>(&machine, seed);
            let trained = Training::default().train(&recording, rng, &mut |_| {});
            let [now, one, two, ..] = effect_as_learnt(&trained.net, &plain);
            let [printed, exact] = [Gradient::Printed, Gradient::Exact]
                .map(|gradient| errors(&machine, &trained.net, gradient));
            let (fit_um, sum) = (trained.fit_um, now + one + two);
            println!(
                "| {name} | {seed} | {fit_um:.1} | {now:.2} | {one:.2} | {two:.2} | {sum:.2} | {printed} | {exact} |"
            );
        }
    }
    Ok(())
}
