//! A trained model as a block of bytes. A component in a servo thread validates the block before it
//! uses the model.
//!
//! | Offset | Bytes | Content |
//! |---|---|---|
//! | 0 | 8 | `FWMODEL` and a zero byte |
//! | 8 | 4 | format: 2, or 3 with a number that format 2 lacks, 4 with a geometry, 5 with a response time and, where there is one, a geometry |
//! | 12 | 4 | kind of the identifier: 1 contour, 3 axes; 2 was the servo identifier, and is rejected |
//! | 16 | 4 | N, number of axes |
//! | 20 | 4 | n, number of numbers that follow the periods, those of a geometry included |
//! | 24 | 8 | servo period, s |
//! | 32 | 8 | feed period, s: time between knots |
//! | 40 | 8 n | numbers of the model, in the order below |
//! | 40 + 8 n | 4 | CRC-32 of all bytes before it: IEEE 802.3, reflected, polynomial 0x04C11DB7 |
//!
//! The numbers of a contour identifier are its weights, group by group in the order of
//! [`Identifier::weights`], and from format 5 on the response time of the speed loops, s. The
//! numbers of axes are the mechanics period, s, and then [`Parameters::NUMBERS`], axis by axis.
//! [`Number::format`] is the first format that has a number; in an earlier block the number is
//! missing and zero. After the model, a block of format 4 has the geometry that the control
//! compensates: of each axis its scale, the amplitude of its pitch error (mm), its phase for a
//! travel (rad/mm) and at position 0 (rad); the three angles of squareness, rad; and row by row the
//! tables of the errors of a coordinate over a joint, each as the number of its points, 0 without a
//! table, and position and error (mm) of each point. A block has the lowest format that holds its
//! content.
//!
//! Integers are unsigned; all other numbers are IEEE 754 double precision. Everything is
//! little-endian. [`ModelBlock::from_bytes`] needs no memory beyond its result and never panics,
//! whatever the bytes are. It rejects every block that deviates from this layout.

use core::{fmt, slice};

use crate::axis::numbers::{Number, Parameters};
use crate::axis::{AxisModel, Periods};
use crate::geometry::KnownGeometry;
use crate::identifier::contour::ContourIdentifier;
use crate::identifier::{FEED_PERIODS_S, Identifier, IdentifierKind};

/// First bytes of a block.
pub(crate) const MAGIC: [u8; 8] = *b"FWMODEL\0";
/// Latest format that is read and written. It increases whenever the layout or the meaning of a
/// number changes.
pub const BLOCK_FORMAT: u32 = 5;
/// Earliest format that is read. Models without later numbers are still written in it.
const EARLIEST_FORMAT: u32 = 2;
/// First format whose blocks can have a geometry. A block of this format has one.
const GEOMETRY_FORMAT: u32 = 4;
/// First format whose blocks can have a response time.
const RESPONSE_FORMAT: u32 = 5;
/// Largest magnitude of a number of a geometry: positions are in mm.
const MAX_GEOMETRY: f64 = 1e6;
/// Range of the servo period of a machine, s: the bounds of a machine file.
pub const SERVO_PERIODS_S: [f64; 2] = [1e-5, 0.1];
/// Range of the period of the speed loop, s.
pub const MECHANICS_PERIODS_S: [f64; 2] = [1e-7, 0.1];
/// Largest number of mechanics periods in a servo period. The time to construct a controller grows
/// with it. Usual machines have 1 to 20.
pub const MAX_MECHANICS_PER_SERVO: f64 = 1_000.0;
/// Relative distance from a whole number below which the servo period counts as a whole multiple:
/// rounding of decimal numbers.
const WHOLE_RATIO_TOLERANCE: f64 = 1e-9;
/// Largest magnitude of a weight. A hidden node that changes sign within 0.25 mm/s has weights
/// of 400.
pub const MAX_WEIGHT: f64 = 1e6;
/// Range of a response time of the speed loops, s: a drive responds within a servo period at best,
/// and its delays are 20 ms each at most.
pub const RESPONSES_S: [f64; 2] = [1e-6, 1.0];

/// A trained identifier and the periods that it was trained for.
#[derive(Debug, Clone, PartialEq)]
pub struct TrainedModel<const N: usize> {
    /// Servo period of the machine, s.
    pub servo_s: f64,
    /// Time between knots, s.
    pub feed_period_s: f64,
    /// The trained identifier.
    pub trained: Trained<N>,
}

