//! Random programs of control flow: nested loops with `break` and `continue`, subroutines with
//! arguments, and cycles, polar words and cutter compensation inside them. Lines are written in all
//! the ways that the language allows.
//!
//! The grammar is independent of `programs.rs`, so that each covers what the other never writes.

use rand::{RngExt, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;

/// Largest depth of nested blocks, and range of the number of statements of a program.
const MOST_DEPTH: u32 = 4;
const STATEMENTS: [u32; 2] = [3, 12];
/// Largest number of subroutines of a program.
const MOST_ROUTINES: u32 = 3;
/// First number of the variables that any statement may assign, and the number before the first
/// loop counter. Nothing else changes a loop counter.
const FREE: u32 = 41;
const COUNTERS: u32 = 100;
/// First axis, second axis, normal, and letters of the center, for each plane.
const PLANE_LETTERS: [(&str, [char; 5]); 3] = [
    ("G17", ['X', 'Y', 'Z', 'I', 'J']),
    ("G18", ['Z', 'X', 'Y', 'K', 'I']),
    ("G19", ['Y', 'Z', 'X', 'J', 'K']),
];
/// Numbers of rounds of a repeat loop, also as expressions.
const TIMES: [&str; 6] = ["2", "3", "1", "0", "1+1", "#5420*0+2"];

/// Block that encloses a statement.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Enclosure {
    /// A while or do loop, by its label: the target of break and continue.
    Loop(u32),
    Repeat,
    Routine(u32),
}

/// Statements that the loops of a program may contain. LinuxCNC 2.9 confuses a do loop with loops
/// that were left earlier, so only few programs have both.
#[derive(Clone, Copy, PartialEq, Eq)]
enum LoopUses {
    Leaving,
    Do,
    Both,
}

/// Writes one program.
struct NestedWriter {
    rng: Xoshiro256PlusPlus,
    text: String,
    labels: u32,
    counters: u32,
    routines: Vec<(u32, u32)>,
    uses: LoopUses,
    /// True if the program rotates the active coordinate system. It then does not shift it:
    /// LinuxCNC 2.9 confuses the two.
    turns: bool,
    around: Vec<Enclosure>,
}

/// Returns the program with this number.
pub(crate) fn nested(number: u64) -> String {
    let mut rng = Xoshiro256PlusPlus::seed_from_u64(number ^ 0x6E65_7374_6564);
    let uses = match rng.random_range(0..16) {
        0 => LoopUses::Both,
        1..=6 => LoopUses::Do,
        _ => LoopUses::Leaving,
    };
    let mut writer = NestedWriter {
        rng,
        text: "G21 G17 G90 G40 G49 G80 G94 G98 F700 S400 M3\n".to_owned(),
        labels: 100,
        counters: COUNTERS,
        routines: Vec::new(),
        uses,
        turns: number.is_multiple_of(2),
        around: Vec::new(),
    };
    for _ in 0..writer.below(MOST_ROUTINES + 1) {
        writer.routine();
    }
    for _ in 0..writer.rng.random_range(STATEMENTS[0]..STATEMENTS[1]) {
        writer.statement(0);
    }
    writer.text += "M2\n";
    writer.text
}

impl NestedWriter {
    fn below(&mut self, limit: u32) -> u32 {
        self.rng.random_range(0..limit)
    }

    fn pick<T: Copy>(&mut self, from: &[T]) -> T {
        from[self.rng.random_range(0..from.len())]
    }

    fn label(&mut self) -> u32 {
        self.labels += 1;
        self.labels
    }

    fn counter(&mut self) -> String {
        self.counters += 1;
        if self.below(2) == 0 {
            format!("#{}", self.counters)
        } else {
            format!("#<_n{}>", self.counters)
        }
    }

    /// Appends a line, in capitals or not, with or without spaces between the words.
    fn line(&mut self, words: &str) {
        let words = match self.below(6) {
            0 => words.to_ascii_lowercase(),
            1 => words.replace(' ', ""),
            2 => words.replace(' ', "\t "),
            _ => words.to_owned(),
        };
        let number = if self.below(12) == 0 {
            format!("N{} ", self.below(9999))
        } else {
            String::new()
        };
        let comment = self.pick(&["", "", "", "", "", " (a comment)", " ; behind"]);
        self.text += &format!("{number}{words}{comment}\n");
    }

