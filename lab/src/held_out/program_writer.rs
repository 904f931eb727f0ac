//! Writes a program line by line and tracks the tool position, the feedrate, and an estimate of the
//! time.
//!
//! Positions are absolute, and every line is complete except for modes.

use feedwright_plan::vector::distance;

use super::random::Random;

/// Acceleration by which the time of a short leg is estimated, mm/s2.
const ACCEL_MM_S2: f64 = 400.0;
/// Range of the programmed feedrates, mm/min.
const FEED_MM_MIN: [f64; 2] = [100.0, 12_000.0];
/// Average number of legs per change of feedrate, in programs with mixed feedrates.
const FEED_EVERY: u32 = 8;

/// A program that is being written.
pub(super) struct ProgramWriter {
    pub(super) random: Random,
    lines: Vec<String>,
    at_mm: [f64; 3],
    feed_mm_s: f64,
    mixed: bool,
    left_s: f64,
}

impl ProgramWriter {
    /// Begins a program: modes, how corners are taken, a place, a feedrate.
    pub(super) fn new(mut random: Random, comment: &str) -> Self {
        let mode = match random.whole(0, 5) {
            0 => "G61".to_owned(),
            1 => "G61.1".to_owned(),
            2 => format!("G64 P{}", random.by_ratio([0.001, 0.05])),
            _ => "G64".to_owned(),
        };
        let modes = "G21 G17 G90 G94 G40".to_owned();
        let lines = vec![format!("({comment})"), modes, mode];
        let mixed = random.one_in(3);
        let mut writer = Self {
            random,
            lines,
            at_mm: [0.0; 3],
            feed_mm_s: 0.0,
            mixed,
            left_s: 0.0,
        };
        writer.feed();
        writer
    }

    /// Sets the estimated time of the next part, s.
    pub(super) fn begin_part(&mut self, time_s: f64) {
        self.left_s = time_s;
    }

    /// Returns true if there is time for more in this part.
    pub(super) fn goes_on(&self) -> bool {
        self.left_s > 0.0
    }

    pub(super) fn at_mm(&self) -> [f64; 3] {
        self.at_mm
    }

    /// Another feedrate.
    pub(super) fn feed(&mut self) {
        let feed_mm_min = self.random.by_ratio(FEED_MM_MIN);
        self.feed_mm_s = feed_mm_min / 60.0;
        self.lines.push(format!("F{feed_mm_min}"));
    }

    /// A line as it stands.
    pub(super) fn say(&mut self, line: &str) {
        self.lines.push(line.to_owned());
    }

    pub(super) fn rapid(&mut self, to_mm: [f64; 3]) {
        self.travel("G0", to_mm, "");
    }

    /// A straight cut.
    pub(super) fn line(&mut self, to_mm: [f64; 3]) {
        self.maybe_feed();
        let leg_mm = distance(self.at_mm, to_mm);
        self.travel("G1", to_mm, "");
        self.spend(leg_mm);
    }

    /// A straight cut by so much in x and y.
    pub(super) fn by(&mut self, x_mm: f64, y_mm: f64) {
        let [x, y, z] = self.at_mm;
        self.line([x + x_mm, y + y_mm, z]);
    }

    /// A straight cut of a length in a direction.
    pub(super) fn leg(&mut self, leg_mm: f64, heading_rad: f64) {
        self.by(
            leg_mm * libm::cos(heading_rad),
            leg_mm * libm::sin(heading_rad),
        );
    }

    /// An arc in the XY plane about a centre that lies at `to_center_mm` from here;
    /// counter-clockwise where `sweep_rad` is positive; a whole turn where it is 2 pi. Rises by
    /// `rise_mm`.
    pub(super) fn arc(&mut self, to_center_mm: [f64; 2], sweep_rad: f64, rise_mm: f64) {
        self.maybe_feed();
        let [x, y, z] = self.at_mm;
        let [i, j] = to_center_mm.map(decimal);
        let (sin, cos) = (libm::sin(sweep_rad), libm::cos(sweep_rad));
        let turned = [-i * cos + j * sin, -i * sin - j * cos];
        let is_whole = (sweep_rad.abs() - std::f64::consts::TAU).abs() < 1e-9;
        let [end_x, end_y] = match is_whole {
            true => [x, y],
            false => [x + i + turned[0], y + j + turned[1]],
        };
        let code = if sweep_rad > 0.0 { "G3" } else { "G2" };
        self.travel(code, [end_x, end_y, z + rise_mm], &format!(" I{i} J{j}"));
        self.spend(libm::hypot(libm::hypot(i, j) * sweep_rad, rise_mm));
    }

    /// The program, ended.
    pub(super) fn finish(mut self) -> String {
        self.lines.push("M2".to_owned());
        self.lines.join("\n") + "\n"
    }

    fn travel(&mut self, code: &str, to_mm: [f64; 3], more: &str) {
        let to_mm = to_mm.map(decimal);
        let [x, y, z] = to_mm;
        // A program in the plane stays one of two axes.
        let height = match z == 0.0 && self.at_mm[2] == 0.0 {
            true => String::new(),
            false => format!(" Z{z}"),
        };
        self.lines.push(format!("{code} X{x} Y{y}{height}{more}"));
        self.at_mm = to_mm;
    }

    fn maybe_feed(&mut self) {
        if self.mixed && self.random.one_in(FEED_EVERY) {
            self.feed();
        }
    }

    /// Subtracts the estimated time of a leg from the time left in this part. The estimate is the
    /// longer of the time at the feedrate and sqrt(leg / [`ACCEL_MM_S2`]), which matters for short
    /// legs.
    fn spend(&mut self, leg_mm: f64) {
        /// However short: a servo period or two.
        const MIN_S: f64 = 0.002;
        let short_s = (leg_mm / ACCEL_MM_S2).sqrt();
        self.left_s -= (leg_mm / self.feed_mm_s).max(short_s).max(MIN_S);
    }
}

/// Rounds to the form in which programs write positions: four decimals, and no zero with a sign.
fn decimal(value: f64) -> f64 {
    (value * 1e4).round() / 1e4 + 0.0
}
