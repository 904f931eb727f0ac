//! Differences from LinuxCNC that are intended: the rows of docs/gcode-differences.md that a random program can meet.

/// A row: a part of the difference as it is told, parts that the program has, the row of the table.
type Row = (&'static str, &'static [&'static str], &'static str);

const ROWS: &[Row] = &[
    ("Two m codes used from same modal group", &["M"], "M-codes on one line that LinuxCNC counts to one group"),
    ("L word with no G10", &["G74"], "L with G74"),
    ("K word missing with g33", &["G33"], "G28, G30 or G92 while G33 is active"),
    ("does not fit into the inner corner", &["G4"], "an entry into compensation that leads the tool into the contour"),
    (
        "cannot be reached by the tool without gouging",
        &["G4"],
        "a corner of compensation that LinuxCNC refuses by rounding",
    ),
    ("G76 needs the plane G18", &["G76"], "G76 outside G18"),
    ("inside the profile of a lathe cycle", &["sub"], "codes in the profile of a lathe cycle"),
    ("the profile of G7", &["sub"], "profiles of lathe cycles"),
    ("the curve of G5.2 is not complete", &["G5.2"], "a curve begun by G5.2 and left without G5.3"),
    ("another", &["G43", "G20"], "G28, G30 and G49 under G43.1 in another unit"),
    ("Cannot intersect parallel lines", &["sub"], "profiles of lathe cycles"),
    ("zero feed rate", &["G94"], "G94 where it is active already"),
    ("already has a word P", &[" P"], "P twice on a line"),
    ("O9000 has no M99", &["O9000"], "a subroutine without its M99"),
    ("seeking o-word: o<9000>", &["O9000"], "a subroutine for M98 that LinuxCNC does not find"),
    ("Unexpected character after O-word", &["O9000"], "N before the O of a subroutine"),
    ("Nested subroutine definition", &[" sub"], "an O-word without its keyword in a subroutine"),
    ("another end", &["G96", "G33"], "G33 under G96, where we cut a thread in pieces"),
    ("Unexpected character after O-word", &[" elseif "], "words behind an elseif that is not carried out"),
    ("another end", &["G96", "G95"], "G95 under G96, where we cut a straight motion in pieces"),
    ("another", &["G84", "G18"], "G84 and G74 outside G17"),
    ("another", &["G84", "G19"], "G84 and G74 outside G17"),
    ("another", &["G74", "G18"], "G84 and G74 outside G17"),
    ("another", &["G74", "G19"], "G84 and G74 outside G17"),
    ("another", &[" mod "], "MOD of a multiple, by rounding"),
    ("another", &["endsub [5]"], "the value of a subroutine that is only defined"),
    ("another", &["G52", "G10 L2", " R"], "rotation of the active system under G92"),
    ("another", &["G92", "G10 L2", " R"], "rotation of the active system under G92"),
    ("off the spline", &["G5"], "points of splines where LinuxCNC's preview has not noticed Z of an arc"),
    ("no code such as G0 or G1", &["G5"], "axis words alone behind G5 and G5.1"),
    ("needs its weight P", &["G5.2"], "G5.2 without P"),
    ("with L word, but plane", &["G4"], "L with G41.1 and G42.1"),
    ("I J words not allowed with G10 L2", &["G10"], "I and J with G10 L2"),
    ("Unclosed comment", &["(open"], "a comment that is open in a line that is not carried out"),
    ("needs its word Q", &["M6"], "M67 and M68 without Q"),
];

/// The row that a difference belongs to.
pub(crate) fn find(text: &str, difference: &str) -> Option<&'static str> {
    let fits = |row: &&Row| difference.contains(row.0) && row.1.iter().all(|part| text.contains(part));
    ROWS.iter().find(fits).map(|row| row.2)
}
