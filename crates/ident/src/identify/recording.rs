//! A recording: what a machine showed while it moved, knot by knot. All that an identification gets
//! to see of a machine.
//!
//! It comes from a simulated machine ([`super::Excitation::record`]) or from the log of a real one.
//! It is made of stretches: laps of a programme, or the parts of a log between gaps; nothing is
//! carried over from one to the next.

use serde::{Deserialize, Serialize};

/// Command and measurement at the start of a feed period.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RecordedKnot<const N: usize> {
    /// Command, mm.
    pub command_mm: [f64; N],
    /// Tool, mm.
    pub tool_mm: [f64; N],
    /// Contour error, desired minus actual, mm.
    pub(crate) contour_mm: [f64; N],
}

/// Commands and measurements of a machine.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(into = "StoredRecording", try_from = "StoredRecording")]
pub struct Recording<const N: usize> {
    /// Servo period of the machine, s.
    pub servo_s: f64,
    /// Time between knots, s.
    pub feed_period_s: f64,
    /// Knots that follow each other, stretch by stretch.
    pub stretches: Vec<Vec<RecordedKnot<N>>>,
}

impl<const N: usize> Recording<N> {
    /// Command and measured position of an axis, mm, stretch by stretch: each position with the
    /// command that the position loop has then, sent `late` knots before. The first positions,
    /// whose commands are not recorded, are left out.
    pub(super) fn of_axis(&self, axis: usize, late: usize) -> Vec<Vec<[f64; 2]>> {
        let rows = |knots: &Vec<RecordedKnot<N>>| {
            let then = knots.iter().skip(late).map(|knot| knot.tool_mm[axis]);
            knots
                .iter()
                .zip(then)
                .map(|(sent, tool_mm)| [sent.command_mm[axis], tool_mm])
                .collect()
        };
        self.stretches.iter().map(rows).collect()
    }

    /// A hash of its content: equal recordings give equal identifiers.
    pub fn hash(&self) -> String {
        let mut hasher = blake3::Hasher::new();
        let mut number = |number: f64| {
            hasher.update(&number.to_le_bytes());
        };
        [N as f64, self.servo_s, self.feed_period_s]
            .into_iter()
            .for_each(&mut number);
        for stretch in &self.stretches {
            number(stretch.len() as f64);
            for RecordedKnot {
                command_mm,
                tool_mm,
                contour_mm,
            } in stretch
            {
                command_mm
                    .iter()
                    .chain(tool_mm)
                    .chain(contour_mm)
                    .copied()
                    .for_each(&mut number);
            }
        }
        hasher.finalize().to_hex().to_string()
    }
}

/// Serialized form of [`Recording`]: a knot is a row of 3N numbers, in the order of
/// `RecordedKnot`.
#[derive(Clone, Serialize, Deserialize)]
struct StoredRecording {
    axes: usize,
    servo_s: f64,
    feed_period_s: f64,
    stretches: Vec<Vec<Vec<f64>>>,
}

impl<const N: usize> From<Recording<N>> for StoredRecording {
    fn from(recording: Recording<N>) -> Self {
        let Recording {
            servo_s,
            feed_period_s,
            stretches,
        } = recording;
        let row =
            |knot: &RecordedKnot<N>| [knot.command_mm, knot.tool_mm, knot.contour_mm].concat();
        let stretches = stretches
            .iter()
            .map(|stretch| stretch.iter().map(row).collect())
            .collect();
        Self {
            axes: N,
            servo_s,
            feed_period_s,
            stretches,
        }
    }
}

impl<const N: usize> TryFrom<StoredRecording> for Recording<N> {
    type Error = String;

    fn try_from(stored: StoredRecording) -> Result<Self, String> {
        let StoredRecording {
            axes,
            servo_s,
            feed_period_s,
            stretches,
        } = stored;
        if axes != N {
            return Err(format!("a recording of {axes} axes, not of {N}"));
        }
        let knot = |row: Vec<f64>| match row.as_chunks::<N>() {
            (&[command_mm, tool_mm, contour_mm], []) => Ok(RecordedKnot {
                command_mm,
                tool_mm,
                contour_mm,
            }),
            _ => Err(format!("a knot of {} numbers, not of {}", row.len(), 3 * N)),
        };
        let stretch =
            |rows: Vec<Vec<f64>>| rows.into_iter().map(knot).collect::<Result<Vec<_>, _>>();
        Ok(Self {
            servo_s,
            feed_period_s,
            stretches: stretches
                .into_iter()
                .map(stretch)
                .collect::<Result<_, _>>()?,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn recording() -> Recording<2> {
        let knot = |x: f64| RecordedKnot {
            command_mm: [x, 0.1 * x],
            tool_mm: [x - 1.0, -0.0],
            contour_mm: [1e-3, x / 3.0],
        };
        Recording {
            servo_s: 1e-3,
            feed_period_s: 3e-3,
            stretches: vec![vec![knot(1.0), knot(2.0)], vec![], vec![knot(3.0)]],
        }
    }

    #[test]
    fn it_comes_back_from_json_to_the_bit_and_not_with_another_number_of_axes() {
        let text = serde_json::to_string(&recording()).unwrap();
        let back: Recording<2> = serde_json::from_str(&text).unwrap();
        assert_eq!((&back, back.hash()), (&recording(), recording().hash()));
        let error = serde_json::from_str::<Recording<3>>(&text).unwrap_err();
        assert!(
            error
                .to_string()
                .starts_with("a recording of 2 axes, not of 3"),
            "{error}"
        );
        let error = serde_json::from_str::<Recording<2>>(&text.replacen("[1.0,", "[1.0,1.0,", 1))
            .unwrap_err();
        assert!(
            error
                .to_string()
                .starts_with("a knot of 7 numbers, not of 6"),
            "{error}"
        );
    }

    #[test]
    fn every_number_and_every_gap_counts_in_its_hash() {
        let mut hashes = vec![recording().hash()];
        let mut add = |change: &dyn Fn(&mut Recording<2>)| {
            let mut other = recording();
            change(&mut other);
            hashes.push(other.hash());
        };
        add(&|r| r.servo_s = 2e-3);
        add(&|r| r.feed_period_s = 4e-3);
        add(&|r| r.stretches[2][0].tool_mm[1] = 0.0);
        add(&|r| r.stretches[0][1].contour_mm[0] += 1e-12);
        add(&|r| {
            let knot = r.stretches[0].pop().unwrap();
            r.stretches[1].push(knot);
        });
        let distinct: std::collections::HashSet<_> = hashes.iter().collect();
        assert_eq!(distinct.len(), hashes.len());
    }
}
