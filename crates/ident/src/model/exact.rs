//! Builds a model from a machine without identification: the axes have the values of the machine
//! file.

use feedwright_control::{IdentifiedAxes, KnownGeometry, ModelBlock, Part, TrainedModel};
use feedwright_sim::Machine;

/// The block of bytes, as of [`super::Model::block`], of the first `axes` axes of a machine, 2 or
/// 3, with exactly its numbers and this geometry. What a block has no place for, two masses, ripple
/// and backlash, is not in it.
pub fn exact_block(machine: &Machine, axes: usize, geometry: Option<&KnownGeometry<3>>) -> Vec<u8> {
    let mut bytes = Vec::new();
    let put = |more: &[u8]| bytes.extend_from_slice(more);
    if axes == 2 {
        exact::<2>(machine, geometry).to_bytes(put);
    } else {
        exact::<3>(machine, geometry).to_bytes(put);
    }
    bytes
}

/// The geometry of the first N axes as a block has it: without backlash, and none where there is no
/// error.
pub(crate) fn of_a_block<const N: usize>(
    geometry: Option<&KnownGeometry<3>>,
) -> Option<KnownGeometry<N>> {
    geometry
        .map(|known| known.of_first::<N>().with_backlash([0.0; N]))
        .filter(|known| !known.is_exact())
}

fn exact<const N: usize>(machine: &Machine, geometry: Option<&KnownGeometry<3>>) -> ModelBlock<N> {
    let (known, periods) = (machine.known(), machine.period.periods());
    let axis = |i: usize| {
        let all = machine.axis(i).parameters();
        known.axis(i).nominal.taking(&[Part::Noise], &all)
    };
    let axes = std::array::from_fn(axis);
    ModelBlock {
        model: TrainedModel::of_axes(IdentifiedAxes { periods, axes }),
        geometry: of_a_block(geometry),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_block_of_every_machine_reads_as_its_axes() {
        for (name, _) in feedwright_sim::BUILT_IN_MACHINES {
            let machine = Machine::load(name.as_ref()).unwrap();
            let geometry = machine.errors_of_geometry::<3>();
            for geometry in [None, geometry.as_ref()] {
                let read =
                    ModelBlock::<3>::from_bytes(&exact_block(&machine, 3, geometry)).unwrap();
                assert_eq!(read, exact::<3>(&machine, geometry), "{name}");
                assert_eq!(read.geometry.as_ref(), geometry, "{name}");
                ModelBlock::<2>::from_bytes(&exact_block(&machine, 2, geometry)).unwrap();
            }
        }
    }
}
