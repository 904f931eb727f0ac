//! Several logs of one machine as one: what each has is a stretch of its own, and times run on from
//! one to the next.

use std::path::PathBuf;

use super::error::LogError;
use super::finding::LogFinding;
use super::{Fitness, Log, LogAxis};

/// Sample times that differ by more than this part of them are not those of one machine.
const SAME_CLOCK: f64 = 1e-3;

impl Log {
    /// Logs that were recorded on one machine, in their order; the first says which axes there are.
    ///
    /// # Errors
    /// No log, and one with other axes or another time between samples than the first.
    pub fn joined(logs: Vec<(PathBuf, Self)>) -> Result<Self, LogError> {
        let mut logs = logs.into_iter();
        let Some((first_path, mut all)) = logs.next() else {
            return Err(LogError::apart(
                "no log was given".to_owned(),
                "name one or more",
            ));
        };
        for (path, mut log) in logs {
            if (log.sample_time_s / all.sample_time_s - 1.0).abs() > SAME_CLOCK {
                let message = format!(
                    "a sample is {} s here, and {} s in {}",
                    log.sample_time_s,
                    all.sample_time_s,
                    first_path.display()
                );
                let hint = "logs of one machine have one servo period: identify them one by one";
                return Err(LogError::apart(message, hint).in_file(&path));
            }
            all.take_up(&log);
            log.take_up(&all);
            let names = |log: &Self| {
                log.axes
                    .iter()
                    .map(|axis| axis.name.clone())
                    .collect::<Vec<_>>()
            };
            let [here, there] = [names(&log), names(&all)];
            if here.len() != there.len() || there.iter().any(|name| !here.contains(name)) {
                let message = format!(
                    "the axes are {} here, and {} in {}",
                    here.join(", "),
                    there.join(", "),
                    first_path.display()
                );
                let hint = "name the axes that all logs have with --columns, or identify them one by one with --update";
                return Err(LogError::apart(message, hint).in_file(&path));
            }
            all.append(path.display().to_string(), log);
        }
        Ok(all)
    }

    /// Axes that stand still here and move in the other log become axes of this one.
    fn take_up(&mut self, other: &Self) {
        let moves = |axis: &mut LogAxis| other.axes.iter().any(|other| other.name == axis.name);
        self.axes.extend(self.still.extract_if(.., moves));
    }

    /// Another one with the same axes.
    fn append(&mut self, path: String, log: Self) {
        let samples = self.time_s.len();
        let last_s = self.time_s.last().copied().unwrap_or(0.0);
        let from_s = last_s + self.sample_time_s;
        let begins_s = log.time_s.first().copied().unwrap_or(0.0);
        self.time_s
            .extend(log.time_s.iter().map(|time_s| time_s - begins_s + from_s));
        self.stretches.extend(
            log.stretches
                .iter()
                .map(|stretch| stretch.start + samples..stretch.end + samples),
        );
        for axis in &mut self.axes {
            if let Some(other) = log.axes.iter().find(|other| other.name == axis.name) {
                axis.append(other);
            }
        }
        // What stands still in all of them is of no one length.
        self.still.clear();
        self.findings.push(LogFinding::Joined { path, from_s });
        self.findings.extend(log.findings);
    }
}

impl LogAxis {
    fn append(&mut self, other: &Self) {
        self.command_mm.extend_from_slice(&other.command_mm);
        self.actual_mm.extend_from_slice(&other.actual_mm);
        // A torque that one log does not have is no column of all.
        let is_same = self.torque_unit == other.torque_unit;
        self.torque = match (self.torque.take(), &other.torque) {
            (Some(mut torque), Some(other)) if is_same => {
                torque.extend_from_slice(other);
                Some(torque)
            }
            _ => None,
        };
        self.step_mm = self.step_mm.max(other.step_mm);
        if let Fitness::NotForControl { .. } = other.verdict {
            self.verdict = other.verdict.clone();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::log::{LogFormat, TorqueUnit};

    fn log(axis: &str, sample_time_s: f64, torque: bool) -> (PathBuf, Log) {
        let axis = LogAxis {
            name: axis.to_owned(),
            command_mm: vec![0.0, 1.0, 2.0],
            actual_mm: vec![0.0, 0.5, 1.5],
            torque: torque.then(|| vec![1.0; 3]),
            torque_unit: TorqueUnit::Unknown,
            step_mm: 0.0,
            verdict: Fitness::ForControl,
        };
        let log = Log {
            format: LogFormat::TextTable,
            sample_time_s,
            stretches: vec![0..2, 2..3],
            time_s: vec![5.0, 5.0 + sample_time_s, 6.0],
            axes: vec![axis],
            still: vec![],
            findings: vec![],
        };
        ("a.csv".into(), log)
    }

    #[test]
    fn times_and_stretches_run_on() {
        let joined = Log::joined(vec![log("x", 0.001, true), log("x", 0.001, false)]).unwrap();
        assert_eq!(joined.stretches, [0..2, 2..3, 3..5, 5..6]);
        assert!(
            joined.time_s.windows(2).all(|pair| pair[1] > pair[0]),
            "{:?}",
            joined.time_s
        );
        assert_eq!(
            (joined.axes[0].command_mm.len(), &joined.axes[0].torque),
            (6, &None)
        );
        assert_eq!(
            joined.findings[0].to_string(),
            "a.csv is joined at 6.001 s of the time"
        );
    }

    #[test]
    fn an_axis_that_stands_still_in_one_log_is_an_axis_of_all() {
        let both = || {
            let (path, mut both) = log("x", 0.001, true);
            let (_, mut resting) = log("y", 0.001, true);
            resting.axes[0].command_mm = vec![7.0; 3];
            both.still = resting.axes;
            (path, both)
        };
        let (path, mut moving) = both();
        moving.axes.append(&mut moving.still);
        for logs in [
            vec![both(), (path.clone(), moving.clone())],
            vec![(path, moving), both()],
        ] {
            let joined = Log::joined(logs).unwrap();
            let lengths: Vec<_> = joined
                .axes
                .iter()
                .map(|axis| (axis.name.as_str(), axis.actual_mm.len()))
                .collect();
            assert_eq!(lengths, [("x", 6), ("y", 6)]);
        }
    }

    #[test]
    fn other_axes_and_other_clocks_are_no_logs_of_the_same_machine() {
        let refused = |other| {
            Log::joined(vec![log("x", 0.001, true), other])
                .unwrap_err()
                .to_string()
        };
        assert_eq!(
            refused(log("y", 0.001, true)),
            "a.csv: the axes are y here, and x in a.csv"
        );
        assert_eq!(
            refused(log("x", 0.002, true)),
            "a.csv: a sample is 0.002 s here, and 0.001 s in a.csv"
        );
    }
}
