//! Canonical steps as JSON, one object a line.
//!
//! What serde makes of them, byte for byte; straight motions of X, Y, Z and an extruder, nearly all
//! of a long program, are put together here, because a number that stands where it stood before
//! (where the last motion ended, the same height, the same feedrate) is copied instead of being
//! printed anew, which is most of the work.

use std::io;

use feedwright_gcode::canon::{Canon, Corner, Motion, MotionKind, Shape};

use crate::results_format::spelled_out;

/// Bytes that no printed number exceeds.
const NUMBER_BYTES: usize = 32;

/// Writes lines, and keeps what the last ones have in common.
#[derive(Debug, Default)]
pub(super) struct Lines {
    pub(super) text: Vec<u8>,
    point_mm: [Printed; 3],
    feed_mm_s: Printed,
    corner: Option<(Corner, Vec<u8>)>,
}

/// A number and how it is printed.
#[derive(Debug, Default)]
struct Printed {
    value: Option<f64>,
    text: [u8; NUMBER_BYTES],
    length: usize,
}

impl Printed {
    #[inline]
    fn write(&mut self, value: f64, text: &mut Vec<u8>) {
        if self
            .value
            .is_none_or(|last| last.to_bits() != value.to_bits())
        {
            let mut buffer = zmij::Buffer::new();
            let printed = number(value, &mut buffer).as_bytes();
            self.length = printed.len();
            self.text[..printed.len()].copy_from_slice(printed);
            self.value = Some(value);
        }
        text.extend_from_slice(&self.text[..self.length]);
    }
}

/// JSON has no infinities.
#[inline]
fn number(value: f64, buffer: &mut zmij::Buffer) -> &str {
    if value.is_finite() {
        buffer.format_finite(value)
    } else {
        "null"
    }
}

impl Lines {
    /// Adds the lines of `steps`.
    pub(super) fn write(&mut self, steps: &[Canon]) -> io::Result<()> {
        for step in steps {
            match step {
                Canon::Motion(motion)
                    if matches!(motion.shape, Shape::Line) && motion.others.axes.is_none() =>
                {
                    self.straight(motion)?;
                }
                // A message of the program, perhaps.
                Canon::Event(_) => {
                    self.text
                        .extend_from_slice(spelled_out(&serde_json::to_string(step)?).as_bytes());
                }
                step => serde_json::to_writer(&mut self.text, step)?,
            }
            self.text.push(b'\n');
        }
        Ok(())
    }

    fn straight(&mut self, motion: &Motion) -> io::Result<()> {
        self.text.extend_from_slice(b"{\"motion\":{\"line\":");
        serde_json::to_writer(&mut self.text, &motion.line)?;
        self.text.extend_from_slice(match motion.kind {
            MotionKind::Rapid => b",\"kind\":\"rapid\",\"start_mm\":[",
            MotionKind::Feed => b",\"kind\":\"feed\",\"start_mm\":[".as_slice(),
        });
        self.point(motion.start_mm);
        self.text.extend_from_slice(b"],\"end_mm\":[");
        self.point(motion.end_mm);
        self.text
            .extend_from_slice(b"],\"shape\":\"line\",\"feed_mm_s\":");
        self.feed_mm_s.write(motion.feed_mm_s, &mut self.text);
        self.text.extend_from_slice(b",\"corner\":");
        self.corner(motion.corner)?;
        if !motion.others.is_none() {
            self.text
                .extend_from_slice(b",\"others\":{\"extruder_mm\":");
            let mut buffer = zmij::Buffer::new();
            self.text
                .extend_from_slice(number(motion.others.extruder_mm, &mut buffer).as_bytes());
            self.text.push(b'}');
        }
        self.text.extend_from_slice(b"}}");
        Ok(())
    }

    #[inline]
    fn point(&mut self, point_mm: [f64; 3]) {
        for axis in 0..3 {
            if axis > 0 {
                self.text.push(b',');
            }
            self.point_mm[axis].write(point_mm[axis], &mut self.text);
        }
    }

    fn corner(&mut self, corner: Corner) -> io::Result<()> {
        let known = self.corner.take().filter(|(last, _)| *last == corner);
        let (_, printed) = self.corner.insert(match known {
            Some(known) => known,
            None => (corner, serde_json::to_vec(&corner)?),
        });
        self.text.extend_from_slice(printed);
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use feedwright_gcode::canon::AuxiliaryAxes;
    use feedwright_gcode::{Dialect, Reader, Settings};

    use super::*;

    fn assert_as_serde(steps: &[Canon]) {
        let expected: String = steps
            .iter()
            .map(|step| serde_json::to_string(step).unwrap() + "\n")
            .collect();
        let mut lines = Lines::default();
        lines.write(steps).unwrap();
        assert_eq!(String::from_utf8(lines.text).unwrap(), expected);
    }

    #[test]
    fn lines_are_what_serde_makes_of_them() {
        let text = "G21 G90\nG0 X1 Y2.5 Z-3e\nG0 X1 Y2.5 Z-3\nG1 X0.1 F600\nX0.3 E2\nG61\nE1\nG61.1\nG0 Y-7\nG64 P0.02\nG1 X1e\n\
                    G1 X9 A3\nG2 X12 I2\nG4 P2\nM3 S100\nG1 X1000000 F0.1\nX0.0000001\nM117 a \"b\"\nG93\nG1 X5 F2\nM2\n";
        for dialect in [Dialect::Printer, Dialect::LinuxCnc] {
            let settings = Settings {
                dialect: Some(dialect),
                ..Settings::default()
            };
            let reader = Reader::from_text("test", text, settings).unwrap();
            let steps: Vec<Canon> = reader.filter_map(Result::ok).collect();
            assert!(steps.len() > 10, "{}", steps.len());
            assert_as_serde(&steps);
        }
    }

    #[test]
    fn every_number_is_printed_as_by_serde() {
        let values = [
            0.0,
            -0.0,
            1.0,
            1e15,
            1e16,
            1e17,
            -1.5e-5,
            1e-7,
            f64::MIN_POSITIVE,
            f64::MAX,
            -f64::MAX,
            0.1 + 0.2,
        ];
        let steps: Vec<Canon> = values
            .into_iter()
            .chain([f64::INFINITY, f64::NAN])
            .map(|value| {
                Canon::Motion(Motion {
                    line: u32::MAX,
                    kind: MotionKind::Feed,
                    start_mm: [value, 1.0, -value],
                    end_mm: [value, value, 0.5],
                    shape: Shape::Line,
                    feed_mm_s: value,
                    corner: Corner::ExactPath,
                    others: AuxiliaryAxes {
                        extruder_mm: value,
                        axes: None,
                    },
                })
            })
            .collect();
        assert_as_serde(&steps);
    }
}
