//! By how much the reference of a tool that begins to move is behind the plan.
//!
//! ```text
//! T   lag at constant speed; t of the tool, as its nearest point of the path has it
//!
//! l = t                                          as long as the correction comes in
//! l'' = -2 l' / tau - (l - T) / tau^2            from there on
//! ```
//!
//! From rest an axis that nobody corrects is less behind than T for the first T. Held back to T where the correction comes in, each axis
//! closes what it is ahead in its own time, and what differs leads the tool off the path: on tnv40 by 9 um at 2,000 mm/s^2, by
//! 1 um at 100. Along the path there is no contour error, and time for it.

/// Time constant of the way to T, s.
const BACK_S: f64 = 0.1;
/// Time over which the change of t is averaged, s.
const CHANGE_S: f64 = 0.005;
/// The most that l may be, times T.
const MOST: f64 = 2.0;

/// l and what it becomes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Lag {
    usual_s: f64,
    now_s: f64,
    change: f64,
    /// Whether t was known before.
    is_known: bool,
}

impl Lag {
    /// At constant speed.
    pub(super) fn usual(usual_s: f64) -> Self {
        Self { usual_s, now_s: usual_s, change: 0.0, is_known: false }
    }

    /// T, s.
    pub(super) fn usual_s(&self) -> f64 {
        self.usual_s
    }

    /// l in a while, s: where it grows, the reference is slower than the plan.
    pub(super) fn after_s(&self, after_s: f64) -> f64 {
        self.now_s + self.change * after_s
    }

    /// As at constant speed again.
    pub(super) fn forget(&mut self) {
        *self = Self::usual(self.usual_s);
    }

    /// A servo period in which the tool, where it moves and the correction comes in, is `tool_s` behind the plan.
    pub(super) fn take_in(&mut self, tool_s: Option<f64>, servo_s: f64) {
        match tool_s {
            Some(tool_s) => {
                let tool_s = tool_s.max(0.0).min(MOST * self.usual_s);
                if self.is_known {
                    let part = (servo_s / CHANGE_S).min(1.0);
                    self.change += part * ((tool_s - self.now_s) / servo_s - self.change);
                }
                (self.now_s, self.is_known) = (tool_s, true);
            }
            None => {
                let pull = (self.now_s - self.usual_s) / (BACK_S * BACK_S);
                self.change -= servo_s * (2.0 * self.change / BACK_S + pull);
                self.now_s += servo_s * self.change;
                self.is_known = false;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SERVO_S: f64 = 0.001;

    #[test]
    fn it_is_the_tools_and_then_goes_to_the_usual_without_a_leap() {
        let mut lag = Lag::usual(0.02);
        // An axis of first order under constant acceleration.
        let of_tool = |t: f64| t - (t * t - 0.04 * t + 8e-4 * (1.0 - libm::exp(-t / 0.02))).sqrt();
        (1..=25).for_each(|n| lag.take_in(Some(of_tool(SERVO_S * f64::from(n))), SERVO_S));
        assert_eq!(lag.after_s(0.0), of_tool(0.025));
        assert!(lag.change > 0.0, "it grows");
        let mut before_s = lag.after_s(0.0);
        for n in 0..1000 {
            lag.take_in(None, SERVO_S);
            assert!((lag.after_s(0.0) - before_s).abs() < 0.3 * SERVO_S, "{n}: the reference leapt");
            before_s = lag.after_s(0.0);
        }
        assert!((lag.after_s(0.0) - 0.02).abs() < 2e-5, "{}", lag.after_s(0.0));
        lag.take_in(Some(f64::NAN), SERVO_S);
        assert_eq!(lag.after_s(0.0), 0.0, "what is not a number is none");
        lag.forget();
        assert_eq!(lag, Lag::usual(0.02));
    }

    #[test]
    fn nothing_changes_where_the_tool_is_as_usual() {
        let mut lag = Lag::usual(0.02);
        (0..50).for_each(|_| lag.take_in(Some(0.02), SERVO_S));
        (0..500).for_each(|_| lag.take_in(None, SERVO_S));
        assert_eq!(lag.after_s(0.0), 0.02);
    }
}