impl<const N: usize> TrainedModel<N> {
    /// Creates the model of these axes, whose controller decides in every servo period.
    pub fn of_axes(identified: IdentifiedAxes<N>) -> Self {
        let servo_s = identified.periods.servo_s;
        Self {
            servo_s,
            feed_period_s: servo_s,
            trained: Trained::Axes(identified),
        }
    }
}

/// A trained model, with the geometry of the machine.
#[derive(Debug, Clone, PartialEq)]
pub struct ModelBlock<const N: usize> {
    /// The model.
    pub model: TrainedModel<N>,
    /// The geometry that the control compensates, without backlash; `None` where nothing is
    /// compensated.
    pub geometry: Option<KnownGeometry<N>>,
}

/// Identified axes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct IdentifiedAxes<const N: usize> {
    /// Periods of the loops.
    pub periods: Periods,
    /// Identified numbers of each axis, with the settings of its drive.
    pub axes: [Parameters; N],
}

impl<const N: usize> IdentifiedAxes<N> {
    /// Model whose numbers are all zero.
    pub const NULL: Self = Self {
        periods: Periods {
            servo_s: 0.0,
            mechanics_s: 0.0,
            mechanics_per_servo: 0,
        },
        axes: [Parameters::NOTHING; N],
    };

    /// Passes its numbers to `each` in the order of the block, each with its bounds.
    fn numbers(&mut self, each: &mut impl FnMut(&NumberBounds, &mut [f64])) {
        let [least, most] = MECHANICS_PERIODS_S;
        each(
            &NumberBounds::Within(least, most),
            slice::from_mut(&mut self.periods.mechanics_s),
        );
        for axis in &mut self.axes {
            for number in Parameters::NUMBERS {
                each(
                    &NumberBounds::Of(number),
                    slice::from_mut((number.of)(axis)),
                );
            }
        }
    }

    /// Returns the axes at a servo period. Returns `None` where it is no whole multiple of the
    /// mechanics period, or contains more than [`MAX_MECHANICS_PER_SERVO`] of them.
    #[must_use]
    pub fn at_servo_period(mut self, servo_s: f64) -> Option<Self> {
        let ratio = servo_s / self.periods.mechanics_s;
        let whole = libm::round(ratio);
        // A NaN ratio fails this comparison.
        let is_whole = libm::fabs(ratio - whole) <= WHOLE_RATIO_TOLERANCE * ratio;
        if !(is_whole && (1.0..=MAX_MECHANICS_PER_SERVO).contains(&whole)) {
            return None;
        }
        (self.periods.servo_s, self.periods.mechanics_per_servo) = (servo_s, whole as u32);
        Some(self)
    }

    /// Returns the models of the axes.
    pub fn axis_models(&self) -> [AxisModel; N] {
        self.axes
            .map(|parameters| AxisModel::new(parameters, self.periods))
    }

    /// Returns true if all of its numbers are within their ranges at this servo period.
    pub fn are_possible(&self, servo_s: f64) -> bool {
        let [least, most] = MECHANICS_PERIODS_S;
        let mechanics_s = self.periods.mechanics_s;
        mechanics_s >= least
            && mechanics_s <= most
            && self.at_servo_period(servo_s).is_some()
            && self.axes.iter().all(|axis| axis.is_possible())
    }
}

/// A trained identifier.
#[derive(Debug, Clone, PartialEq)]
pub enum Trained<const N: usize> {
    /// An identifier of the contour error.
    Contour {
        /// The network.
        net: ContourIdentifier<N>,
        /// Response time of the slowest speed loop, s; 0 where the model does not state it.
        response_s: f64,
    },
    /// The axes.
    Axes(IdentifiedAxes<N>),
}

/// Reason why a block is not a model.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum BlockError {
    /// The block does not begin with the bytes of a model.
    NoModel,
    /// The block has this format, which is not read.
    Format(u32),
    /// The block has an identifier of this unknown kind.
    Kind(u32),
    /// The block is for this number of axes; the caller expects another.
    Axes(u32),
    /// The length of the block does not match its kind and its axes.
    Length,
    /// The checksum does not match the bytes before it.
    Checksum,
    /// The number with this index is NaN or out of bounds; index 0 is the servo period. Index 2
    /// also stands for a mechanics period that does not divide the servo period into 1 to
    /// [`MAX_MECHANICS_PER_SERVO`] whole parts.
    Number(usize),
    /// The geometry cannot be compensated: see [`KnownGeometry::check`].
    Geometry,
}

