//! The G-codes that the reader knows, their modal groups, and which words each takes.
//!
//! Groups and numbers: NISTIR 6556, table 4, and the LinuxCNC G-code reference. A number is ten
//! times the code: G38.2 is 382.

pub(crate) mod fanuc;

/// Codes of one group exclude each other on a line.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(u8)]
pub(crate) enum Group {
    /// Acts on this line only.
    NonModal,
    Motion,
    Plane,
    Distance,
    ArcDistance,
    FeedMode,
    Units,
    CutterCompensation,
    ToolLength,
    Return,
    Coordinates,
    Corner,
    SpindleMode,
    Diameter,
    /// Fanuc: G68, G69.
    Rotation,
    /// Fanuc: G15, G16.
    Polar,
    /// G50 of Tormach and others.
    Scaling,
}

/// Number of groups.
pub(super) const GROUPS: usize = 17;

/// Bit of a letter in a set of letters; `@`, `^` and `$` follow the alphabet.
pub(crate) const fn bit(letter: u8) -> u32 {
    1 << slot(letter)
}

/// Place of a letter in arrays with one entry a letter.
pub(crate) const fn slot(letter: u8) -> usize {
    match letter {
        b'@' => 26,
        b'^' => 27,
        b'$' => 28,
        _ => ((letter.wrapping_sub(b'a')) & 31) as usize,
    }
}

/// The letter of a place, in upper case.
pub(crate) const fn letter(slot: usize) -> char {
    match slot {
        26 => '@',
        27 => '^',
        28 => '$',
        _ => (b'A' + slot as u8) as char,
    }
}

pub(super) const fn bits(letters: &[u8]) -> u32 {
    let mut set = 0;
    let mut n = 0;
    while n < letters.len() {
        set |= bit(letters[n]);
        n += 1;
    }
    set
}

/// X Y Z A B C U V W and polar coordinates.
pub(crate) const AXES: u32 = bits(b"xyzabcuvw@^");
/// The axes in the order of positions.
pub(crate) const AXIS_LETTERS: [u8; 9] = *b"xyzabcuvw";
/// I J K.
pub(crate) const ARC_CENTER: u32 = bits(b"ijk");
/// Letters that any line may have: their meaning does not depend on a G-code.
pub(crate) const ALWAYS: u32 = bits(b"fstngmo");

/// One row of the table.
#[derive(Debug)]
pub(crate) struct Code {
    /// Ten times the code.
    pub(super) number: u16,
    pub(crate) group: Group,
    /// Letters that it gives a meaning to, axes included where it uses them.
    pub(crate) letters: u32,
}

pub(super) const fn code(number: u16, group: Group, letters: &[u8]) -> Code {
    Code {
        number,
        group,
        letters: bits(letters),
    }
}

pub(super) const fn axes(number: u16, group: Group, letters: &[u8]) -> Code {
    Code {
        number,
        group,
        letters: bits(letters) | AXES,
    }
}

use Group::{
    ArcDistance, Coordinates, Corner, CutterCompensation, Diameter, Distance, FeedMode, Motion,
    NonModal, Plane, Return, Scaling, SpindleMode, ToolLength, Units,
};

