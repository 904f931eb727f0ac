//! A rectangular pocket with rounded corners, as a CAM system would cut it: helix entries, contour-parallel passes at
//! several depths, a raster over the floor and a finishing pass along the wall.

use std::fmt::Write;

use crate::word;

/// Half length and half width of the pocket, mm.
const HALF_MM: [f64; 2] = [40.0, 25.0];
/// Radius of the pocket's corners, mm.
const CORNER_MM: f64 = 8.0;
/// Floor of the pocket, mm.
const DEPTH_MM: f64 = 6.0;
/// Depth of a roughing level, mm: 1.5 mm in aluminium is a plain cut for a 10 mm end mill.
const LEVEL_MM: f64 = 1.5;
const CUTTER_RADIUS_MM: f64 = 5.0;
/// Distance of neighbouring passes: 40 % of the cutter's diameter.
const STEPOVER_MM: f64 = 4.0;
/// Left on wall and floor for finishing, mm.
const WALL_STOCK_MM: f64 = 0.3;
const FLOOR_STOCK_MM: f64 = 0.2;
/// Helix of the entries: radius, and descent per turn (2.3 degrees), mm.
const HELIX_MM: [f64; 2] = [2.0, 0.5];
/// Heights above the part for rapids across it and for the start of an entry, mm.
const CLEAR_MM: f64 = 5.0;
const NEAR_MM: f64 = 0.5;

/// Feeds, mm/min: roughing, entry, finishing.
const ROUGH: u32 = 1800;
const ENTRY: u32 = 600;
const FINISH: u32 = 1200;

/// The program.
pub(crate) fn program() -> String {
    let mut program = Program { text: String::new(), number: 10 };
    program.head();
    program.rough();
    program.floor();
    program.wall();
    program.tail();
    program.text
}

struct Program {
    text: String,
    number: u32,
}

impl Program {
    fn head(&mut self) {
        self.comment(
            "Pocket 80 x 50 x 6 mm with corners of R = 8 mm, aluminium; origin: centre of the pocket, top of the part",
        );
        self.comment("T1: end mill of 10 mm, 3 flutes, 8000 rev/min");
        self.comment("4 roughing levels of 1.5 mm with helix entries, floor raster, wall finish; 0.3 mm stock on the wall, 0.2 mm on the floor");
        self.block("G21 G17 G90 G94 G64 P0.01");
        self.block("T1 M6");
        self.block("S8000 M3");
        self.block("M8");
        self.block("G4 P1.5");
        self.block(&format!("G0 {}", word('Z', CLEAR_MM)));
    }

    /// Levels from the top down; on each, passes from the inside out.
    fn rough(&mut self) {
        let rough_depth_mm = DEPTH_MM - FLOOR_STOCK_MM;
        let levels = (rough_depth_mm / LEVEL_MM).ceil() as u32;
        for level in 1..=levels {
            let z = (-LEVEL_MM * f64::from(level)).max(-rough_depth_mm);
            self.comment(&format!("roughing level {level} of {levels}, {}", word('Z', z)));
            let above = if level == 1 { 0.0 } else { -LEVEL_MM * f64::from(level - 1) };
            self.entry(above + NEAR_MM, z);
            let wall = CUTTER_RADIUS_MM + WALL_STOCK_MM;
            let passes = ((HALF_MM[1] - wall - HELIX_MM[0]) / STEPOVER_MM).ceil() as u32;
            for pass in (0..=passes).rev() {
                let half = HALF_MM.map(|half| half - wall - STEPOVER_MM * f64::from(pass));
                // The innermost pass is not thinner than its corners.
                if half[1] >= HELIX_MM[0] {
                    self.contour(half, (CORNER_MM - wall).min(half[1]), ROUGH);
                }
            }
            self.block(&format!("G0 {}", word('Z', CLEAR_MM)));
        }
    }

    /// Helix down to `z` about the origin, and one flat turn.
    fn entry(&mut self, from_z: f64, z: f64) {
        let [radius, descent] = HELIX_MM;
        self.block(&format!("G0 {} Y0", word('X', radius)));
        self.block(&format!("G0 {}", word('Z', from_z)));
        let turns = ((from_z - z) / descent).ceil();
        for turn in 1..=turns as u32 {
            let height = from_z + (z - from_z) * f64::from(turn) / turns;
            self.block(&format!(
                "G3 {} Y0 {} {} J0 F{ENTRY}",
                word('X', radius),
                word('Z', height),
                word('I', -radius)
            ));
        }
        self.block(&format!("G3 {} Y0 {} J0 F{ROUGH}", word('X', radius), word('I', -radius)));
    }