impl fmt::Display for BlockError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NoModel => f.write_str("these bytes are no model"),
            Self::Format(format) => {
                write!(f, "the model is of format {format}, and formats {EARLIEST_FORMAT} to {BLOCK_FORMAT} are read")
            }
            Self::Kind(SERVO) => f.write_str(
                "the model is a servo identifier, a kind that is no longer used; identify the machine again with 'feedwright identify'",
            ),
            Self::Kind(kind) => write!(f, "no identifier is of kind {kind}"),
            Self::Axes(axes) => write!(f, "the model is for {axes} axes"),
            Self::Length => f.write_str("the model is cut off, or has something behind it"),
            Self::Checksum => f.write_str("the model is damaged: its checksum does not fit"),
            Self::Number(index) => write!(f, "number {index} of the model is out of its bounds"),
            Self::Geometry => f.write_str("the geometry of the model cannot be compensated"),
        }
    }
}

impl core::error::Error for BlockError {}

impl<const N: usize> ModelBlock<N> {
    /// Reads a block.
    ///
    /// # Errors
    /// Returns the first fault of the block.
    pub fn from_bytes(bytes: &[u8]) -> Result<Self, BlockError> {
        let mut rest = Bytes {
            rest: bytes,
            number: 0,
        };
        if rest.take::<8>() != Some(MAGIC) {
            return Err(BlockError::NoModel);
        }
        let mut whole = || {
            rest.take()
                .map(u32::from_le_bytes)
                .ok_or(BlockError::Length)
        };
        let (format, kind, axes, numbers) = (whole()?, whole()?, whole()?, whole()?);
        if !(EARLIEST_FORMAT..=BLOCK_FORMAT).contains(&format) {
            return Err(BlockError::Format(format));
        }
        let mut trained = match kind {
            CONTOUR => Trained::Contour {
                net: ContourIdentifier::NULL,
                response_s: 0.0,
            },
            AXES => Trained::Axes(IdentifiedAxes::NULL),
            kind => return Err(BlockError::Kind(kind)),
        };
        if axes as usize != N {
            return Err(BlockError::Axes(axes));
        }
        let mut expected = 0_usize;
        trained.numbers_of(format, &mut |_, group| expected += group.len());
        let (content, checksum) = bytes.split_last_chunk().ok_or(BlockError::Length)?;
        let numbers = numbers as usize;
        let has_geometry = numbers > expected;
        let is_whole = match format {
            ..GEOMETRY_FORMAT => numbers == expected,
            GEOMETRY_FORMAT => has_geometry,
            _ => numbers >= expected,
        };
        // The two periods are not part of the count.
        if !is_whole
            || numbers.checked_add(2).and_then(|all| all.checked_mul(8))
                != rest.rest.len().checked_sub(4)
        {
            return Err(BlockError::Length);
        }
        if crc_32(content) != u32::from_le_bytes(*checksum) {
            return Err(BlockError::Checksum);
        }
        let servo_s = rest.number(&NumberBounds::within(SERVO_PERIODS_S))?;
        let feed_period_s = rest.number(&NumberBounds::within(FEED_PERIODS_S))?;
        let mut fault = None;
        trained.numbers_of(format, &mut |bounds, group| {
            for value in group {
                match rest.number(bounds) {
                    Ok(number) => *value = number,
                    Err(error) => fault = fault.or(Some(error)),
                }
            }
        });
        fault.map_or(Ok(()), Err)?;
        if let Trained::Axes(axes) = &mut trained {
            // The mechanics period is the first number after the two other periods.
            *axes = axes.at_servo_period(servo_s).ok_or(BlockError::Number(2))?;
        }
        let geometry = if has_geometry {
            Some(rest.geometry()?)
        } else {
            None
        };
        let model = TrainedModel {
            servo_s,
            feed_period_s,
            trained,
        };
        Ok(Self { model, geometry })
    }

