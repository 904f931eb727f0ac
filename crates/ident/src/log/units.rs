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

impl PositionUnit {
    /// By the name that somebody gives it. A micro sign that is no UTF-8 has become U+FFFD.
    pub fn from_name(name: &str) -> Option<Self> {
        match name.to_lowercase().as_str() {
            "m" | "meter" | "metre" => Some(Self::Metre),
            "mm" | "millimeter" | "millimetre" => Some(Self::Millimetre),
            "um" | "\u{b5}m" | "\u{3bc}m" | "\u{fffd}m" | "micron" | "micrometer" | "micrometre" => {
                Some(Self::Micrometre)
            }
            "in" | "inch" | "inches" | "\"" => Some(Self::Inch),
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
    /// By the name that somebody gives it.
    pub fn from_name(name: &str) -> Option<Self> {
        match name.to_lowercase().as_str() {
            "s" | "sec" | "second" | "seconds" => Some(Self::Second),
            "ms" | "msec" | "millisecond" | "milliseconds" => Some(Self::Millisecond),
            "us" | "usec" | "\u{b5}s" | "\u{3bc}s" | "microsecond" | "microseconds" => Some(Self::Microsecond),
            "ns" | "nsec" | "nanosecond" | "nanoseconds" => Some(Self::Nanosecond),
            "samples" | "sample" | "n" => Some(Self::Sample),
            _ => None,
        }
    }

    /// Seconds in one of it; a sample takes as long as is said.
    pub const fn in_s(self, sample_time_s: f64) -> f64 {
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
    /// By the name that a file gives it.
    pub(super) fn from_name(name: &str) -> Self {
        match name.to_lowercase().replace([' ', '*', '.', '\u{b7}'], "").as_str() {
            "nm" => Self::NewtonMetre,
            "n" => Self::Newton,
            "v" | "volt" | "volts" => Self::Volt,
            "a" | "amp" | "amps" | "ampere" => Self::Ampere,
            "%" | "percent" => Self::Percent,
            _ => Self::Unknown,
        }
    }
}
