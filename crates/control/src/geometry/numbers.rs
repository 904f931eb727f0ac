//! A geometry as a sequence of numbers, as in a model block.
//!
//! | Numbers | What |
//! |---|---|
//! | 4 N | of each axis: scale, amplitude of the pitch error (mm), its phase for a travel (rad/mm), its phase at position 0 (rad) |
//! | 3 | squareness of y to x, z to x and z to y, rad |
//! | N^2 tables | row by row, the errors of a coordinate over each joint: number of points, 0 without a table, then position and error (mm) of each |
//!
//! Backlash depends on the direction of travel and is not part of the map: it is not among the
//! numbers.

use super::{AxisErrors, ErrorTable, GeometryFault, KnownGeometry, TABLE_POINTS};

impl<const N: usize> KnownGeometry<N> {
    /// Passes its numbers to `each` in their order.
    pub fn numbers(&self, mut each: impl FnMut(f64)) {
        for axis in &self.axes {
            let AxisErrors {
                scale,
                pitch_mm,
                pitch_rad_per_mm,
                pitch_phase_rad,
                ..
            } = *axis;
            [scale, pitch_mm, pitch_rad_per_mm, pitch_phase_rad]
                .into_iter()
                .for_each(&mut each);
        }
        self.squareness_rad.into_iter().for_each(&mut each);
        for table in self.tables.iter().flatten() {
            each(table.as_ref().map_or(0.0, |table| table.len as f64));
            for (at_mm, error_mm) in table.iter().flat_map(ErrorTable::points) {
                each(at_mm);
                each(error_mm);
            }
        }
    }

    /// Reads a geometry from the numbers that `next` returns, one after another. The inner result
    /// states whether it can be compensated.
    ///
    /// # Errors
    /// Returns the first error of `next`.
    pub(crate) fn from_numbers<E>(
        mut next: impl FnMut() -> Result<f64, E>,
    ) -> Result<Result<Self, GeometryFault>, E> {
        let mut found = Self::new([AxisErrors::default(); N], [0.0; 3]);
        for axis in &mut found.axes {
            let [scale, pitch_mm, pitch_rad_per_mm, pitch_phase_rad] =
                [next()?, next()?, next()?, next()?];
            *axis = AxisErrors {
                scale,
                pitch_mm,
                pitch_rad_per_mm,
                pitch_phase_rad,
                backlash_mm: 0.0,
            };
        }
        found.squareness_rad = [next()?, next()?, next()?];
        for table in found.tables.as_flattened_mut() {
            let count = next()?;
            // The cast saturates to zero where the float is negative or NaN.
            let points = count as usize;
            if points as f64 != count || points > TABLE_POINTS {
                return Ok(Err(GeometryFault::Points(points)));
            }
            if points == 0 {
                continue;
            }
            let mut rows = [[0.0; 2]; TABLE_POINTS];
            for row in rows.iter_mut().take(points) {
                *row = [next()?, next()?];
            }
            match ErrorTable::new(rows.into_iter().take(points)) {
                Ok(read) => *table = Some(read),
                Err(fault) => return Ok(Err(fault)),
            }
        }
        Ok(found.check().map(|()| found))
    }
}

impl ErrorTable {
    /// Position and error of each point, mm.
    fn points(&self) -> impl Iterator<Item = (f64, f64)> {
        self.at_mm.iter().copied().zip(self.error_mm).take(self.len)
    }
}

#[cfg(test)]
mod tests {
    extern crate std;

    use std::vec::Vec;

    use super::*;

    fn numbers(geometry: &KnownGeometry<2>) -> Vec<f64> {
        let mut numbers = Vec::new();
        geometry.numbers(|number| numbers.push(number));
        numbers
    }

    fn read(numbers: &[f64]) -> Result<Result<KnownGeometry<2>, GeometryFault>, ()> {
        let mut numbers = numbers.iter().copied();
        KnownGeometry::from_numbers(|| numbers.next().ok_or(()))
    }

    fn geometry() -> KnownGeometry<2> {
        let axis = AxisErrors {
            scale: 1e-5,
            pitch_mm: 0.002,
            pitch_rad_per_mm: 0.6,
            pitch_phase_rad: 1.0,
            backlash_mm: 0.0,
        };
        let table = ErrorTable::new([[-10.0, 0.001], [0.0, 0.0], [30.0, -0.002]]).unwrap();
        KnownGeometry::new([axis, AxisErrors::default()], [2e-5, 0.0, 0.0]).with_table(0, 1, table)
    }

    #[test]
    fn a_geometry_comes_back_to_the_bit_without_its_backlash() {
        assert_eq!(numbers(&geometry()).len(), 2 * 4 + 3 + 4 + 6);
        assert_eq!(read(&numbers(&geometry())), Ok(Ok(geometry())));
        assert_eq!(
            read(&numbers(&geometry().with_backlash([0.01; 2]))),
            Ok(Ok(geometry()))
        );
    }

    #[test]
    fn what_is_cut_off_or_cannot_be_compensated_is_refused() {
        let good = numbers(&geometry());
        for length in 0..good.len() {
            assert_eq!(read(&good[..length]), Err(()), "{length}");
        }
        let with = |at: usize, number: f64| {
            let mut numbers = good.clone();
            numbers[at] = number;
            read(&numbers)
        };
        assert!(matches!(
            with(0, 0.06),
            Ok(Err(GeometryFault::Slope { axis: 0, .. }))
        ));
        assert_eq!(with(3, f64::NAN), Ok(Err(GeometryFault::NotFinite)));
        // The counts of the tables are behind the eight numbers of the axes and the three angles.
        for count in [0.5, -1.0, 257.0, f64::INFINITY, f64::NAN] {
            assert!(
                matches!(with(12, count), Ok(Err(GeometryFault::Points(_)))),
                "{count}"
            );
        }
        assert_eq!(with(12, 1.0), Ok(Err(GeometryFault::Points(1))));
        assert_eq!(with(15, -20.0), Ok(Err(GeometryFault::Order(1))));
    }
}