    /// Appends a line with an O-word.
    fn flow(&mut self, label: u32, rest: &str) {
        let letter = self.pick(&["o", "O"]);
        self.text += &format!("{letter}{label} {rest}\n");
    }

    /// Returns a number in one of its spellings.
    fn spelled(&mut self, value: f64) -> String {
        let value = (value * 1000.0).round() / 1000.0;
        match self.below(7) {
            0 if value > 0.0 => format!("+{value}"),
            1 if value.fract() == 0.0 => format!("{value}."),
            2 => format!("{value:.4}"),
            3 => format!("[{value}]"),
            4 => format!("[{} + {}]", value - 1.0, 1.0),
            5 if value.abs() < 1.0 => format!("{value}").replace("0.", "."),
            _ => format!("{value}"),
        }
    }

    fn coordinate(&mut self) -> String {
        let value = self.rng.random_range(-12.0..12.0);
        if self.below(7) == 0 && self.counters > COUNTERS {
            let counter = COUNTERS + 1 + self.below(self.counters - COUNTERS);
            return format!("[#{counter} + {}]", (value * 10.0_f64).round() / 10.0);
        }
        self.spelled(value)
    }

    fn statement(&mut self, depth: u32) {
        let blocks = if depth < MOST_DEPTH { 6 } else { 0 };
        match self.below(11 + blocks) {
            0..=2 => self.straight(),
            3 => self.arc(),
            4 => self.polar(),
            5 => self.cycle(),
            6 => self.assignment(),
            7 => self.call(),
            8 => self.leave(),
            9 => self.modes(),
            10 => {
                if depth == 0 {
                    self.compensation();
                }
            }
            11 | 12 => self.condition(depth),
            13 => self.while_loop(depth),
            14 if self.uses == LoopUses::Leaving => self.while_loop(depth),
            14 => self.do_loop(depth),
            15 => self.repeat(depth),
            _ => self.while_loop(depth),
        }
    }

    fn block(&mut self, depth: u32, within: Option<Enclosure>) {
        self.around.extend(within);
        for _ in 0..1 + self.below(3) {
            self.statement(depth + 1);
        }
        if within.is_some() {
            self.around.pop();
        }
    }

    fn condition(&mut self, depth: u32) {
        let label = self.label();
        let condition = self.truth();
        self.flow(label, &format!("if [{condition}]"));
        self.block(depth, None);
        if self.below(3) == 0 {
            let condition = self.truth();
            self.flow(label, &format!("elseif [{condition}]"));
            self.block(depth, None);
        }
        if self.below(2) == 0 {
            self.flow(label, "else");
            self.block(depth, None);
        }
        self.flow(label, "endif");
    }

    fn truth(&mut self) -> String {
        let first = self.pick(&[FREE, COUNTERS + 1]);
        let number = first + self.below(5);
        let limit = self.below(4);
        let relation = self.pick(&["gt", "LT", "ge", "le", "eq", "NE"]);
        match self.below(4) {
            0 => format!("[#{number} mod 2] eq 0"),
            1 => format!("#{number} {relation} {limit} and 1"),
            _ => format!("#{number} {relation} {limit}"),
        }
    }

    fn while_loop(&mut self, depth: u32) {
        let (label, counter, most) = (self.label(), self.counter(), 1 + self.below(4));
        self.line(&format!("{counter} = 0"));
        self.flow(label, &format!("while [{counter} lt {most}]"));
        self.line(&format!("{counter} = [{counter} + 1]"));
        self.block(depth, Some(Enclosure::Loop(label)));
        self.flow(label, "endwhile");
    }

    fn do_loop(&mut self, depth: u32) {
        let (label, counter, most) = (self.label(), self.counter(), 1 + self.below(4));
        self.line(&format!("{counter} = 0"));
        self.flow(label, "do");
        self.line(&format!("{counter} = [{counter} + 1]"));
        self.block(depth, Some(Enclosure::Loop(label)));
        self.flow(label, &format!("while [{counter} lt {most}]"));
    }

    fn repeat(&mut self, depth: u32) {
        let (label, times) = (self.label(), self.pick(&TIMES));
        self.flow(label, &format!("repeat [{times}]"));
        self.block(depth, Some(Enclosure::Repeat));
        self.flow(label, "endrepeat");
    }

