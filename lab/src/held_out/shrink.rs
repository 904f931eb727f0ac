//! Makes a failing case smaller: as few lines of the program and as few changes of the machine as still fail.
//!
//! Parts are left out, first halves, then quarters, down to single ones, and what still fails is kept; again until nothing
//! can be left out (delta debugging, Zeller and Hildebrandt 2002, algorithm ddmin). The number of trials is bounded.

use super::variant::Variant;

/// A program and a machine.
#[derive(Debug, Clone, PartialEq)]
pub struct Case {
    /// Lines of the program.
    pub lines: Vec<String>,
    /// The machine.
    pub machine: Variant,
}

impl Case {
    /// Of the text of a program.
    pub fn new(text: &str, machine: Variant) -> Self {
        Self { lines: text.lines().map(str::to_owned).collect(), machine }
    }

    /// The program.
    pub fn text(&self) -> String {
        self.lines.iter().map(|line| format!("{line}\n")).collect()
    }
}

/// Returns the smallest case that still fails, found in at most `trials` trials. `fails` must hold
/// for `case` itself.
pub fn shrink(case: Case, trials: u32, fails: &mut dyn FnMut(&Case) -> bool) -> Case {
    let mut left = trials;
    let mut case = case;
    loop {
        let before = (case.lines.len(), case.machine.changes.len());
        // The machine first: what fails on the base itself needs no other.
        let Case { lines, machine } = case;
        let mut of_machine = |changes: &[_]| {
            fails(&Case { lines: lines.clone(), machine: Variant { changes: changes.to_vec(), ..machine.clone() } })
        };
        let changes = fewest(machine.changes.clone(), &mut left, &mut of_machine);
        let machine = Variant { changes, ..machine };
        let mut of_lines = |lines: &[String]| fails(&Case { lines: lines.to_vec(), machine: machine.clone() });
        let lines = fewest(lines, &mut left, &mut of_lines);
        case = Case { lines, machine };
        if left == 0 || (case.lines.len(), case.machine.changes.len()) == before {
            return case;
        }
    }
}

/// As few of the items as still fail.
fn fewest<T: Clone>(mut items: Vec<T>, left: &mut u32, fails: &mut dyn FnMut(&[T]) -> bool) -> Vec<T> {
    let mut chunk = items.len();
    while chunk > 0 {
        let mut start = 0;
        while start < items.len() {
            if *left == 0 {
                return items;
            }
            *left -= 1;
            let end = (start + chunk).min(items.len());
            let without: Vec<T> = [&items[..start], &items[end..]].concat();
            if fails(&without) {
                items = without;
            } else {
                start = end;
            }
        }
        chunk /= 2;
    }
    items
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A fault that needs two lines in this order, and one change of the machine.
    fn planted(case: &Case) -> bool {
        let place = |wanted: &str| case.lines.iter().position(|line| line == wanted);
        let slow = case.machine.changes.iter().any(|change| change.key == "kp_1_s" && change.table == "axis.y");
        slow && place("17").zip(place("63")).is_some_and(|(first, second)| first < second)
    }

    #[test]
    fn a_planted_fault_is_all_that_stays() {
        let text: String = (0..100).map(|i| format!("{i}\n")).collect();
        let machine = Variant::of("tnv40", "m").with_axes("kp_1_s", 30.0).with_axes("inertia_kg_m2", 0.02);
        let mut trials = 0;
        let small = shrink(Case::new(&text, machine), 10_000, &mut |case| {
            trials += 1;
            planted(case)
        });
        assert_eq!(small.text(), "17\n63\n");
        assert_eq!(small.machine.changes.len(), 1);
        assert!(trials < 200, "{trials} trials");
    }

    #[test]
    fn the_number_of_trials_is_bounded_and_what_is_found_fails() {
        let text: String = (0..100).map(|i| format!("{i}\n")).collect();
        let machine = Variant::of("tnv40", "m").with("axis.y", "kp_1_s", 30.0);
        let mut trials = 0;
        let small = shrink(Case::new(&text, machine), 12, &mut |case| {
            trials += 1;
            planted(case)
        });
        assert!(trials <= 12 && planted(&small), "{trials} trials");
    }
}