    /// Writes this model as a block through `put`, piece by piece.
    pub fn to_bytes(&self, mut put: impl FnMut(&[u8])) {
        let TrainedModel {
            servo_s,
            feed_period_s,
            mut trained,
        } = self.model.clone();
        let mut format = EARLIEST_FORMAT;
        trained.numbers(&mut |bounds, group| {
            if group.iter().any(|number| *number != 0.0) {
                format = format.max(bounds.format());
            }
        });
        let mut numbers = 0_u32;
        if let Some(geometry) = &self.geometry {
            format = format.max(GEOMETRY_FORMAT);
            geometry.numbers(|_| numbers += 1);
        }
        trained.numbers_of(format, &mut |_, group| numbers += group.len() as u32);
        let kind = match trained.kind() {
            IdentifierKind::Contour => CONTOUR,
            IdentifierKind::Axes => AXES,
        };
        let mut crc = CRC_START;
        let mut put_counted = |bytes: &[u8]| {
            crc = crc_on(crc, bytes);
            put(bytes);
        };
        put_counted(&MAGIC);
        for whole in [format, kind, N as u32, numbers] {
            put_counted(&whole.to_le_bytes());
        }
        for period_s in [servo_s, feed_period_s] {
            put_counted(&period_s.to_le_bytes());
        }
        let put_group = &mut |_: &NumberBounds, group: &mut [f64]| {
            group
                .iter()
                .for_each(|number| put_counted(&number.to_le_bytes()));
        };
        trained.numbers_of(format, put_group);
        if let Some(geometry) = &self.geometry {
            geometry.numbers(|number| put_counted(&number.to_le_bytes()));
        }
        put(&(!crc).to_le_bytes());
    }
}

/// Kind of the contour identifier in a block.
const CONTOUR: u32 = 1;
/// Kind of the servo identifier of earlier versions. A block of this kind is rejected.
const SERVO: u32 = 2;
const AXES: u32 = 3;

impl<const N: usize> Trained<N> {
    /// Returns the kind of the identifier.
    pub fn kind(&self) -> IdentifierKind {
        match self {
            Self::Contour { .. } => IdentifierKind::Contour,
            Self::Axes(_) => IdentifierKind::Axes,
        }
    }

    /// Passes all numbers to `each` in the order of the block, group by group, with their bounds.
    fn numbers(&mut self, each: &mut impl FnMut(&NumberBounds, &mut [f64])) {
        let weight = NumberBounds::Within(-MAX_WEIGHT, MAX_WEIGHT);
        match self {
            Self::Contour { net, response_s } => {
                net.weights(&mut |_, group| each(&weight, group));
                each(&NumberBounds::Response, slice::from_mut(response_s));
            }
            Self::Axes(axes) => axes.numbers(each),
        }
    }

    /// Passes the numbers that a block of this format has to `each`.
    fn numbers_of(&mut self, format: u32, each: &mut impl FnMut(&NumberBounds, &mut [f64])) {
        self.numbers(&mut |bounds, group| {
            if bounds.format() <= format {
                each(bounds, group);
            }
        });
    }
}

/// Bounds of a number.
enum NumberBounds {
    /// Smallest and largest value.
    Within(f64, f64),
    /// Range of a number of an axis.
    Of(&'static Number),
    /// A response time, or 0.
    Response,
}

impl NumberBounds {
    fn within([least, most]: [f64; 2]) -> Self {
        Self::Within(least, most)
    }

    /// Returns the first format whose blocks have this number.
    fn format(&self) -> u32 {
        match self {
            Self::Within(..) => EARLIEST_FORMAT,
            Self::Of(number) => number.format,
            Self::Response => RESPONSE_FORMAT,
        }
    }

    fn hold(&self, value: f64) -> bool {
        match self {
            // A NaN fails this comparison.
            Self::Within(least, most) => value >= *least && value <= *most,
            Self::Of(number) => number.holds(value),
            Self::Response => value == 0.0 || Self::within(RESPONSES_S).hold(value),
        }
    }
}

/// Bytes that are being read.
struct Bytes<'a> {
    rest: &'a [u8],
    /// Count of numbers read so far.
    number: usize,
}

