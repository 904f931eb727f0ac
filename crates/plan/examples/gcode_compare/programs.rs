//! Random programs in LinuxCNC's language: most are valid, some have a slip of the pen.
//!
//! Arcs, cycles and curves fit at any position of the program: their coordinates are distances.

use std::f64::consts::{PI, TAU};

use rand::{RngExt, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;

/// One program in this many has a slip.
const SLIPS: u32 = 8;
/// Tokens of a slip: words in the wrong place.
const SLIP_WORDS: [&str; 16] = [
    "G1", "G2", "G17", "G40", "X1", "R5", "I2", "K1", "P2", "L3", "M3", "M4", "D2", "(open",
    "o9 endif", "#<none>",
];

/// Writes one program.
struct Writer {
    rng: Xoshiro256PlusPlus,
    text: String,
    /// Index of the active plane.
    plane: usize,
    incremental: bool,
    labels: u32,
}

const PLANES: [(&str, [char; 3], [char; 2]); 3] = [
    ("G17", ['X', 'Y', 'Z'], ['I', 'J']),
    ("G18", ['Z', 'X', 'Y'], ['K', 'I']),
    ("G19", ['Y', 'Z', 'X'], ['J', 'K']),
];

/// Returns the program with this number.
pub(crate) fn program(number: u64) -> String {
    let mut writer = Writer {
        rng: Xoshiro256PlusPlus::seed_from_u64(number),
        text: String::new(),
        plane: 0,
        incremental: false,
        labels: 100,
    };
    writer.line("G21 G17 G90 G40 G49 G80 G94 F600 S500 M3".to_owned());
    match writer.below(8) {
        0 | 1 => writer.compensation(),
        2 => writer.turning(),
        _ => {
            for _ in 0..writer.rng.random_range(4..25) {
                writer.piece();
            }
        }
    }
    let end = writer.pick(&["M2", "M30"]).to_owned();
    writer.line(end);
    if writer.below(6) == 0 && writer.text.contains("G90") {
        writer.numbered_subroutine();
    }
    let slips = writer.below(SLIPS) == 0;
    if slips { writer.slip() } else { writer.text }
}

impl Writer {
    fn below(&mut self, limit: u32) -> u32 {
        self.rng.random_range(0..limit)
    }

    fn pick<T: Copy>(&mut self, from: &[T]) -> T {
        from[self.rng.random_range(0..from.len())]
    }

    /// Returns a number with up to four decimals.
    fn number(&mut self, low: f64, high: f64) -> f64 {
        let decimals = self.pick(&[1.0, 10.0, 1000.0, 10000.0]);
        (self.rng.random_range(low..high) * decimals).round() / decimals
    }

    fn line(&mut self, line: String) {
        if self.below(40) == 0 {
            self.text += &format!("N{} ", self.labels);
        }
        self.text += &line;
        self.text += "\n";
    }

    fn axes(&mut self, of: &str, reach: f64) -> String {
        let mut words = String::new();
        for axis in of.chars() {
            if self.below(3) > 0 {
                words += &format!(" {axis}{}", self.number(-reach, reach));
            }
        }
        if words.is_empty() {
            format!(" X{}", self.number(-reach, reach))
        } else {
            words
        }
    }

    fn slip(mut self) -> String {
        let mut lines: Vec<String> = self.text.lines().map(str::to_owned).collect();
        let at = self.rng.random_range(1..lines.len());
        match self.below(3) {
            0 => drop(lines.remove(at)),
            1 => lines[at] += &format!(" {}", self.pick(&SLIP_WORDS)),
            _ => {
                let words: Vec<&str> = lines[at].split(' ').collect();
                let left_out = self.rng.random_range(0..words.len());
                let kept = words
                    .iter()
                    .enumerate()
                    .filter(|(number, _)| *number != left_out)
                    .map(|(_, word)| *word);
                lines[at] = kept.collect::<Vec<_>>().join(" ");
            }
        }
        lines.join("\n") + "\n"
    }

    fn piece(&mut self) {
        match self.below(26) {
            0..=4 => self.straight(),
            5..=7 => self.arc(),
            8 | 9 => self.offsets(),
            10 | 11 => self.home(),
            12..=14 => self.modes(),
            15 | 16 => self.cycle(),
            17 => self.curve(),
            18 => self.threads_and_probes(),
            19 | 20 => self.flow(),
            21 => self.expression(),
            22 | 23 => self.machine(),
            24 => self.polar(),
            _ => self.feed_modes(),
        }
    }

    fn straight(&mut self) {
        let code = self.pick(&["G0", "G1", "G00", "g01", "G53 G0", "G1"]);
        if code == "G53 G0" && self.incremental {
            self.distance(false);
        }
        let of = self.pick(&["XYZ", "XY", "Z", "XYZAC", "XYUVW", "B"]);
        let words = self.axes(of, 40.0);
        self.line(format!("{code}{words}"));
    }

    fn distance(&mut self, incremental: bool) {
        self.incremental = incremental;
        self.line(if incremental { "G91" } else { "G90" }.to_owned());
    }

    fn choose_plane(&mut self, plane: usize) {
        if self.plane != plane {
            self.plane = plane;
            self.line(PLANES[plane].0.to_owned());
        }
    }

    /// Appends an arc that fits anywhere: its words are distances.
    fn arc(&mut self) {
        let plane = self.rng.random_range(0..3);
        self.choose_plane(plane);
        let (_, [first, second, normal], [i, j]) = PLANES[plane];
        let was = self.incremental;
        self.distance(true);
        let radius = self.number(0.5, 20.0).max(0.5);
        let (from, to) = (
            self.rng.random_range(0.0..TAU),
            self.rng.random_range(0.0..TAU),
        );
        let chord = [
            radius * (to.cos() - from.cos()),
            radius * (to.sin() - from.sin()),
        ];
        let code = self.pick(&["G2", "G3"]);
        let mut line = format!("{code} {first}{:.4} {second}{:.4}", chord[0], chord[1]);
        match self.below(5) {
            0 => {
                line += &format!(
                    " R{}{:.4}",
                    self.pick(&["", "-"]),
                    radius + self.pick(&[0.0, 0.0005, 3.0])
                );
            }
            1 => line = format!("{code} {i}{:.3} {j}0", -radius),
            _ => {
                line += &format!(
                    " {i}{:.4} {j}{:.4}",
                    -radius * from.cos(),
                    -radius * from.sin()
                );
            }
        }
        if self.below(3) == 0 {
            line += &format!(" {normal}{}", self.number(-5.0, 5.0));
        }
        if self.below(5) == 0 && !line.contains('R') {
            line += &format!(" P{}", 1 + self.below(3));
        }
        self.line(line);
        if !was {
            self.distance(false);
        }
    }

    fn offsets(&mut self) {
        let words = self.axes("XYZ", 15.0);
        let line = match self.below(12) {
            0 | 1 => format!("G10 L2 P{}{words}", self.below(10)),
            2 => format!("G10 L2 P{} R{}", self.below(3), self.number(-60.0, 60.0)),
            3 => format!("G10 L20 P{}{words}", self.below(10)),
            4 => self
                .pick(&[
                    "G54", "G55", "G56", "G57", "G58", "G59", "G59.1", "G59.2", "G59.3",
                ])
                .to_owned(),
            5 => self.pick(&["G92.1", "G92.2", "G92.3"]).to_owned(),
            6 => format!("G52{words}"),
            7 => format!("G43.1{words}"),
            8 => format!("G43.2 H{}", 1 + self.below(9)),
            9 => "G49".to_owned(),
            _ => format!("G92{words}"),
        };
        self.line(line);
    }

    fn home(&mut self) {
        let words = self.axes("XYZ", 10.0);
        let line = match self.below(6) {
            0 => "G28.1".to_owned(),
            1 => "G30.1".to_owned(),
            2 => "G28".to_owned(),
            3 => "G30".to_owned(),
            4 => format!("G28{words}"),
            _ => format!("G30{words}"),
        };
        self.line(line);
    }

    fn modes(&mut self) {
        match self.below(12) {
            0 | 1 => self.distance(true),
            2 | 3 => self.distance(false),
            4 => self.line("G20".to_owned()),
            5 => self.line("G21".to_owned()),
            6 => {
                let line = self
                    .pick(&["G61", "G61.1", "G64", "G64 P0.01", "G64 P0.02 Q0.01"])
                    .to_owned();
                self.line(line);
            }
            7 => {
                let line = self.pick(&["G98", "G99", "G7", "G8", "G80"]).to_owned();
                self.line(line);
            }
            8 => {
                let line = format!("G4 P{}", self.number(0.0, 2.0));
                self.line(line);
            }
            9 => {
                let line = self
                    .pick(&["G96 S100 D2000", "G96 S60", "G97 S300", "G97 S300"])
                    .to_owned();
                self.line(line);
            }
            10 => {
                let plane = self.rng.random_range(0..3);
                self.choose_plane(plane);
            }
            _ => self.absolute_arc(),
        }
    }

    /// Appends an arc with G90.1, from a point to which the program has just moved.
    fn absolute_arc(&mut self) {
        self.choose_plane(0);
        self.distance(false);
        let [x, y] = [self.number(-20.0, 20.0), self.number(-20.0, 20.0)];
        let [i, j] = [self.number(-20.0, 20.0), self.number(-20.0, 20.0)];
        self.line(format!("G0 X{x} Y{y}"));
        let code = self.pick(&["G2", "G3"]);
        self.line(format!(
            "G90.1 {code} X{:.4} Y{:.4} I{i} J{j}",
            2.0 * i - x,
            2.0 * j - y
        ));
        self.line("G91.1".to_owned());
    }

    fn feed_modes(&mut self) {
        let words = self.axes("XYZ", 20.0);
        match self.below(3) {
            0 => self.line(format!("G93 G1{words} F2")),
            1 => self.line(format!("G95 G1{words} F0.2")),
            _ => {
                let feed = self.number(1.0, 900.0).max(1.0);
                self.line(format!("G1{words} F{feed}"));
            }
        }
        self.line("G94 F500".to_owned());
    }

    fn machine(&mut self) {
        let line = match self.below(12) {
            0 => "M5\nM4 S200".to_owned(),
            1 => "M3 S900".to_owned(),
            2 => "M7\nM8\nM9".to_owned(),
            3 => "M48".to_owned(),
            4 => "M49".to_owned(),
            5 => format!("M5{} P{}", self.below(4), self.below(2)),
            6 => self
                .pick(&[
                    "M62 P1",
                    "M63 P1",
                    "M64 P2",
                    "M65 P2",
                    "M67 E1 Q2.5",
                    "M68 E1 Q0.5",
                ])
                .to_owned(),
            7 => "M70\nG91 G20 F7\nM72".to_owned(),
            8 => "M70\nM71".to_owned(),
            9 => format!("M70\nG92 X{}\nM72", self.number(-9.0, 9.0)),
            10 => self
                .pick(&[
                    "M0",
                    "M1",
                    "M60",
                    "M66 P0 L0",
                    "M19 R90",
                    "M61 Q3",
                    "(msg, hello)",
                ])
                .to_owned(),
            _ => "M73".to_owned(),
        };
        if line.contains("G91") {
            self.incremental = false;
            self.line("G90".to_owned());
        }
        self.line(line);
    }

    fn polar(&mut self) {
        self.choose_plane(0);
        self.distance(false);
        let (radius, angle) = (self.number(1.0, 30.0).max(1.0), self.number(-180.0, 180.0));
        let line = match self.below(3) {
            0 => format!("G1 @{radius} ^{angle}"),
            1 => format!("G0 X9 Y1\nG1 ^{angle}"),
            _ => format!("G0 X9 Y1\nG1 @{radius}"),
        };
        self.line(line);
    }

    fn cycle(&mut self) {
        let plane = if self.below(4) == 0 {
            self.rng.random_range(0..3)
        } else {
            0
        };
        let code = self.pick(&[
            "G81", "G82", "G83", "G73", "G84", "G74", "G85", "G86", "G88", "G89", "G87",
        ]);
        // G88 leaves the height to the operator, so nothing after it could be compared. In other
        // planes LinuxCNC 2.9 swaps the axes of tapping.
        self.choose_plane(if code == "G84" || code == "G74" {
            0
        } else {
            plane
        });
        let (_, [first, second, normal], _) = PLANES[self.plane];
        let (bottom, above) = (self.number(-12.0, -2.0), self.number(0.0, 6.0));
        let mut words = match code {
            "G82" | "G86" | "G88" | "G89" => " P0.1".to_owned(),
            "G84" | "G74" => " P0".to_owned(),
            "G83" | "G73" => format!(" Q{}", self.number(0.7, 4.0).max(0.7)),
            "G87" => " I1 J0.5 K-1".to_owned(),
            _ => String::new(),
        };
        // LinuxCNC rejects L with G74.
        if self.below(4) == 0 && code != "G74" {
            words += &format!(" L{}", 1 + self.below(3));
        }
        self.line(if code == "G74" { "M4" } else { "M3" }.to_owned());
        if !self.incremental {
            let high = self.number(-1.0, 20.0);
            self.line(format!("G0 {normal}{high}"));
        }
        let back = self.pick(&["G98", "G99"]);
        let at = [self.number(-20.0, 20.0), self.number(-20.0, 20.0)];
        self.line(format!(
            "{back} {code} {first}{} {second}{} {normal}{bottom} R{above}{words}",
            at[0], at[1]
        ));
        for _ in 0..self.below(3) {
            if code != "G87" {
                let axis = self.pick(&[first, second]);
                let to = self.number(-20.0, 20.0);
                self.line(format!("{axis}{to}"));
            }
        }
        self.line("G80".to_owned());
    }

    fn curve(&mut self) {
        self.choose_plane(0);
        let was = self.incremental;
        self.distance(true);
        // LinuxCNC's preview module keeps Z only of straight motions.
        self.line("G1 Z0.5".to_owned());
        let mut three = || [(); 4].map(|()| self.rng.random_range(1.0..9.0_f64));
        let ([a, b, c, d], [e, f, g, h]) = (three(), three());
        match self.below(3) {
            0 => self.line(format!("G5 X{a:.3} Y{b:.3} I{c:.3} J{d:.3} P-{e:.3} Q{f:.3}\nG5 X{g:.3} Y{h:.3} P-1 Q-2")),
            1 => self.line(format!("G5.1 X{a:.3} Y-{b:.3} I{c:.3} J{d:.3}")),
            _ => self.line(format!(
                "G5.2 X{a:.3} Y{b:.3} P1 L3\nX{c:.3} Y-{d:.3} P{:.2}\nX{e:.3} Y{f:.3} P1\nX{g:.3} Y{h:.3} P2\nG5.3",
                0.1 * a + 0.3
            )),
        }
        if !was {
            self.distance(false);
        }
    }

    fn threads_and_probes(&mut self) {
        let z = self.number(1.0, 9.0).max(1.0);
        self.distance(true);
        let line = match self.below(4) {
            0 => format!("G33 Z-{z} K1.5"),
            1 => format!("G33.1 Z-{z} K0.5"),
            2 => format!("G38.{} Z-{z}", 2 + self.below(4)),
            _ => format!("G33 X2 Z{z} K2"),
        };
        self.line(line);
        self.distance(false);
    }

    fn expression(&mut self) {
        let value = |writer: &mut Self| writer.number(0.1, 0.9).max(0.1);
        let (a, b) = (value(self), value(self));
        let function = self.pick(&[
            "sin", "cos", "tan", "abs", "asin", "acos", "exp", "fix", "fup", "ln", "round", "sqrt",
        ]);
        let operator = self.pick(&[
            "+", "-", "*", "/", "**", "mod", "eq", "ne", "gt", "ge", "lt", "le", "and", "or", "xor",
        ]);
        let index = 1 + self.below(29);
        self.line(format!(
            "#{index} = [{function}[{a}] {operator} {b}] #<value> = [#{index} + 1]"
        ));
        self.line(format!(
            "#{index} = [#{index} * 2 - #<value> / 3 + atan[{a}]/[-{b}] / 90 + exists[#<value>]]"
        ));
        self.line(format!("G1 X#{index} Y[#<value> * 2] Z-[#{index} / 2]"));
    }

    fn flow(&mut self) {
        self.labels += 1;
        let label = self.labels;
        let step = self.number(-3.0, 3.0);
        let (was, condition) = (
            self.incremental,
            self.pick(&["1", "0", "#5 gt 3", "#5420 lt 5"]),
        );
        let rounds = self.number(0.0, 4.0);
        self.distance(true);
        match self.below(5) {
            0 => self.line(format!(
                "o{label} if [{condition}]\nG1 X{step}\no{label} elseif [#1 gt 0]\nG1 Y{step}\no{label} else\nG1 Z{step}\no{label} endif"
            )),
            1 => self.line(format!("o{label} repeat [{rounds}]\nG1 X{step} Y1\no{label} endrepeat")),
            2 => self.line(format!(
                "#7 = 0\no{label} while [#7 lt 3]\n#7 = [#7 + 1]\no{0} if [#7 eq 2]\no{label} continue\no{0} endif\nG1 X#7\no{label} endwhile",
                label + 5000
            )),
            3 => self.line(format!(
                "#8 = 0\no{label} do\n#8 = [#8 + 1]\nG1 Y#8\no{0} if [#8 gt 2]\no{label} break\no{0} endif\no{label} while [#8 lt 5]",
                label + 5000
            )),
            _ => self.line(format!(
                "o{label} sub\nG1 X#1 Y#2\no{0} if [#1 lt 1]\no{label} return [#1 + 1]\no{0} endif\nG0 Z1\no{label} endsub [5]\n\
                 o{label} call [{step}] [2]\nG1 X#<_value>",
                label + 5000
            )),
        }
        if !was {
            self.distance(false);
        }
    }

    /// Appends a contour with cutter compensation: lines and arcs, corners of all kinds, many of
    /// them flat.
    fn compensation(&mut self) {
        let radius = self.pick(&[0.5, 2.0, 5.0, 10.0]);
        let side = self.pick(&[1.0, -1.0]);
        let code = if side > 0.0 { "G41.1" } else { "G42.1" };
        let (mut at, mut heading) = ([0.0, 0.0], 0.0_f64);
        let beside = self.number(-30.0, 30.0);
        self.line(format!("G0 X-40 Y{beside}"));
        if self.below(6) == 0 {
            // The diameter comes from the tool table, in which all tools have an eighth of an inch.
            self.line(format!("T3 M6\nG43 H3\n{} D2 G1 X0 Y0", &code[..3]));
        } else {
            self.line(format!("{code} D{} G1 X0 Y0", 2.0 * radius));
        }
        for _ in 0..self.rng.random_range(2..9) {
            heading += match self.below(5) {
                0 | 1 => self.rng.random_range(-0.05..0.05),
                2 => 0.0,
                _ => self.rng.random_range(-2.0..2.0),
            };
            let length = self.rng.random_range(4.0..40.0);
            if self.below(3) > 0 {
                at = [
                    at[0] + length * heading.cos(),
                    at[1] + length * heading.sin(),
                ];
                let word = if self.below(9) == 0 { " Z-1" } else { "" };
                self.line(format!("G1 X{:.4} Y{:.4}{word}", at[0], at[1]));
                continue;
            }
            let bend: f64 = self.rng.random_range(0.3..2.0) * self.pick(&[1.0, -1.0]);
            let (arc_radius, quarter) = (length / bend.abs(), 0.5 * PI * bend.signum());
            let center = [
                at[0] + arc_radius * (heading + quarter).cos(),
                at[1] + arc_radius * (heading + quarter).sin(),
            ];
            let [i, j] = [center[0] - at[0], center[1] - at[1]];
            heading += bend;
            at = [
                center[0] + arc_radius * (heading - quarter).cos(),
                center[1] + arc_radius * (heading - quarter).sin(),
            ];
            let code = if bend > 0.0 { "G3" } else { "G2" };
            self.line(format!(
                "{code} X{:.4} Y{:.4} I{i:.4} J{j:.4}",
                at[0], at[1]
            ));
        }
        if self.below(8) == 0 {
            self.line("G0 Z5".to_owned());
        }
        self.line(format!(
            "G40 G1 X{:.4} Y{:.4}",
            at[0] + 40.0 * (heading + side).cos(),
            at[1] + 40.0 * (heading + side).sin()
        ));
    }

    /// Appends a subroutine in Fanuc style, called in the first line after the modes.
    fn numbered_subroutine(&mut self) {
        let (times, step) = (1 + self.below(3), self.number(-3.0, 3.0));
        let called = format!("M98 P9000 L{times}\n");
        let first = self.text.find('\n').map_or(0, |end| end + 1);
        self.text.insert_str(first, &called);
        self.line(format!("O9000\nG1 X{step} Y2\nG0 Z1\nM99"));
    }

    /// Appends threads and roughing cycles of a lathe.
    fn turning(&mut self) {
        self.line("G18 G8".to_owned());
        self.plane = 1;
        match self.below(3) {
            0 => {
                let taper =
                    self.pick(&["", " E1 L1", " E1 L2", " E1.5 L3", " H2", " Q29.5", " R2"]);
                let (inward, depth) = (self.pick(&["", "-"]), self.number(0.2, 0.6).max(0.2));
                let end = self.number(8.0, 20.0);
                self.line(format!(
                    "G0 X20 Z5\nG76 P1.5 Z-{end} I{inward}2 J{depth} K1.2{taper}"
                ));
            }
            1 => {
                let deep = self.number(0.5, 3.0).max(0.5);
                self.line(
                    "o1 sub\nG0 X10\nG1 Z-5\nX14 Z-9\nZ-14\nX20 Z-18\nX32\no1 endsub".to_owned(),
                );
                let line = self.pick(&["G71 Q1 X32 Z2", "G71.1 Q1 X32 Z2", "G71.2 Q1 X32 Z2"]);
                self.line(format!(
                    "G0 X40 Z5\n{line} D0.3 I{deep} R0.5\nG70 Q1 X32 Z2"
                ));
            }
            _ => {
                let deep = self.number(0.5, 3.0).max(0.5);
                self.line(
                    "o1 sub\nG0 Z-12\nG1 X20\nZ-8 X16\nX10 Z-4\nX4\nZ1\no1 endsub".to_owned(),
                );
                let line = self.pick(&["G72 Q1 X32 Z2", "G72.1 Q1 X32 Z2", "G72.2 Q1 X32 Z2"]);
                self.line(format!("G0 X40 Z5\n{line} D0.2 I{deep} R0.5"));
            }
        }
    }
}
