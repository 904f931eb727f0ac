//! The simulated machine.

use feedwright_control::{IdentifiedAxes, KnownGeometry};
use feedwright_servo::machine::axes_of;
use feedwright_servo::plant::SimulatedMachine;

use crate::memory::{TwoOrThree, first, model, put, three};

/// The simulated machine.
pub struct CPlant(TwoOrThree<SimulatedMachine<2>, SimulatedMachine<3>>);

/// Returns the size of a machine, bytes.
#[unsafe(no_mangle)]
pub extern "C" fn feedwright_plant_bytes() -> usize {
    size_of::<CPlant>()
}

/// Creates a machine of two or three joints. Returns true if it was created.
///
/// # Safety
/// `memory` is null or points to `memory_bytes` bytes that nothing else uses. `bytes` is null or
/// points to `length` bytes.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn feedwright_plant_new(
    memory: *mut CPlant,
    memory_bytes: usize,
    joints: u32,
    bytes: *const u8,
    length: usize,
    seed: u64,
) -> bool {
    // SAFETY: as the caller promises.
    let bytes = unsafe { model(bytes, length) };
    if joints == 2 {
        let Ok(machine) = axes_of(bytes) else {
            return false;
        };
        // SAFETY: as the caller promises.
        unsafe {
            put(memory, memory_bytes, || {
                CPlant(TwoOrThree::Two(made(machine, seed)))
            })
        }
    } else {
        let Ok(machine) = axes_of(bytes) else {
            return false;
        };
        // SAFETY: as the caller promises.
        unsafe {
            put(memory, memory_bytes, || {
                CPlant(TwoOrThree::Three(made(machine, seed)))
            })
        }
    }
}

fn made<const N: usize>(
    (axes, geometry): (IdentifiedAxes<N>, Option<KnownGeometry<N>>),
    seed: u64,
) -> SimulatedMachine<N> {
    SimulatedMachine::new(&axes, seed).with_geometry(geometry)
}

/// Simulates one servo period under a command. Writes tool position, measured position and torque
/// at its end.
///
/// # Safety
/// `plant` was made by [`feedwright_plant_new`]. The other arguments are valid as declared.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn feedwright_plant_step(
    plant: &mut CPlant,
    command_mm: &[f64; 3],
    powered: bool,
    inertia: f64,
    tool_mm: &mut [f64; 3],
    measured_mm: &mut [f64; 3],
    torque_nm: &mut [f64; 3],
) {
    [*tool_mm, *measured_mm, *torque_nm] = match &mut plant.0 {
        TwoOrThree::Two(plant) => step(plant, *command_mm, powered, inertia),
        TwoOrThree::Three(plant) => step(plant, *command_mm, powered, inertia),
    };
}

fn step<const N: usize>(
    plant: &mut SimulatedMachine<N>,
    command_mm: [f64; 3],
    powered: bool,
    inertia: f64,
) -> [[f64; 3]; 3] {
    plant.step(first(command_mm), powered, inertia);
    [plant.tool_mm(), plant.measured_mm(), plant.torque_nm()].map(three)
}