impl Bytes<'_> {
    fn take<const M: usize>(&mut self) -> Option<[u8; M]> {
        let (first, rest) = self.rest.split_first_chunk()?;
        self.rest = rest;
        Some(*first)
    }

    /// Reads the next number, which must be within these bounds.
    fn number(&mut self, bounds: &NumberBounds) -> Result<f64, BlockError> {
        let index = self.number;
        self.number += 1;
        let number = f64::from_le_bytes(self.take().ok_or(BlockError::Length)?);
        if bounds.hold(number) {
            Ok(number)
        } else {
            Err(BlockError::Number(index))
        }
    }

    /// Reads the geometry, which takes all remaining bytes except the checksum.
    fn geometry<const N: usize>(&mut self) -> Result<KnownGeometry<N>, BlockError> {
        let bounds = NumberBounds::Within(-MAX_GEOMETRY, MAX_GEOMETRY);
        let geometry = KnownGeometry::from_numbers(|| self.number(&bounds))?
            .map_err(|_| BlockError::Geometry)?;
        if self.rest.len() == 4 {
            Ok(geometry)
        } else {
            Err(BlockError::Length)
        }
    }
}

const CRC_START: u32 = !0;

/// Continues a CRC-32 over more bytes: bit by bit, as in the standard; a model is read once.
fn crc_on(mut crc: u32, bytes: &[u8]) -> u32 {
    for byte in bytes {
        crc ^= u32::from(*byte);
        for _ in 0..8 {
            crc = if crc & 1 == 1 {
                (crc >> 1) ^ 0xEDB8_8320
            } else {
                crc >> 1
            };
        }
    }
    crc
}

fn crc_32(bytes: &[u8]) -> u32 {
    !crc_on(CRC_START, bytes)
}

#[cfg(test)]
mod tests {
    extern crate std;

    use std::vec::Vec;

    use super::*;
    use crate::geometry::{AxisErrors, ErrorTable};
    use crate::identifier::contour::tests::sequence;

    fn contour<const N: usize>() -> ModelBlock<N> {
        let mut next = sequence();
        let mut net = ContourIdentifier::NULL;
        net.weights(&mut |_, group| group.iter_mut().for_each(|weight| *weight = 3.0 * next()));
        ModelBlock {
            model: TrainedModel {
                servo_s: 0.001,
                feed_period_s: 0.01,
                trained: Trained::Contour {
                    net,
                    response_s: 0.0,
                },
            },
            geometry: None,
        }
    }

    /// The same with a response time.
    fn responding<const N: usize>() -> ModelBlock<N> {
        let mut block = contour();
        if let Trained::Contour { response_s, .. } = &mut block.model.trained {
            *response_s = 0.006;
        }
        block
    }

    /// Each number within its range, and all different.
    fn axes<const N: usize>() -> ModelBlock<N> {
        let mut next = sequence();
        let mut axes = IdentifiedAxes::<N>::NULL;
        axes.periods.mechanics_s = 1e-4;
        for axis in &mut axes.axes {
            for number in Parameters::NUMBERS {
                let [least, most] = number.range;
                *(number.of)(axis) = least + (0.1 + 0.05 * next()) * (most.min(1.0) - least);
            }
        }
        ModelBlock {
            model: TrainedModel::of_axes(axes.at_servo_period(0.001).unwrap()),
            geometry: None,
        }
    }

    fn block<const N: usize>(model: &ModelBlock<N>) -> Vec<u8> {
        let mut bytes = Vec::new();
        model.to_bytes(|more| bytes.extend_from_slice(more));
        bytes
    }

    /// A block with the checksum that belongs to it.
    fn sealed(mut bytes: Vec<u8>) -> Vec<u8> {
        let end = bytes.len() - 4;
        let crc = crc_32(&bytes[..end]);
        bytes[end..].copy_from_slice(&crc.to_le_bytes());
        bytes
    }

    fn with_number(mut bytes: Vec<u8>, index: usize, number: f64) -> Vec<u8> {
        bytes[24 + 8 * index..][..8].copy_from_slice(&number.to_le_bytes());
        sealed(bytes)
    }

    #[test]
    fn the_checksum_agrees_with_the_standard() {
        // The check value of CRC-32/ISO-HDLC in every catalogue.
        assert_eq!(crc_32(b"123456789"), 0xCBF4_3926);
    }

    #[test]
    fn a_model_comes_back_to_the_bit() {
        assert_eq!(
            ModelBlock::from_bytes(&block(&contour::<2>())),
            Ok(contour::<2>())
        );
        assert_eq!(
            ModelBlock::from_bytes(&block(&contour::<3>())),
            Ok(contour::<3>())
        );
        assert_eq!(
            ModelBlock::from_bytes(&block(&responding::<3>())),
            Ok(responding::<3>())
        );
        assert_eq!(
            ModelBlock::from_bytes(&block(&axes::<2>())),
            Ok(axes::<2>())
        );
        assert_eq!(
            ModelBlock::from_bytes(&block(&axes::<3>())),
            Ok(axes::<3>())
        );
    }