    /// A closed rectangle with rounded corners, counter-clockwise (climb milling) from the middle of its lower side.
    fn contour(&mut self, half: [f64; 2], corner: f64, feed: u32) {
        let [x, y] = half;
        let straight = [x - corner, y - corner];
        self.block(&format!("G1 X0 {} F{feed}", word('Y', -y)));
        // Of each corner: where its arc starts, where it ends, its centre from the start.
        let corners = [
            ([straight[0], -y], [x, -straight[1]], [0.0, corner]),
            ([x, straight[1]], [straight[0], y], [-corner, 0.0]),
            ([-straight[0], y], [-x, straight[1]], [0.0, -corner]),
            ([-x, -straight[1]], [-straight[0], -y], [corner, 0.0]),
        ];
        for (start, end, center) in corners {
            self.block(&format!("G1 {} {}", word('X', start[0]), word('Y', start[1])));
            let (end, center) = ([word('X', end[0]), word('Y', end[1])], [word('I', center[0]), word('J', center[1])]);
            self.block(&format!("G3 {} {} {} {}", end[0], end[1], center[0], center[1]));
        }
        self.block(&format!("G1 X0 {}", word('Y', -y)));
    }

    /// Rows along X with half-circle turns, entered by a ramp along the first row.
    fn floor(&mut self) {
        self.comment("floor raster");
        let wall = CUTTER_RADIUS_MM + WALL_STOCK_MM;
        let height = 2.0 * (HALF_MM[1] - wall);
        let rows = (height / STEPOVER_MM).ceil();
        let step = height / rows;
        // The turns stay within the stock of the wall.
        let reach = HALF_MM[0] - wall - step / 2.0;
        let y = |row: f64| -height / 2.0 + row * step;
        self.block(&format!("G0 {} {}", word('X', -reach), word('Y', y(0.0))));
        self.block(&format!("G0 {}", word('Z', NEAR_MM - DEPTH_MM + FLOOR_STOCK_MM)));
        self.block(&format!("G1 {} {} F{ENTRY}", word('X', reach), word('Z', -DEPTH_MM)));
        self.block(&format!("G1 {} F{ROUGH}", word('X', -reach)));
        let mut side = -1.0;
        for row in 1..=rows as u32 {
            let turn = if side < 0.0 { "G2" } else { "G3" };
            self.block(&format!(
                "{turn} {} {} I0 {}",
                word('X', side * reach),
                word('Y', y(f64::from(row))),
                word('J', step / 2.0)
            ));
            side = -side;
            self.block(&format!("G1 {}", word('X', side * reach)));
        }
        self.block(&format!("G0 {}", word('Z', CLEAR_MM)));
    }

    /// Along the finished wall at full depth, on and off by quarter turns.
    fn wall(&mut self) {
        self.comment("wall finish");
        let half = HALF_MM.map(|half| half - CUTTER_RADIUS_MM);
        let lead = 4.0;
        self.block(&format!("G0 {} {}", word('X', -lead), word('Y', lead - half[1])));
        self.block(&format!("G0 {}", word('Z', NEAR_MM - DEPTH_MM)));
        self.block(&format!("G1 {} F{ENTRY}", word('Z', -DEPTH_MM)));
        self.block(&format!("G3 X0 {} {} J0 F{FINISH}", word('Y', -half[1]), word('I', lead)));
        let before = self.text.len();
        self.contour(half, CORNER_MM - CUTTER_RADIUS_MM, FINISH);
        // The lead-in has reached the contour's first point already.
        let first_block_end = self.text[before..].find('\n').map_or(before, |newline| before + newline + 1);
        self.text.replace_range(before..first_block_end, "");
        self.block(&format!("G3 {} {} I0 {}", word('X', lead), word('Y', lead - half[1]), word('J', lead)));
        self.block(&format!("G0 {}", word('Z', CLEAR_MM)));
    }

    fn tail(&mut self) {
        self.block("M9");
        self.block("M5");
        self.block("G0 Z50");
        self.block("M30");
    }

    fn comment(&mut self, text: &str) {
        writeln!(self.text, "({text})").expect("a string takes all that is written");
    }

    fn block(&mut self, words: &str) {
        writeln!(self.text, "N{} {words}", self.number).expect("a string takes all that is written");
        self.number += 5;
    }
}
