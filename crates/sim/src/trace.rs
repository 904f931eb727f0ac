//! Columns of a trace: rows of a run as CSV, the whole trace or the corrected setpoints alone.
//!
//! A column is a name in [`TraceWriter::new`] and a number in its [`Sink::row`], in the same order;
//! its value is a field of [`Row`] (`row.rs`), which `simulate.rs` fills.
//!
//! Numbers are printed in the shortest form that reads back as the same f64, so that a trace can be
//! re-simulated from its text to the last bit. A row is put together in one buffer and written in
//! one call.

use std::io::{self, Write};

use crate::machine::AXIS_NAMES;
use crate::row::{Row, Sink};

/// `--trace`: one line per servo period, all columns of a [`Row`].
pub struct TraceWriter<W> {
    out: W,
    axes: usize,
    text: Text,
}

/// `--out FILE.csv`: one line per servo period, time and corrected position.
pub struct SetpointWriter<W> {
    out: W,
    axes: usize,
    text: Text,
}

impl<W: Write> TraceWriter<W> {
    /// Writes the header line; `axes` is 2 or 3.
    ///
    /// # Errors
    /// Where `out` takes no more.
    pub fn new(mut out: W, axes: usize) -> io::Result<Self> {
        let names = &AXIS_NAMES[..axes];
        let mut columns = ["t_s", "s_mm", "line", "feed_plan_mm_s"]
            .map(str::to_owned)
            .to_vec();
        columns.extend(names.iter().flat_map(|axis| {
            [
                format!("path_{axis}_mm"),
                format!("cmd_{axis}_mm"),
                format!("act_{axis}_mm"),
                format!("torque_{axis}_nm"),
            ]
        }));
        columns.push("contour_error_mm".to_owned());
        columns.extend(names.iter().map(|axis| format!("corrected_{axis}_mm")));
        columns.push("cutting".to_owned());
        writeln!(out, "{}", columns.join(","))?;
        Ok(Self {
            out,
            axes,
            text: Text::default(),
        })
    }

    /// Flushes, and gives back what was written to.
    ///
    /// # Errors
    /// Where it takes no more.
    pub fn finish(mut self) -> io::Result<W> {
        self.out.flush()?;
        Ok(self.out)
    }
}

impl<W: Write> Sink for TraceWriter<W> {
    fn row(&mut self, row: &Row) -> io::Result<()> {
        let text = &mut self.text;
        text.number(row.t_s);
        text.number(row.s_mm);
        text.whole(row.line);
        text.number(row.feed_plan_mm_s);
        for axis in 0..self.axes {
            text.number(row.path_mm[axis]);
            text.number(row.cmd_mm[axis]);
            text.number(row.act_mm[axis]);
            text.number(row.torque_nm[axis]);
        }
        text.number(row.contour_error_mm);
        for axis in 0..self.axes {
            text.number(row.corrected_mm[axis]);
        }
        text.whole(u32::from(row.cutting));
        text.end_line(&mut self.out)
    }
}

impl<W: Write> SetpointWriter<W> {
    /// Writes the header line; `axes` is 2 or 3.
    ///
    /// # Errors
    /// Where `out` takes no more.
    pub fn new(mut out: W, axes: usize) -> io::Result<Self> {
        let columns: Vec<String> = AXIS_NAMES[..axes]
            .iter()
            .map(|axis| format!(",{axis}_mm"))
            .collect();
        writeln!(out, "t_s{}", columns.concat())?;
        Ok(Self {
            out,
            axes,
            text: Text::default(),
        })
    }

    /// Flushes, and gives back what was written to.
    ///
    /// # Errors
    /// Where it takes no more.
    pub fn finish(mut self) -> io::Result<W> {
        self.out.flush()?;
        Ok(self.out)
    }
}

impl<W: Write> Sink for SetpointWriter<W> {
    fn row(&mut self, row: &Row) -> io::Result<()> {
        self.text.number(row.t_s);
        for axis in 0..self.axes {
            self.text.number(row.cmd_mm[axis]);
        }
        self.text.end_line(&mut self.out)
    }
}

/// A line under construction.
#[derive(Default)]
struct Text {
    bytes: Vec<u8>,
}