    /// Appends a break, a continue or a return, on a condition.
    fn leave(&mut self) {
        let Some(enclosure) = self.around.last().copied() else {
            return;
        };
        let (label, condition) = (self.label(), self.truth());
        self.flow(label, &format!("if [{condition}]"));
        match enclosure {
            Enclosure::Loop(_) if self.uses == LoopUses::Do => self.straight(),
            Enclosure::Loop(of) => {
                let word = self.pick(&["break", "continue"]);
                self.flow(of, word);
            }
            Enclosure::Routine(of) => self.flow(of, "return [#1 * 2]"),
            Enclosure::Repeat => self.straight(),
        }
        self.flow(label, "endif");
    }

    fn routine(&mut self) {
        let (label, arguments) = (self.label(), self.below(4));
        self.flow(label, "sub");
        if arguments > 0 {
            self.line(&format!("#<inner> = [#{arguments} / 2]"));
            self.line("G1 X#<inner> Y[#1 - #<inner>]");
        }
        self.block(2, Some(Enclosure::Routine(label)));
        let end = self.pick(&["endsub", "endsub [#1 + 3]", "endsub"]);
        self.flow(label, end);
        self.routines.push((label, arguments));
    }

    fn call(&mut self) {
        if self.routines.is_empty() {
            return;
        }
        // A routine calls only earlier routines.
        let within = self.around.iter().find_map(|enclosure| match enclosure {
            Enclosure::Routine(label) => Some(*label),
            _ => None,
        });
        let (label, arguments) = self.routines[self.rng.random_range(0..self.routines.len())];
        if within.is_some_and(|within| within <= label) {
            return;
        }
        let mut line = "call".to_owned();
        for _ in 0..arguments {
            line += &format!(" [{}]", self.below(9));
        }
        self.flow(label, &line);
        if self.below(3) == 0 {
            self.line("G1 Z[#<_value> / 4]");
        }
    }

    fn straight(&mut self) {
        let code = self.pick(&["G0", "G1", "G01", "G1"]);
        let mut words = vec![code.to_owned()];
        for axis in ['X', 'Y', 'Z'] {
            if self.below(2) == 0 || words.len() == 1 && axis == 'Z' {
                words.push(format!("{axis}{}", self.coordinate()));
            }
        }
        if self.below(9) == 0 {
            words.push(format!("F{}", 100 + self.below(900)));
        }
        // The order of the words has no meaning.
        let other = self.rng.random_range(0..words.len());
        words.swap(0, other);
        self.line(&words.join(" "));
    }

    fn assignment(&mut self) {
        let (number, value) = (FREE + self.below(8), self.below(5));
        let line = match self.below(5) {
            0 => format!("#{number} = {value} #{number} = [#{number} + 1]"),
            1 => format!("#[{} + 1] = {value}", number - 1),
            2 => format!("G1 X#{number} #{number} = {value}"),
            3 => format!("#{number} = [[#{number} + {value}] mod 4]"),
            _ => format!("#{number} = {value}.5"),
        };
        self.line(&line);
    }

    /// Appends an arc that fits anywhere, in any plane: its words are distances.
    fn arc(&mut self) {
        let (plane, [first, second, normal, i, j]) = self.pick(&PLANE_LETTERS);
        let code = self.pick(&["G2", "G3"]);
        let (x, y) = (self.rng.random_range(-6..6), self.rng.random_range(1..6));
        let radius = self.pick(&[7.0, 8.25, -9.0]);
        let line = match self.below(4) {
            0 => format!("{code} {first}{x} {second}{y} R{radius}"),
            1 => format!(
                "{code} {first}{} {second}{} {i}{x} {j}{y} {normal}1",
                2 * x,
                2 * y
            ),
            2 => format!("{code} {i}{x} {j}{y} P2"),
            _ => format!("{code} {first}{} {i}{y}", 2 * y),
        };
        self.line(&format!("{plane} G91 {line}"));
        let back = self.pick(&["G90 G17", "G17 G90"]);
        self.line(back);
    }

    fn polar(&mut self) {
        let (radius, angle) = (1 + self.below(20), self.rng.random_range(-200..200));
        let counter = FREE + self.below(3);
        let line = match self.below(5) {
            0 => format!("G1 @{radius} ^{angle}"),
            1 => format!("G0 X{radius} Y1\nG1 ^[{angle} + #{counter}] Z1"),
            2 => format!("G0 X{radius} Y2\nG91 G1 @1 ^{angle}\nG90"),
            3 => format!("G0 @{radius} ^{angle}\nG91 ^15\n@.5\nG90"),
            // A flatter arc would count as an arc around a flat corner of compensation.
            _ => format!("G3 @{radius} ^{angle} R30"),
        };
        line.lines().for_each(|line| self.line(line));
    }

