//! A log of one cut of the part: checked, in the coordinates of the program, and with the program
//! that was cut.

use feedwright_ident::{Log, LogAxis};
use feedwright_plan::Step;
use feedwright_plan::vector::{Vector, add_scaled, distance, sub};
use feedwright_sim::{Commanded, Machine, Reference, Row, Stages, Watch};
use serde::Serialize;

use super::error::LearnError;
use crate::measured::{MeasuredLog, RecordedCut, recorded_cut};

/// A log needs this many samples in a time constant of the position loop; fewer do not show the
/// transients.
const LEAST_SAMPLES: f64 = 4.0;
/// Largest number of lost samples in a row that are filled in. A log with a longer gap is rejected.
const MOST_LOST: f64 = 3.0;
/// A command whose RMS distance from the original is smaller belongs to the original, mm. The
/// blends of a control are larger than its rounding errors.
const SAME_PROGRAM_MM: f64 = 2e-3;
/// A corrected program rests where the original does not, for more than this, s: its shortest dwell
/// is a quarter of 30 ms.
const DWELL_S: f64 = 5e-3;

/// Program that a log is a cut of.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub(crate) enum CutProgram {
    /// The program that is corrected.
    Original,
    /// A program that was corrected before.
    Corrected,
}

/// A log of a cut, ready to learn from.
pub(super) struct PartRecord {
    pub(super) name: String,
    pub(super) cut: RecordedCut,
    pub(super) program: CutProgram,
    /// RMS distance of its command from the program, mm.
    pub(super) off_mm: f64,
    /// RMS and largest contour error, mm.
    pub(super) rms_mm: f64,
    pub(super) max_mm: f64,
}

impl PartRecord {
    /// Reads a log of a cut of `original` on a machine.
    pub(super) fn of(
        MeasuredLog { name, log }: &MeasuredLog,
        machine: &Machine,
        stages: Stages,
        original: &[Step],
        axes: usize,
        watch: &dyn Watch,
    ) -> Result<Self, LearnError> {
        let most_s = 1.0 / machine.slowest_kp_1_s() / LEAST_SAMPLES;
        if log.sample_time_s > most_s {
            return Err(LearnError::TooFewSamples {
                sample_s: log.sample_time_s,
                most_s,
            });
        }
        let steps = || Box::new(original.iter().cloned().map(Ok));
        let mut reference = stages
            .reference(steps(), machine)
            .map_err(LearnError::Limits)?;
        let cut = recorded_cut(&filled(log), machine, axes, &mut reference, watch)?;
        let planned = PlannedCommand::of(&mut reference, log.sample_time_s);
        let off_mm = planned.off_mm(&cut.rows);
        let dwells = longest_rest(cut.rows.iter().map(|row| row.commanded == Commanded::Rest))
            > planned.rest + DWELL_S / log.sample_time_s;
        let program = if off_mm > SAME_PROGRAM_MM || dwells {
            CutProgram::Corrected
        } else {
            CutProgram::Original
        };
        let errors = || {
            cut.rows
                .iter()
                .filter(|row| row.cutting)
                .map(|row| row.contour_error_mm.abs())
        };
        let count = errors().count().max(1) as f64;
        let rms_mm = (errors().map(|error| error * error).sum::<f64>() / count).sqrt();
        let max_mm = errors().fold(0.0, f64::max);
        Ok(Self {
            name: name.clone(),
            program,
            off_mm,
            rms_mm,
            max_mm,
            cut,
        })
    }

    /// Duration of the cut, s.
    pub(super) fn time_s(&self) -> f64 {
        let moves = |row: &Row| row.commanded != Commanded::Rest;
        let rows = &self.cut.rows;
        let [first, last] =
            [rows.iter().position(moves), rows.iter().rposition(moves)].map(|row| row.unwrap_or(0));
        (last - first) as f64 * self.cut.sample_s
    }
}

/// Samples of the longest rest between motions.
fn longest_rest(rests: impl Iterator<Item = bool>) -> f64 {
    let (mut longest, mut now, mut moved) = (0_u32, 0, false);
    for rests in rests {
        if !rests {
            longest = longest.max(if moved { now } else { 0 });
        }
        (now, moved) = (if rests { now + 1 } else { 0 }, moved || !rests);
    }
    longest.into()
}

/// Planned command of the original.
struct PlannedCommand {
    /// Arc length and position, mm.
    places: Vec<(f64, Vector)>,
    /// Samples of its longest rest.
    rest: f64,
}

