//! Blocks of models: arbitrary bytes with a matching checksum, and axes and weights with numbers at
//! the ends of their ranges.

use std::f64::consts::TAU;

use feedwright_control::{
    AxisErrors, ContourIdentifier, ErrorTable, FEED_PERIODS_S, IdentifiedAxes, Identifier,
    KnownGeometry, MAX_WEIGHT, ModelBlock, Parameters, Periods, RESPONSES_S, Trained, TrainedModel,
};

use crate::draw::Draw;

/// Servo period of a usual machine, s.
pub(crate) const SERVO_S: f64 = 0.001;
/// Servo and mechanics periods of blocks, s.
const PERIODS_S: &[[f64; 2]] = &[
    [1e-3, 1e-4],
    [1e-3, 1e-3],
    [2e-3, 1e-4],
    [1e-3, 1e-5],
    [1e-5, 1e-5],
    [0.1, 0.1],
    [0.1, 1e-4],
    [1e-3, 1e-7],
];

/// Length of the checksum at the end of a block, bytes.
pub(crate) const CHECKSUM_BYTES: usize = 4;

/// Returns axes with the numbers of the machine of Lee, Cho and Jeon (2005), with delays and an
/// integral part of the speed loop.
pub(crate) fn known_axes<const N: usize>() -> IdentifiedAxes<N> {
    let parameters = Parameters {
        rad_per_mm: TAU / 10.0,
        kp_1_s: 50.0,
        kd: 0.0,
        kv_nm_s_per_rad: 2.0,
        torque_limit_nm: 30.0,
        inertia_kg_m2: 0.0103,
        viscous_friction_nm_s: 0.0336,
        coulomb_friction_nm: 0.2,
        coulomb_smoothing_rad_s: 0.05,
        speed_integral_s: 0.02,
        drive_delay_s: 0.001,
        measurement_delay_s: 0.0005,
        ..Parameters::NOTHING
    };
    let periods = Periods {
        servo_s: SERVO_S,
        mechanics_s: 0.0001,
        mechanics_per_servo: 10,
    };
    IdentifiedAxes {
        periods,
        axes: [parameters; N],
    }
}

/// Returns a block of usual axes in which some numbers have any value within their ranges.
pub(crate) fn absurd<const N: usize>(draw: &mut Draw) -> Vec<u8> {
    let mut axes = known_axes::<N>();
    let [servo_s, mechanics_s] = draw.pick(PERIODS_S);
    axes.periods.mechanics_s = mechanics_s;
    for axis in &mut axes.axes {
        for _ in 0..draw.below(12) {
            let number = draw.pick(Parameters::NUMBERS);
            let [least, most] = number.range;
            *(number.of)(axis) = match draw.below(6) {
                0 => least,
                1 => most,
                2 if least > 0.0 => (least * most).sqrt(),
                3 if number.or_none => 0.0,
                _ => least + draw.part() * (most - least),
            };
        }
    }
    let model = TrainedModel {
        servo_s,
        feed_period_s: 0.005,
        trained: Trained::Axes(axes),
    };
    let geometry = None;
    written(&ModelBlock { model, geometry })
}

/// Returns a block of an identifier of the contour error, with any weights within their range.
pub(crate) fn contour<const N: usize>(draw: &mut Draw) -> Vec<u8> {
    let mut identifier = ContourIdentifier::<N>::NULL;
    let reach = draw.pick(&[1.0, 1e-3, 100.0, MAX_WEIGHT]);
    identifier.weights(&mut |_, group| {
        for weight in group {
            *weight = match draw.below(8) {
                0 => MAX_WEIGHT,
                1 => -MAX_WEIGHT,
                _ => reach * (2.0 * draw.part() - 1.0),
            };
        }
    });
    let [least_s, most_s] = FEED_PERIODS_S;
    let feed_period_s = draw.pick(&[0.005, 0.001, least_s, most_s]);
    let model = TrainedModel {
        servo_s: draw.pick(PERIODS_S)[0],
        feed_period_s,
        trained: Trained::Contour {
            net: identifier,
            response_s: draw.pick(&[0.0, RESPONSES_S[0], 0.006, RESPONSES_S[1]]),
        },
    };
    let geometry = None;
    written(&ModelBlock { model, geometry })
}