    /// Appends a series of holes, with repeats and polar coordinates.
    fn cycle(&mut self) {
        let (plane, [first, second, normal, ..]) = self.pick(&PLANE_LETTERS);
        let code = self.pick(&["G81", "G82", "G83", "G73", "G85", "G89"]);
        let incremental = self.below(2) == 0;
        let extra = match code {
            "G82" | "G89" => " P.2",
            "G83" | "G73" => " Q1.5",
            _ => "",
        };
        let mode = if incremental { "G91" } else { "G90" };
        let high = 4 + self.below(9);
        self.line(&format!("{plane} G90 G0 {normal}{high}"));
        let back = self.pick(&["G98", "G99"]);
        let (bottom, above) = (1 + self.below(4), self.below(4));
        let mut words = format!("{first}{} {second}{}", self.coordinate(), self.coordinate());
        words += &format!(" {normal}-{bottom} R{above}{extra}");
        if self.below(2) == 0 {
            words += &format!(" L{}", self.below(4).max(1));
        }
        self.line(&format!("{mode} {back} {code} {words}"));
        for _ in 0..self.below(4) {
            let line = match self.below(5) {
                0 => format!("{first}{} L{}", self.coordinate(), 1 + self.below(3)),
                1 if plane == "G17" => format!("@{} ^{}", 2 + self.below(9), self.below(360)),
                2 => format!("{second}{} R{}", self.coordinate(), self.below(4)),
                3 => format!(
                    "{first}{} {normal}-{}",
                    self.coordinate(),
                    1 + self.below(3)
                ),
                _ => format!("{second}{}", self.coordinate()),
            };
            self.line(&line);
        }
        self.line("G80 G90 G17");
    }

    fn modes(&mut self) {
        if self.below(4) == 0 {
            let lines = if self.turns {
                "G10 L2 P0 R30\nG1 X3\nG10 L2 P0 R0"
            } else {
                self.pick(&["G92 X3 Y1", "G92.1", "G52 X1"])
            };
            return lines.lines().for_each(|line| self.line(line));
        }
        let lines = self.pick(&[
            "G20\nG1 X.1 Y.2\nG21",
            "M70\nG91 G1 X1\nM72",
            "G55\nG10 L2 P2 X4 Y-1",
            "G54",
            "G4 P0.5",
            "/G1 X1",
            "G61 G1 X2\nG64",
            "G53 G0 Z9",
        ]);
        lines.lines().for_each(|line| self.line(line));
    }

    /// Appends a polygon with cutter compensation in any plane; a loop counts its corners.
    fn compensation(&mut self) {
        // G19 has no compensation: both readers reject it.
        let plane = if self.below(16) == 0 {
            2
        } else {
            self.rng.random_range(0..2)
        };
        let (plane, [first, second, ..]) = PLANE_LETTERS[plane];
        let (label, counter, corners) = (self.label(), self.counter(), 3 + self.below(5));
        let (code, sense) = self.pick(&[("G41.1", 1), ("G42.1", -1), ("G41.1", -1), ("G42.1", 1)]);
        let (radius, diameter) = (15 + self.below(10), self.pick(&["1", "2.5", "4"]));
        self.line(&format!("G90 {plane} G0 {first}60 {second}{}", -5 * sense));
        self.line(&format!("{code} D{diameter} G1 {first}{radius} {second}0"));
        self.line(&format!("{counter} = 0"));
        self.flow(label, &format!("while [{counter} lt {corners}]"));
        self.line(&format!("{counter} = [{counter} + 1]"));
        let angle = format!("{} * {counter} / {corners}", 360 * sense);
        if self.below(3) == 0 {
            let arc = if sense > 0 { "G3" } else { "G2" };
            self.line(&format!(
                "{arc} {first}[{radius} * cos[{angle}]] {second}[{radius} * sin[{angle}]] R[{radius} * 1.5]"
            ));
        } else {
            self.line(&format!(
                "G1 {first}[{radius} * cos[{angle}]] {second}[{radius} * sin[{angle}]]"
            ));
        }
        self.flow(label, "endwhile");
        self.line(&format!("G40 G1 {first}70 {second}{}", 9 * sense));
        self.line("G17");
    }
}
