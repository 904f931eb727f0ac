//! G-codes of other controls. The reader refuses them and says what they do: naming the nearest
//! known G-code would not help.

/// Codes, ten times their number; what they do; what helps.
const CODES: &[(&[u16], &str, &str)] = &[
    (
        &[71, 1070],
        "cylindrical interpolation",
        "let the CAM system write A, B or C and X, Y, Z",
    ),
    (
        &[120, 130, 1500],
        "a pocket cycle of Haas",
        "let the CAM system write the motions of the pocket, or write them with G1, G2 and G3",
    ),
    (
        &[150, 160],
        "polar coordinates",
        "write X and Y, or the radius as @ and the angle as ^: G1 @10 ^30",
    ),
    (
        &[310],
        "a motion until a signal",
        "G38.2 is a motion until the probe trips",
    ),
    (&[320], "threading", "G33 with K, the pitch, cuts a thread"),
    (
        &[434, 435, 1410, 1430, 2340],
        "compensation for the length or radius of a tool that tilts",
        "let the CAM system write the motions of a machine with X, Y and Z",
    ),
    (&[510], "scaling", "scale the part in the CAM system"),
    (
        &[501, 511],
        "a mirror image",
        "mirror the part in the CAM system, or negate the coordinates",
    ),
    (
        &[470],
        "the engraving of Haas",
        "let the CAM system write the motions of the letters",
    ),
    (
        &[1030],
        "the limit of Haas's look-ahead",
        "leave it out: it moves nothing",
    ),
    (
        &[600],
        "approaching from one side",
        "write the approach with G0",
    ),
    (
        &[650, 660, 661, 670],
        "a call of a macro",
        "--dialect fanuc reads G65; LinuxCNC calls a subroutine by `o<name> call [1] [2]`; write a modal call (G66) out",
    ),
    (
        &[680, 690],
        "a rotation of the coordinates",
        "G10 L2 P0 R30 turns the coordinate system by 30 degrees about its origin, and R0 back; --dialect fanuc reads G68 of mills",
    ),
    (
        &[682, 683, 684, 2540, 2550],
        "a tilted plane",
        "let the CAM system write the motions of a machine with X, Y and Z",
    ),
    (
        &[171, 181, 191],
        "a plane of U, V and W",
        "write the arcs in X, Y and Z, in G17, G18 or G19",
    ),
    (
        &[1540],
        "a further coordinate system of Haas",
        "write G154 P1 for G110 and so on (--dialect haas), or G54 to G59",
    ),
    (
        &[1870],
        "the smoothness of Haas",
        "--dialect haas leaves it out, because it moves nothing",
    ),
];

/// Returns what a code of another control does, and the remedy.
pub(super) fn what(tenths: f64) -> Option<(&'static str, &'static str)> {
    let row = CODES
        .iter()
        .find(|(codes, ..)| codes.iter().any(|&code| f64::from(code) == tenths));
    // G110 to G129 are G54 and so on of Haas.
    let haas_systems = (1100.0..=1290.0).contains(&tenths).then_some(1540.0);
    row.map(|&(_, what, hint)| (what, hint))
        .or_else(|| what(haas_systems?))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::text::codes::find;

    #[test]
    fn no_code_is_both_read_and_foreign() {
        for code in CODES.iter().flat_map(|(codes, ..)| *codes) {
            assert!(find(*code).is_none(), "{code}");
        }
        assert_eq!(what(1110.0), what(1540.0));
        assert_eq!(what(685.0), None);
    }
}
