//! Units of positions and of time, and how they are written.

use std::fmt;

use feedwright_gcode::INCH_MM;

use super::TorqueUnit;

/// Unit of the positions of a log.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PositionUnit {
    /// m.
    Metre,
    /// mm.
    Millimetre,
    /// um.
    Micrometre,
    /// Inches.
    Inch,
}

/// Returns true if the text in the place of a unit states none.
pub(super) fn is_unstated(text: &str) -> bool {
    ["", "-", "--", "1", "none", "n/a"].contains(&text.to_lowercase().as_str())
}

/// Lengths a second in one of the unit of a speed, such as `mm/min`, and the unit of the length.
pub(super) fn speed_unit(text: &str) -> Option<(PositionUnit, f64)> {
    let (length, time) = text.split_once('/')?;
    let time_s = match time.trim().to_lowercase().as_str() {
        "min" | "minute" => 60.0,
        time => TimeUnit::from_name(time)
            .filter(|unit| *unit != TimeUnit::Sample)?
            .in_s(1.0),
    };
    Some((PositionUnit::from_name(length.trim())?, 1.0 / time_s))
}

impl PositionUnit {
    /// Units that are known, for messages.
    pub(super) const KNOWN: &'static str = "mm, um, m or inch";

    /// Finds a unit by the name that somebody gives it. A micro sign that is no UTF-8 has become
    /// U+FFFD.
    pub(crate) fn from_name(name: &str) -> Option<Self> {
        match name.to_lowercase().as_str() {
            "m" | "meter" | "metre" | "meters" | "metres" => Some(Self::Metre),
            "mm" | "millimeter" | "millimetre" | "millimeters" | "millimetres" => {
                Some(Self::Millimetre)
            }
            "um" | "\u{b5}m" | "\u{3bc}m" | "\u{fffd}m" | "micron" | "microns" | "micrometer"
            | "micrometre" | "micrometers" | "micrometres" => Some(Self::Micrometre),
            "in" | "in." | "inch" | "inches" | "\"" => Some(Self::Inch),
            _ => None,
        }
    }

    /// Millimetres in one of it.
    pub const fn in_mm(self) -> f64 {
        match self {
            Self::Metre => 1e3,
            Self::Millimetre => 1.0,
            Self::Micrometre => 1e-3,
            Self::Inch => INCH_MM,
        }
    }
}

impl fmt::Display for PositionUnit {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Metre => "m",
            Self::Millimetre => "mm",
            Self::Micrometre => "um",
            Self::Inch => "inch",
        })
    }
}

/// Unit of the time of a log.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum TimeUnit {
    /// s.
    Second,
    /// ms.
    Millisecond,
    /// us.
    Microsecond,
    /// ns.
    Nanosecond,
    /// Samples, counted.
    Sample,
}

impl TimeUnit {
    /// Units that are known, for messages.
    pub(super) const KNOWN: &'static str = "s, ms, us, ns or samples";

    /// Finds a unit by the name that somebody gives it.
    pub(crate) fn from_name(name: &str) -> Option<Self> {
        match name.to_lowercase().as_str() {
            "s" | "sec" | "second" | "seconds" => Some(Self::Second),
            "ms" | "msec" | "millisecond" | "milliseconds" => Some(Self::Millisecond),
            "us" | "usec" | "\u{b5}s" | "\u{3bc}s" | "\u{fffd}s" | "microsecond"
            | "microseconds" => Some(Self::Microsecond),
            "ns" | "nsec" | "nanosecond" | "nanoseconds" => Some(Self::Nanosecond),
            "samples" | "sample" | "n" => Some(Self::Sample),
            _ => None,
        }
    }

    /// Seconds in one of it; a sample takes as long as is said.
    pub(crate) const fn in_s(self, sample_time_s: f64) -> f64 {
        match self {
            Self::Second => 1.0,
            Self::Millisecond => 1e-3,
            Self::Microsecond => 1e-6,
            Self::Nanosecond => 1e-9,
            Self::Sample => sample_time_s,
        }
    }
}

impl fmt::Display for TimeUnit {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Second => "s",
            Self::Millisecond => "ms",
            Self::Microsecond => "us",
            Self::Nanosecond => "ns",
            Self::Sample => "samples",
        })
    }
}

impl TorqueUnit {
    /// Units that are known, for messages.
    pub(super) const KNOWN: &'static str = "N m, mN m, N cm, kN m, N, kN, V, mV, A, mA or %";

    /// Finds a unit by the name that a file gives it, and the amount of it that one named unit is.
    pub(super) fn from_name(name: &str) -> Option<(Self, f64)> {
        Some(
            match name
                .to_lowercase()
                .replace([' ', '*', '.', '-', '\u{b7}'], "")
                .as_str()
            {
                "nm" => (Self::NewtonMetre, 1.0),
                "mnm" => (Self::NewtonMetre, 1e-3),
                "ncm" => (Self::NewtonMetre, 1e-2),
                "knm" => (Self::NewtonMetre, 1e3),
                "n" => (Self::Newton, 1.0),
                "kn" => (Self::Newton, 1e3),
                "v" | "volt" | "volts" => (Self::Volt, 1.0),
                "mv" => (Self::Volt, 1e-3),
                "a" | "amp" | "amps" | "ampere" | "arms" => (Self::Ampere, 1.0),
                "ma" => (Self::Ampere, 1e-3),
                "percent" | "pct" => (Self::Percent, 1.0),
                // Of what the drive is rated for, in whatever words.
                text if text.starts_with('%') => (Self::Percent, 1.0),
                _ => return None,
            },
        )
    }
}