    #[test]
    fn the_layout_is_what_the_table_says() {
        let bytes = block(&contour::<2>());
        assert_eq!(
            bytes[..24],
            *b"FWMODEL\0\x02\0\0\0\x01\0\0\0\x02\0\0\0\x90\0\0\0"
        );
        assert_eq!(bytes[24..32], 0.001_f64.to_le_bytes());
        assert_eq!(bytes[32..40], 0.01_f64.to_le_bytes());
        let Trained::Contour { mut net, .. } = contour::<2>().model.trained else {
            panic!("a contour")
        };
        let mut weights = Vec::new();
        net.weights(&mut |_, group| weights.extend_from_slice(group));
        let n = 2 * (5 * 12 + 12);
        assert_eq!(bytes[40..48], weights[0].to_le_bytes());
        assert_eq!(bytes[40 + 8 * (n - 1)..][..8], weights[n - 1].to_le_bytes());
        assert_eq!((n, bytes.len()), (0x90, 40 + 8 * n + 4));
        let bytes = block(&axes::<3>());
        let Trained::Axes(identified) = axes::<3>().model.trained else {
            panic!("axes")
        };
        let at =
            |index: usize| f64::from_le_bytes(bytes[40 + 8 * index..][..8].try_into().unwrap());
        let count = Parameters::NUMBERS.len();
        assert_eq!(
            (bytes[12], at(0), bytes.len()),
            (3, 1e-4, 40 + 8 * (1 + 3 * count) + 4)
        );
        assert_eq!(at(1), identified.axes[0].rad_per_mm);
        assert_eq!(at(1 + 10), identified.axes[0].speed_window_s);
        assert_eq!(at(1 + count + 13), identified.axes[1].inertia_kg_m2);
        assert_eq!(at(3 * count), identified.axes[2].command_delay_s);
    }

    #[test]
    fn a_block_without_command_delay_is_one_of_format_2() {
        let mut model = axes::<2>();
        let with = block(&model);
        let Trained::Axes(identified) = &mut model.model.trained else {
            panic!("axes")
        };
        identified
            .axes
            .iter_mut()
            .for_each(|axis| axis.command_delay_s = 0.0);
        let without = block(&model);
        assert_eq!(
            (with[8], without[8], with.len() - without.len()),
            (3, 2, 2 * 8)
        );
        assert_eq!(ModelBlock::<2>::from_bytes(&without), Ok(model));
        let mut relabeled = without;
        relabeled[8] = 3;
        assert_eq!(
            ModelBlock::<2>::from_bytes(&sealed(relabeled)),
            Err(BlockError::Length)
        );
    }

    /// Adds a geometry with every kind of error.
    fn with_geometry<const N: usize>(model: ModelBlock<N>) -> ModelBlock<N> {
        let axis = AxisErrors {
            scale: 1e-5,
            pitch_mm: 0.002,
            pitch_rad_per_mm: 0.6,
            pitch_phase_rad: 1.0,
            backlash_mm: 0.0,
        };
        let table = ErrorTable::new([[-10.0, 0.001], [0.0, 0.0], [30.0, -0.002]]).unwrap();
        let geometry = KnownGeometry::new([axis; N], [2e-5, -1e-5, 1e-5]).with_table(0, 1, table);
        ModelBlock {
            geometry: Some(geometry),
            ..model
        }
    }

    #[test]
    fn a_geometry_comes_back_to_the_bit_in_a_block_of_format_4() {
        let model = with_geometry(axes::<3>());
        let bytes = block(&model);
        assert_eq!(
            (bytes[8], bytes.len()),
            (4, block(&axes::<3>()).len() + 8 * (3 * 4 + 3 + 9 + 6))
        );
        assert_eq!(ModelBlock::from_bytes(&bytes), Ok(model));
        assert_eq!(
            ModelBlock::from_bytes(&block(&with_geometry(contour::<2>()))),
            Ok(with_geometry(contour::<2>()))
        );
        // A geometry is not what an earlier format has, and a later one does not go without.
        for (bytes, format) in [(bytes, 3), (block(&axes::<3>()), 4)] {
            let mut relabeled = bytes;
            relabeled[8] = format;
            assert_eq!(
                ModelBlock::<3>::from_bytes(&sealed(relabeled)),
                Err(BlockError::Length)
            );
        }
    }