impl Text {
    fn number(&mut self, value: f64) {
        let mut buffer = zmij::Buffer::new();
        let digits = buffer.format(value);
        // A whole number reads back the same without its ".0", and traces are full of zeros.
        self.field(digits.strip_suffix(".0").unwrap_or(digits));
    }

    fn whole(&mut self, value: u32) {
        self.field(&value.to_string());
    }

    fn field(&mut self, digits: &str) {
        self.bytes.extend_from_slice(digits.as_bytes());
        self.bytes.push(b',');
    }

    fn end_line(&mut self, out: &mut impl Write) -> io::Result<()> {
        self.bytes.pop();
        self.bytes.push(b'\n');
        let result = out.write_all(&self.bytes);
        self.bytes.clear();
        result
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::row::Commanded;
    use proptest::prelude::*;

    fn row(values: [f64; 8], line: u32, cutting: bool) -> Row {
        let triple = |offset: usize| [values[offset], values[offset + 1], values[offset + 2]];
        Row {
            t_s: values[0],
            s_mm: values[1],
            line,
            feed_plan_mm_s: values[2],
            programmed_mm_s: 0.0,
            cutting,
            commanded: Commanded::Cut,
            path_mm: triple(0),
            cmd_mm: triple(5),
            corrected_mm: triple(1),
            act_mm: triple(2),
            torque_nm: triple(3),
            foot_mm: triple(1),
            tangent: triple(4),
            contour_error_mm: values[7],
        }
    }

    fn written(axes: usize, row: &Row) -> String {
        let mut writer = TraceWriter::new(Vec::new(), axes).unwrap();
        writer.row(row).unwrap();
        String::from_utf8(writer.finish().unwrap()).unwrap()
    }

    #[test]
    fn columns_are_the_documented_ones() {
        let header = |axes| {
            written(axes, &row([0.0; 8], 1, true))
                .lines()
                .next()
                .unwrap()
                .to_owned()
        };
        assert_eq!(
            header(2),
            "t_s,s_mm,line,feed_plan_mm_s,path_x_mm,cmd_x_mm,act_x_mm,torque_x_nm,path_y_mm,cmd_y_mm,act_y_mm,torque_y_nm,\
             contour_error_mm,corrected_x_mm,corrected_y_mm,cutting"
        );
        assert!(
            header(3)
                .contains("act_z_mm,torque_z_nm,contour_error_mm,corrected_x_mm,corrected_y_mm,corrected_z_mm,cutting")
        );
    }

    #[test]
    fn setpoints_hold_time_and_corrected_position() {
        let mut writer = SetpointWriter::new(Vec::new(), 3).unwrap();
        writer
            .row(&row([0.001, 2.0, 3.0, 4.0, 5.0, 0.1, -7.5, 1e-9], 1, true))
            .unwrap();
        assert_eq!(
            String::from_utf8(writer.finish().unwrap()).unwrap(),
            "t_s,x_mm,y_mm,z_mm\n0.001,0.1,-7.5,1e-9\n"
        );
    }

    proptest! {
        #[test]
        fn every_number_reads_back_bit_for_bit(values: [f64; 8], line: u32, cutting: bool, axes in 2..=3_usize) {
            let row = row(values, line, cutting);
            let text = written(axes, &row);
            let fields: Vec<&str> = text.lines().nth(1).unwrap().split(',').collect();
            let mut expected = vec![row.t_s, row.s_mm, f64::from(line), row.feed_plan_mm_s];
            for axis in 0..axes {
                expected.extend([row.path_mm[axis], row.cmd_mm[axis], row.act_mm[axis], row.torque_nm[axis]]);
            }
            expected.push(row.contour_error_mm);
            expected.extend(&row.corrected_mm[..axes]);
            expected.push(f64::from(u8::from(cutting)));
            prop_assert_eq!(fields.len(), expected.len());
            for (field, value) in fields.iter().zip(expected) {
                let back: f64 = field.parse().unwrap();
                // NaN has many bit patterns and one name.
                prop_assert!(back.to_bits() == value.to_bits() || back.is_nan() && value.is_nan(), "{} became {}", value, field);
            }
        }
    }
}
