//! G-codes whose meaning on Fanuc and Haas is their own, beside or in place of LinuxCNC's.
//!
//! A number is ten times the code, plus [`OWN`] or [`LATHE_OWN`]: `G90` of a lathe is 40900, so
//! that it is never taken for LinuxCNC's 900.

use crate::text::codes::{self, Code, Group, axes, code};

/// Added to ten times a code of Fanuc and Haas.
pub(crate) const OWN: u16 = 20_000;
/// Added to ten times a code that lathes alone have.
pub(crate) const LATHE_OWN: u16 = 2 * OWN;

/// Hint for G90, G92 or G94 used as modes in a lathe program.
pub(crate) const SYSTEM_A: &str = "G90, G92 and G94 are cycles in G-code system A, the only one that is read of lathes; there U and W are distances, and \
     G98 and G99 feeds per minute and per revolution";

/// Whose G-codes a line has.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub(crate) enum CodeSet {
    #[default]
    Rs274,
    Mill,
    /// G-code system A.
    Lathe,
}

/// G-codes of mills and lathes alike.
const BOTH: &[Code] = &[
    code(OWN + 40, Group::NonModal, b"pxu"),
    code(OWN + 650, Group::NonModal, b"abcdefhijklmpqrstuvwxyz"),
    code(OWN + 670, Group::NonModal, b""),
    code(OWN + 541, Group::Coordinates, b"p"),
    code(OWN + 1540, Group::Coordinates, b"p"),
];

/// G-codes of mills.
const MILL: &[Code] = &[
    code(OWN + 150, Group::Polar, b""),
    code(OWN + 160, Group::Polar, b""),
    axes(OWN + 500, Group::NonModal, b"s"),
    code(OWN + 501, Group::NonModal, b""),
    axes(OWN + 680, Group::Rotation, b"r"),
    code(OWN + 690, Group::Rotation, b""),
    axes(OWN + 730, Group::Motion, b"rlqkp"),
    axes(OWN + 740, Group::Motion, b"rlpk"),
    axes(OWN + 810, Group::Motion, b"rlk"),
    axes(OWN + 820, Group::Motion, b"rlpk"),
    axes(OWN + 830, Group::Motion, b"rlqkpij"),
    axes(OWN + 840, Group::Motion, b"rlpk"),
    axes(OWN + 850, Group::Motion, b"rlkp"),
    axes(OWN + 860, Group::Motion, b"rlpk"),
    axes(OWN + 880, Group::Motion, b"rlpk"),
    axes(OWN + 890, Group::Motion, b"rlpk"),
];

/// G-codes of lathes.
const LATHE: &[Code] = &[
    axes(LATHE_OWN + 320, Group::Motion, b"fq"),
    code(LATHE_OWN + 410, Group::CutterCompensation, b""),
    code(LATHE_OWN + 420, Group::CutterCompensation, b""),
    axes(LATHE_OWN + 500, Group::NonModal, b"s"),
    axes(LATHE_OWN + 700, Group::NonModal, b"pq"),
    axes(LATHE_OWN + 710, Group::NonModal, b"pqrdik"),
    axes(LATHE_OWN + 720, Group::NonModal, b"pqrdik"),
    axes(LATHE_OWN + 730, Group::NonModal, b"pqrdik"),
    axes(LATHE_OWN + 740, Group::NonModal, b"pqrikd"),
    axes(LATHE_OWN + 750, Group::NonModal, b"pqrikd"),
    axes(LATHE_OWN + 760, Group::NonModal, b"pqrikda"),
    axes(LATHE_OWN + 810, Group::Motion, b"rlk"),
    axes(LATHE_OWN + 820, Group::Motion, b"rlpk"),
    axes(LATHE_OWN + 830, Group::Motion, b"rlqkp"),
    axes(LATHE_OWN + 840, Group::Motion, b"rlpk"),
    axes(LATHE_OWN + 850, Group::Motion, b"rlpk"),
    axes(LATHE_OWN + 900, Group::Motion, b"ri"),
    axes(LATHE_OWN + 920, Group::Motion, b"riq"),
    axes(LATHE_OWN + 940, Group::Motion, b"rk"),
];

/// LinuxCNC's codes that mean something else on a lathe of system A, or nothing.
const NOT_ON_LATHES: &[u16] = &[
    50, 51, 52, 53, 62, 70, 80, 330, 331, 411, 421, 430, 431, 432, 500, 711, 712, 721, 722, 860,
    870, 880, 890, 901, 910, 911, 921, 922, 923, 930,
];
/// The same for mills.
const NOT_ON_MILLS: &[u16] = &[70, 80, 411, 421, 711, 712, 721, 722, 760, 870, 901, 911];

impl CodeSet {
    /// The row of a code as it is written, ten times its number.
    #[inline]
    pub(crate) fn find(self, tenths: u16) -> Option<&'static Code> {
        match self {
            Self::Rs274 => codes::find(tenths),
            Self::Mill => find_own(tenths, OWN, MILL, NOT_ON_MILLS),
            // Feed per minute and per revolution.
            Self::Lathe if tenths == 980 => codes::find(940),
            Self::Lathe if tenths == 990 => codes::find(950),
            Self::Lathe => find_own(tenths, LATHE_OWN, LATHE, NOT_ON_LATHES),
        }
    }
}

fn find_own(
    tenths: u16,
    offset: u16,
    own: &'static [Code],
    not_read: &[u16],
) -> Option<&'static Code> {
    let with =
        |rows: &'static [Code], offset| rows.iter().find(|row| row.number == tenths + offset);
    with(own, offset).or_else(|| with(BOTH, OWN)).or_else(|| {
        if not_read.contains(&tenths) {
            None
        } else {
            codes::find(tenths)
        }
    })
}

/// The row of a number that [`CodeSet::find`] has given.
pub(crate) fn row(number: u16) -> Option<&'static Code> {
    [BOTH, MILL, LATHE]
        .into_iter()
        .flatten()
        .find(|row| row.number == number)
}