/// Every code.
pub(super) const CODES: &[Code] = &[
    axes(0, Motion, b""),
    axes(10, Motion, b""),
    axes(20, Motion, b"ijkrp"),
    axes(30, Motion, b"ijkrp"),
    code(40, NonModal, b"p"),
    axes(50, Motion, b"ijpq"),
    axes(51, Motion, b"ij"),
    axes(52, Motion, b"pl"),
    code(53, Motion, b""),
    axes(62, Motion, b"kpqrl"),
    code(70, Diameter, b""),
    code(80, Diameter, b""),
    axes(100, NonModal, b"lprijq"),
    code(170, Plane, b""),
    code(180, Plane, b""),
    code(190, Plane, b""),
    code(200, Units, b""),
    code(210, Units, b""),
    axes(280, NonModal, b""),
    code(281, NonModal, b""),
    axes(300, NonModal, b""),
    code(301, NonModal, b""),
    axes(330, Motion, b"k$"),
    axes(331, Motion, b"ki$"),
    axes(382, Motion, b""),
    axes(383, Motion, b""),
    axes(384, Motion, b""),
    axes(385, Motion, b""),
    code(400, CutterCompensation, b""),
    code(401, CutterCompensation, b""),
    code(410, CutterCompensation, b"d"),
    code(411, CutterCompensation, b"dl"),
    code(420, CutterCompensation, b"d"),
    code(421, CutterCompensation, b"dl"),
    code(430, ToolLength, b"h"),
    axes(431, ToolLength, b""),
    axes(432, ToolLength, b"h"),
    code(490, ToolLength, b""),
    code(500, Scaling, b""),
    axes(520, NonModal, b""),
    code(530, NonModal, b""),
    code(540, Coordinates, b""),
    code(541, Coordinates, b"p"),
    code(550, Coordinates, b""),
    code(560, Coordinates, b""),
    code(570, Coordinates, b""),
    code(580, Coordinates, b""),
    code(590, Coordinates, b""),
    code(591, Coordinates, b""),
    code(592, Coordinates, b""),
    code(593, Coordinates, b""),
    code(610, Corner, b""),
    code(611, Corner, b""),
    code(640, Corner, b"pq"),
    axes(700, Motion, b"qdepr"),
    axes(710, Motion, b"qdir"),
    axes(711, Motion, b"qdir"),
    axes(712, Motion, b"qdir"),
    axes(720, Motion, b"qdir"),
    axes(721, Motion, b"qdir"),
    axes(722, Motion, b"qdir"),
    axes(730, Motion, b"rlq"),
    axes(740, Motion, b"rlp"),
    axes(760, Motion, b"pijrkqhel$"),
    code(800, Motion, b""),
    axes(810, Motion, b"rl"),
    axes(820, Motion, b"rlp"),
    axes(830, Motion, b"rlq"),
    axes(840, Motion, b"rlp"),
    axes(850, Motion, b"rl"),
    axes(860, Motion, b"rlp"),
    axes(870, Motion, b"rlijk"),
    axes(880, Motion, b"rlp"),
    axes(890, Motion, b"rlp"),
    code(900, Distance, b""),
    code(901, ArcDistance, b""),
    code(910, Distance, b""),
    code(911, ArcDistance, b""),
    axes(920, NonModal, b""),
    code(921, NonModal, b""),
    code(922, NonModal, b""),
    code(923, NonModal, b""),
    code(930, FeedMode, b""),
    code(940, FeedMode, b""),
    code(950, FeedMode, b"$"),
    code(960, SpindleMode, b"d$"),
    code(970, SpindleMode, b"$"),
    code(980, Return, b""),
    code(990, Return, b""),
];

/// Marks a number in [`INDEX`] that is no code.
const NONE: u8 = u8::MAX;

/// Row of each number.
const INDEX: [u8; 1000] = {
    let mut index = [NONE; 1000];
    let mut row = 0;
    while row < CODES.len() {
        index[CODES[row].number as usize] = row as u8;
        row += 1;
    }
    index
};

/// The row of a number.
#[inline]
pub(crate) fn find(number: u16) -> Option<&'static Code> {
    match INDEX.get(usize::from(number)) {
        Some(&row) if row != NONE => CODES.get(usize::from(row)),
        _ if number >= fanuc::OWN => fanuc::row(number),
        _ => None,
    }
}

/// The code as written: `G38.2`.
pub(crate) fn spelled(number: u16) -> String {
    let number = number % fanuc::OWN;
    if number.is_multiple_of(10) {
        format!("G{}", number / 10)
    } else {
        format!("G{}.{}", number / 10, number % 10)
    }
}

/// The known codes closest to an unknown number, as a hint.
pub(super) fn nearest(number: f64) -> String {
    let mut best: Vec<u16> = Vec::new();
    let mut distance = f64::INFINITY;
    for row in CODES {
        let away = (f64::from(row.number) / 10.0 - number).abs();
        if away < distance {
            distance = away;
            best.clear();
        }
        if away <= distance {
            best.push(row.number);
        }
    }
    best.into_iter()
        .map(spelled)
        .collect::<Vec<_>>()
        .join(" and ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_code_finds_its_row() {
        assert!(CODES.len() < usize::from(NONE));
        for row in CODES {
            assert_eq!(find(row.number).unwrap().number, row.number);
        }
        assert!(find(15).is_none());
        assert!(find(u16::MAX).is_none());
    }

    #[test]
    fn the_nearest_code_is_a_neighbour() {
        assert_eq!(nearest(1.5), "G1 and G2");
        assert_eq!(nearest(38.9), "G38.5");
        assert_eq!(spelled(591), "G59.1");
    }

    #[test]
    fn letters_have_places_of_their_own() {
        let all = b"abcdefghijklmnopqrstuvwxyz@^$";
        assert_eq!(bits(all).count_ones() as usize, all.len());
        assert_eq!(letter(slot(b'q')), 'Q');
        assert_eq!(letter(slot(b'^')), '^');
    }
}