    #[test]
    fn a_response_time_makes_a_block_of_format_5_with_a_geometry_or_without() {
        let (plain, with) = (block(&contour::<2>()), block(&responding::<2>()));
        assert_eq!((plain[8], with[8], with.len() - plain.len()), (2, 5, 8));
        let both = with_geometry(responding::<2>());
        assert_eq!(block(&both)[8], 5);
        assert_eq!(ModelBlock::from_bytes(&block(&both)), Ok(both));
        let last = (with.len() - 4 - 24) / 8 - 1;
        for hostile_s in [f64::NAN, -0.006, 1e-7, 1.1, f64::INFINITY] {
            let read = ModelBlock::<2>::from_bytes(&with_number(with.clone(), last, hostile_s));
            assert_eq!(read, Err(BlockError::Number(last)), "{hostile_s}");
        }
        // Earlier blocks state none, with a geometry, too.
        let earlier = with_geometry(contour::<2>());
        assert_eq!(block(&earlier)[8], 4);
        assert_eq!(ModelBlock::from_bytes(&block(&earlier)), Ok(earlier));
    }

    #[test]
    fn every_number_of_a_geometry_has_bounds() {
        let bytes = block(&with_geometry(axes::<2>()));
        let [first, end] = [block(&axes::<2>()).len(), bytes.len()].map(|length| (length - 28) / 8);
        for index in first..end {
            for number in [f64::NAN, f64::INFINITY, -f64::INFINITY, 1e7, -1e7] {
                let read = ModelBlock::<2>::from_bytes(&with_number(bytes.clone(), index, number));
                assert_eq!(read, Err(BlockError::Number(index)), "{number}");
            }
        }
        let read = |number| ModelBlock::<2>::from_bytes(&with_number(bytes.clone(), first, number));
        assert_eq!(read(0.06), Err(BlockError::Geometry));
        assert!(read(0.03).is_ok());
    }

    #[test]
    fn any_changed_byte_is_refused() {
        for bytes in [
            block(&contour::<2>()),
            block(&responding::<2>()),
            block(&axes::<2>()),
            block(&with_geometry(axes::<2>())),
        ] {
            for at in 0..bytes.len() {
                for change in [0x01, 0x80, 0xff] {
                    let mut changed = bytes.clone();
                    changed[at] ^= change;
                    assert!(
                        ModelBlock::<2>::from_bytes(&changed).is_err(),
                        "byte {at} by {change:#x}"
                    );
                }
            }
        }
    }

    #[test]
    fn any_other_length_is_refused() {
        of_any_other_length_are_refused(block(&contour::<2>()));
        of_any_other_length_are_refused(block(&responding::<2>()));
        of_any_other_length_are_refused(block(&axes::<2>()));
        of_any_other_length_are_refused(block(&with_geometry(axes::<2>())));
    }

    fn of_any_other_length_are_refused(bytes: Vec<u8>) {
        for length in 0..bytes.len() {
            assert!(
                ModelBlock::<2>::from_bytes(&bytes[..length]).is_err(),
                "{length}"
            );
            let mut cut = bytes[..length].to_vec();
            if length >= 28 {
                cut = sealed(cut);
                assert_eq!(
                    ModelBlock::<2>::from_bytes(&cut),
                    Err(BlockError::Length),
                    "{length}"
                );
            }
        }
        let mut longer = bytes;
        longer.extend_from_slice(&[0; 8]);
        assert_eq!(
            ModelBlock::<2>::from_bytes(&sealed(longer)),
            Err(BlockError::Length)
        );
    }