impl PlannedCommand {
    fn of(reference: &mut Reference<'_>, step_s: f64) -> Self {
        let steps = (reference.read_to_end_s() / step_s).ceil() as usize;
        let samples: Vec<_> = (0..=steps)
            .map(|n| reference.at(n as f64 * step_s))
            .collect();
        let places = samples
            .iter()
            .map(|sample| (sample.s_mm, sample.position_mm))
            .collect();
        Self {
            places,
            rest: longest_rest(samples.iter().map(|sample| sample.resting)),
        }
    }

    /// Computes the RMS distance between a cutting command and the plan, mm; both at the same arc
    /// length.
    fn off_mm(&self, rows: &[Row]) -> f64 {
        let (mut sum, mut count) = (0.0, 0.0);
        for row in rows.iter().filter(|row| row.commanded == Commanded::Cut) {
            // A control may round corners differently from the plan.
            sum += distance(self.at(row.s_mm), row.cmd_mm)
                .min(distance(row.path_mm, row.cmd_mm))
                .powi(2);
            count += 1.0;
        }
        (sum / f64::max(count, 1.0)).sqrt()
    }

    fn at(&self, s_mm: f64) -> Vector {
        let after = self
            .places
            .partition_point(|(s, _)| *s < s_mm)
            .min(self.places.len() - 1);
        let [(from_mm, before), (to_mm, after)] =
            [after.saturating_sub(1), after].map(|k| self.places[k]);
        let part = if to_mm > from_mm {
            ((s_mm - from_mm) / (to_mm - from_mm)).clamp(0.0, 1.0)
        } else {
            0.0
        };
        add_scaled(before, part, sub(after, before))
    }
}

/// Returns a log whose short gaps are filled in along straight lines.
fn filled(log: &Log) -> Log {
    let missing = |pair: &[std::ops::Range<usize>]| {
        let gap_s = log.time_s[pair[1].start] - log.time_s[pair[0].end - 1];
        (gap_s / log.sample_time_s).round() - 1.0
    };
    let gaps: Vec<f64> = log.stretches.windows(2).map(missing).collect();
    if gaps.is_empty()
        || gaps
            .iter()
            .any(|&missing| !(0.0..=MOST_LOST).contains(&missing))
    {
        return log.clone();
    }
    let fill = |values: &[f64]| {
        let mut all = Vec::with_capacity(values.len());
        for (n, stretch) in log.stretches.iter().enumerate() {
            all.extend_from_slice(&values[stretch.clone()]);
            let (Some(&missing), Some(&next)) = (gaps.get(n), values.get(stretch.end)) else {
                continue;
            };
            let last = values[stretch.end - 1];
            all.extend(
                (1..=missing as usize).map(|k| last + (next - last) * k as f64 / (missing + 1.0)),
            );
        }
        all
    };
    let axis = |axis: &LogAxis| LogAxis {
        command_mm: fill(&axis.command_mm),
        actual_mm: fill(&axis.actual_mm),
        torque: None,
        ..axis.clone()
    };
    let time_s = fill(&log.time_s);
    let [axes, still] = [&log.axes, &log.still].map(|axes| axes.iter().map(axis).collect());
    Log {
        stretches: std::iter::once(0..time_s.len()).collect(),
        time_s,
        axes,
        still,
        ..log.clone()
    }
}

#[cfg(test)]
mod tests {
    use feedwright_ident::Columns;

    use super::*;

    #[test]
    fn a_lost_sample_is_filled_in_and_a_long_gap_stays() {
        let text = |lost: std::ops::Range<usize>| {
            let row = |k: usize| {
                let t_s = k as f64 * 1e-3;
                let x_mm = 10.0 * libm::sin(9.0 * t_s);
                format!(
                    "{t_s},{x_mm:.6},{:.6}\n",
                    x_mm - 0.02 * libm::cos(9.0 * t_s)
                )
            };
            let rows: String = (0..2000).filter(|k| !lost.contains(k)).map(row).collect();
            format!("t,x.cmd,x.act\n{rows}")
        };
        let read = |lost| {
            let text = text(lost);
            Log::from_reader(
                "a.csv".as_ref(),
                text.as_bytes(),
                text.len() as u64,
                &Columns::default(),
                &(),
            )
            .unwrap()
        };
        let (whole, one) = (read(0..0), read(700..701));
        let again = filled(&one);
        assert_eq!(
            (
                one.stretches.len(),
                again.stretches.len(),
                again.time_s.len()
            ),
            (2, 1, 2000)
        );
        let off = |k: usize| (again.axes[0].command_mm[k] - whole.axes[0].command_mm[k]).abs();
        assert!(
            off(700) < 1e-3 && off(1500) == 0.0,
            "{} {}",
            off(700),
            off(1500)
        );
        assert_eq!(filled(&read(700..720)).stretches.len(), 2);
    }
}
