//! Backlash that a geometry states of an axis without a screw of its own: the table stays until the
//! joint has crossed the gap.
//!
//! ```text
//! y <- y bounded to q - b/2 ... q + b/2
//! ```
//!
//! with y of the table, q of the joint and b the backlash. Source: the play operator,
//! Krasnosel'skii and Pokrovskii (1989), "Systems with Hysteresis".

use feedwright_control::KnownGeometry;

use crate::machine::Machine;

/// Tables of N axes behind gaps.
#[derive(Debug, Clone)]
pub(super) struct TableGap<const N: usize> {
    half_mm: [f64; N],
    table_mm: [f64; N],
}

impl<const N: usize> TableGap<N> {
    /// The gaps of a machine, with the tables in their middle; none where no axis has one. The gap
    /// of a screw is part of the screw.
    pub(super) fn new(
        machine: &Machine,
        known: &KnownGeometry<N>,
        start_mm: [f64; N],
    ) -> Option<Self> {
        let backlash_mm = known.backlash_mm();
        let half_mm = std::array::from_fn(|i| {
            if machine.axis(i).hidden_screw().is_some() {
                0.0
            } else {
                0.5 * backlash_mm[i].abs()
            }
        });
        (half_mm != [0.0; N]).then_some(Self {
            half_mm,
            table_mm: start_mm,
        })
    }

    /// Moves the tables with the joints.
    pub(super) fn follow(&mut self, joint_mm: [f64; N]) {
        for (i, table_mm) in self.table_mm.iter_mut().enumerate() {
            *table_mm =
                table_mm.clamp(joint_mm[i] - self.half_mm[i], joint_mm[i] + self.half_mm[i]);
        }
    }

    /// Positions of the tables, mm.
    pub(super) const fn table_mm(&self) -> [f64; N] {
        self.table_mm
    }
}

#[cfg(test)]
mod tests {
    use feedwright_control::AxisErrors;

    use super::*;

    #[test]
    fn a_table_is_half_the_backlash_behind_its_joint_in_either_direction() {
        let machine = Machine::load("tnv40".as_ref()).unwrap();
        let errors = [0.02, 0.0].map(|backlash_mm| AxisErrors {
            backlash_mm,
            ..AxisErrors::default()
        });
        let known = KnownGeometry::new(errors, [0.0; 3]);
        let mut gap = TableGap::new(&machine, &known, [5.0, 5.0]).unwrap();
        let mut tables = [5.005, 5.5, 5.495, 5.48, 4.0].map(|joint_mm| {
            gap.follow([joint_mm; 2]);
            gap.table_mm()
        });
        tables
            .iter_mut()
            .flatten()
            .for_each(|mm| *mm = (*mm * 1e6).round() / 1e6);
        assert_eq!(
            tables,
            [
                [5.0, 5.005],
                [5.49, 5.5],
                [5.49, 5.495],
                [5.49, 5.48],
                [4.01, 4.0]
            ]
        );
        assert!(
            TableGap::new(
                &machine,
                &KnownGeometry::new([AxisErrors::default(); 2], [0.0; 3]),
                [0.0; 2]
            )
            .is_none()
        );
    }
}