    #[test]
    fn an_invalid_model_is_reported_by_what_is_wrong() {
        let with_whole = |at: usize, whole: u32| {
            let mut bytes = block(&contour::<2>());
            bytes[at..at + 4].copy_from_slice(&whole.to_le_bytes());
            ModelBlock::<2>::from_bytes(&sealed(bytes))
        };
        assert_eq!(with_whole(8, 1), Err(BlockError::Format(1)));
        assert_eq!(with_whole(12, 4), Err(BlockError::Kind(4)));
        let of_another_time = std::format!("{}", with_whole(12, SERVO).unwrap_err());
        assert!(
            of_another_time.contains("servo identifier"),
            "{of_another_time}"
        );
        assert!(
            of_another_time.contains("'feedwright identify'"),
            "{of_another_time}"
        );
        assert_eq!(with_whole(12, 3), Err(BlockError::Length));
        assert_eq!(with_whole(16, 3), Err(BlockError::Axes(3)));
        assert_eq!(with_whole(20, u32::MAX), Err(BlockError::Length));
        assert_eq!(
            ModelBlock::<3>::from_bytes(&block(&contour::<2>())),
            Err(BlockError::Axes(2))
        );
        assert_eq!(
            ModelBlock::<2>::from_bytes(&[0; 4096]),
            Err(BlockError::NoModel)
        );
    }

    #[test]
    fn every_number_has_bounds() {
        let bytes = block(&contour::<2>());
        let numbers = (bytes.len() - 28) / 8;
        for index in 0..numbers {
            for number in [f64::NAN, f64::INFINITY, -f64::INFINITY, 1e7, -1e7] {
                let refused =
                    ModelBlock::<2>::from_bytes(&with_number(bytes.clone(), index, number));
                assert_eq!(refused, Err(BlockError::Number(index)), "{number}");
            }
        }
        let refused = |index, number| {
            ModelBlock::<2>::from_bytes(&with_number(bytes.clone(), index, number)).is_err()
        };
        assert!(refused(0, 0.0) && refused(1, 0.0) && refused(1, 2.0));
    }

    #[test]
    fn every_number_of_an_axis_has_its_own_bounds() {
        let bytes = block(&axes::<2>());
        let read =
            |index, number| ModelBlock::<2>::from_bytes(&with_number(bytes.clone(), index, number));
        for axis in 0..2 {
            for (i, number) in Parameters::NUMBERS.iter().enumerate() {
                let index = 3 + axis * Parameters::NUMBERS.len() + i;
                let [least, most] = number.range;
                for value in [
                    f64::NAN,
                    f64::INFINITY,
                    -f64::INFINITY,
                    least - 1.0,
                    1.001 * most,
                ] {
                    assert_eq!(
                        read(index, value),
                        Err(BlockError::Number(index)),
                        "{} {value}",
                        number.name
                    );
                }
                assert!(
                    read(index, least).is_ok() && read(index, most).is_ok(),
                    "{}",
                    number.name
                );
                // What is divided by is zero or no less than its least.
                let divides = number.or_none || least > 0.0;
                assert_eq!(read(index, 1e-300).is_err(), divides, "{}", number.name);
                assert_eq!(
                    read(index, 0.0).is_err(),
                    least > 0.0 && !number.or_none,
                    "{}",
                    number.name
                );
            }
        }
    }

    #[test]
    fn axes_have_whole_mechanics_periods_in_a_servo_period() {
        let bytes = block(&axes::<2>());
        let read =
            |mechanics_s| ModelBlock::<2>::from_bytes(&with_number(bytes.clone(), 2, mechanics_s));
        for hostile_s in [
            0.0,
            -0.0,
            -1e-4,
            f64::NAN,
            f64::INFINITY,
            1e-300,
            9e-8,
            1e-7,
            5e-7,
            0.0003,
            0.002,
            0.1,
            1e7,
        ] {
            assert_eq!(read(hostile_s), Err(BlockError::Number(2)), "{hostile_s}");
        }
        for (fine_s, periods) in [(1e-6, 1_000), (1e-4, 10), (0.0005, 2), (0.001, 1)] {
            let Ok(Trained::Axes(axes)) = read(fine_s).map(|block| block.model.trained) else {
                panic!("{fine_s}")
            };
            assert_eq!(axes.periods.mechanics_per_servo, periods, "{fine_s}");
        }
        // The longest servo period has a million of the shortest.
        let longest = with_number(with_number(bytes.clone(), 0, 0.1), 2, 1e-7);
        assert_eq!(
            ModelBlock::<2>::from_bytes(&longest),
            Err(BlockError::Number(2))
        );
        let Trained::Axes(identified) = axes::<2>().model.trained else {
            panic!("axes")
        };
        assert!(identified.are_possible(0.001) && !identified.are_possible(0.00015));
        assert!(!IdentifiedAxes::<2>::NULL.are_possible(0.001));
    }
}