fn written<const N: usize>(block: &ModelBlock<N>) -> Vec<u8> {
    let mut bytes = Vec::new();
    block.to_bytes(|part| bytes.extend_from_slice(part));
    bytes
}

/// Returns a block of the remaining bytes, with the header of a kind and a matching checksum.
pub(crate) fn with_checksum(draw: &mut Draw) -> Vec<u8> {
    let [format, kind, axes] = [
        draw.pick(&[2_u32, 3, 4, 5]),
        draw.pick(&[1, 2, 3]),
        draw.pick(&[2, 3]),
    ];
    let mut content = b"FWMODEL\0".to_vec();
    let numbers = (draw.rest().len() / 8) as u32;
    for whole in [format, kind, axes, numbers.saturating_sub(2)] {
        content.extend_from_slice(&whole.to_le_bytes());
    }
    content.extend_from_slice(&draw.rest()[..8 * numbers as usize]);
    sealed(content)
}

/// Returns an accepted block: axes with a geometry, or an identifier of the contour error.
pub(crate) fn valid<const N: usize>(is_contour: bool) -> Vec<u8> {
    let model = TrainedModel {
        servo_s: SERVO_S,
        feed_period_s: 0.005,
        trained: Trained::Axes(known_axes::<N>()),
    };
    let geometry = None;
    let mut block = ModelBlock { model, geometry };
    if is_contour {
        let mut identifier = ContourIdentifier::<N>::NULL;
        identifier.weights(&mut |_, group| {
            group
                .iter_mut()
                .zip(0..)
                .for_each(|(weight, k)| *weight = 0.1 * (f64::from(k % 7) - 3.0));
        });
        block.model.trained = Trained::Contour {
            net: identifier,
            response_s: 0.006,
        };
    } else {
        let (scale, pitch_mm, pitch_rad_per_mm) = (1e-5, 0.002, 0.6);
        let axis = AxisErrors {
            scale,
            pitch_mm,
            pitch_rad_per_mm,
            pitch_phase_rad: 1.0,
            backlash_mm: 0.0,
        };
        let geometry = KnownGeometry::new([axis; N], [2e-5, -1e-5, 1e-5]);
        let table = ErrorTable::new([[-10.0, 0.001], [0.0, 0.0], [30.0, -0.002]]);
        block.geometry = table.ok().map(|table| geometry.with_table(0, 1, table));
    }
    written(&block)
}

/// Returns a [`valid`] block in which one byte is changed, or that ends early, with a matching
/// checksum.
pub(crate) fn damaged<const N: usize>(draw: &mut Draw) -> Vec<u8> {
    let mut content = valid::<N>(draw.below(2) == 1);
    content.truncate(content.len() - CHECKSUM_BYTES);
    let at = usize::from(u16::from_le_bytes([draw.byte(), draw.byte()])) % content.len();
    match draw.byte() {
        0 => content.truncate(at),
        change => content[at] ^= change,
    }
    sealed(content)
}

/// Returns a block: the content, followed by its checksum.
fn sealed(mut content: Vec<u8>) -> Vec<u8> {
    let checksum = crc_32(&content);
    content.extend_from_slice(&checksum.to_le_bytes());
    content
}

/// Computes the CRC-32 of IEEE 802.3, bit by bit.
fn crc_32(bytes: &[u8]) -> u32 {
    !bytes.iter().fold(u32::MAX, |crc, byte| {
        (0..8).fold(crc ^ u32::from(*byte), |crc, _| {
            (crc >> 1) ^ (0xEDB8_8320 & (crc & 1).wrapping_neg())
        })
    })
}

/// Reads a block. An accepted block must be written as bytes that read as the same.
pub(crate) fn read<const N: usize>(bytes: &[u8]) {
    let Ok(block) = ModelBlock::<N>::from_bytes(bytes) else {
        return;
    };
    assert_eq!(
        ModelBlock::from_bytes(&written(&block)).as_ref(),
        Ok(&block)
    );
}
