//! Question: does a correction without a model of the axes help? It enters the loop when the
//! measured errors show that it helps, and leaves when they show harm.
//!
//! Outside the loop the controller decides on an offset that is not commanded. The error that it
//! would leave follows from the measured error and the linear servo G. Its lag L is the time by
//! which the tool lags, its response M is known of the speed loop:
//!
//! ```text
//! G        = 1 / (1 + L s + L M s^2)
//! eps_open = eps + G o_commanded        error without the correction
//! eps_with = eps_open - G o_wanted      error with all of it
//! r        = (|eps_open|^2 - |eps_with|^2) / (|eps_open|^2 + |eps_with|^2 + noise^2)      -1 .. 1
//! W(n+1)   = W(n) (1 + b r)             wealth of a bet on r > 0; W(0) = 1
//! ```
//!
//! with the squares summed over a block of decisions. If the correction does not help, that is if r
//! has no positive mean given the past, W reaches 1/alpha with probability alpha at most (Ville
//! 1939). A wrong gain or a wrong sign therefore engages with that probability. Each further trial
//! has half of alpha; all trials of a cut together err with at most 2 alpha.
//!
//! Evidence: W.
//!
//! While W grows from 1 to 1/alpha, the share `ln W / ln(1/alpha)` of the offset is commanded, and
//! after that all of it.
//!
//! In the loop the same bet is made on r < 0, decision by decision, with its wealth held above 1 (a
//! CUSUM, Page 1954). If it reaches 1/alpha, the offset goes back to the path and the next trial
//! begins.
//!
//! Source: Waudby-Smith and Ramdas (2024), "Estimating means of bounded random variables by
//! betting".
//!
//! Departures: errors of successive blocks are correlated through G. A block is as long as the time
//! constant of a usual position loop, so that a third of the last block remains in it. The error
//! rate is therefore nominal.

use crate::command::{Command, Measured};
use crate::vector::{add_scaled, bounded, dot, norm, reject, scale, sub};
use crate::window::Window;

/// Error rate of the first trial.
const ALPHA: f64 = 0.05;
/// Part of the wealth that is bet on each block.
const BET: f64 = 0.9;
/// Decisions in a block: 20 ms at a feed period of 10 ms.
const BLOCK: u32 = 2;
/// Errors below this are noise, mm.
const NOISE_MM: f64 = 1e-3;
/// Largest change of the commanded share per decision: the full correction enters within four.
const SHARE_STEP: f64 = 0.25;
/// Difference from the requested offset beyond which it was not followed, mm.
const FOLLOWED_MM: f64 = 0.01;
/// Ratio to the error without the correction beyond which a wanted correction begins anew.
const HOPELESS: f64 = 4.0;

/// An offset as it moves the tool: `x'' = (o - x - L x') / (L M)`.
#[derive(Debug, Clone, Copy)]
struct FeltOffset<const N: usize> {
    last_mm: [f64; N],
    felt_mm: [f64; N],
    felt_mm_s: [f64; N],
}

impl<const N: usize> FeltOffset<N> {
    const NONE: Self = Self {
        last_mm: [0.0; N],
        felt_mm: [0.0; N],
        felt_mm_s: [0.0; N],
    };

    /// Advances by a feed period at whose end the offset is `offset_mm`, in implicit steps of a
    /// servo period.
    fn go_on(
        &mut self,
        offset_mm: [f64; N],
        window: &Window<'_, N>,
        [lag_s, response_s]: [f64; 2],
    ) {
        let step_s = window.servo_s();
        // The cast saturates to zero where the float is NaN.
        let steps = libm::round(window.feed_period_s / step_s).max(1.0) as u32;
        let change_mm = scale(1.0 / f64::from(steps), sub(offset_mm, self.last_mm));
        let denominator_s2 = lag_s * response_s + lag_s * step_s + step_s * step_s;
        for n in 1..=steps {
            let ahead_mm = sub(
                add_scaled(self.last_mm, f64::from(n), change_mm),
                self.felt_mm,
            );
            let momentum = scale(lag_s * response_s / denominator_s2, self.felt_mm_s);
            self.felt_mm_s = add_scaled(momentum, step_s / denominator_s2, ahead_mm);
            self.felt_mm = add_scaled(self.felt_mm, step_s, self.felt_mm_s);
        }
        self.last_mm = offset_mm;
    }
}

/// A trial and its evidence.
#[derive(Debug, Clone)]
pub(crate) struct CorrectionTrial<const N: usize> {
    wanted_mm: [f64; N],
    /// M, s.
    response_s: f64,
    /// Share of the wanted offset that is commanded; `engaged`: true if the correction has passed
    /// its trial.
    share: f64,
    engaged: bool,
    commanded: FeltOffset<N>,
    wanted: FeltOffset<N>,
    /// Sums of squares of the present block, without the correction and with it, mm^2, and its
    /// decisions.
    block_mm2: [f64; 2],
    decisions: u32,
    help: f64,
    harm: f64,
    enough: f64,
}

impl<const N: usize> CorrectionTrial<N> {
    /// Creates the trial before a program, for axes whose speed loops respond within `response_s`.
    pub(crate) const fn new(response_s: f64) -> Self {
        Self {
            wanted_mm: [0.0; N],
            response_s,
            share: 0.0,
            engaged: false,
            commanded: FeltOffset::NONE,
            wanted: FeltOffset::NONE,
            block_mm2: [0.0; 2],
            decisions: 0,
            help: 1.0,
            harm: 1.0,
            enough: 1.0 / ALPHA,
        }
    }

    /// Returns the offset from which the next decision continues, mm.
    pub(crate) fn wanted_mm(&self) -> [f64; N] {
        self.wanted_mm
    }

    /// Returns true if the full correction is commanded.
    pub(crate) fn is_whole(&self) -> bool {
        self.engaged && self.share >= 1.0
    }

    /// Takes in a measurement. Returns the error that the full correction would have left, mm.
    pub(crate) fn observe(&mut self, window: &Window<'_, N>, measured: &Measured<N>) -> [f64; N] {
        let error_mm = measured.contour.vector_mm;
        let off_mm = norm(sub(window.offset_mm, scale(self.share, self.wanted_mm)));
        if off_mm > FOLLOWED_MM {
            // The correction was removed outside the trial.
            self.begin_anew(window.offset_mm);
        } else if self.is_whole() {
            self.wanted_mm = window.offset_mm;
        }
        let index = measured.contour.index;
        let times_s = [
            f64::from(index.min(0).unsigned_abs()) * window.servo_s(),
            self.response_s,
        ];
        self.commanded.go_on(window.offset_mm, window, times_s);
        self.wanted.go_on(self.wanted_mm, window, times_s);
        let tangent = window.knot(index).tangent;
        let open_mm = add_scaled(error_mm, 1.0, reject(self.commanded.felt_mm, tangent));
        let with_mm = if self.is_whole() {
            error_mm
        } else {
            sub(open_mm, reject(self.wanted.felt_mm, tangent))
        };
        if norm(open_mm).is_finite() && norm(with_mm).is_finite() && window.knot(index).cutting {
            self.judge(
                dot(open_mm, open_mm),
                dot(with_mm, with_mm),
                dot(error_mm, error_mm),
            );
        }
        with_mm
    }

    /// Returns the command for the wanted one.
    pub(crate) fn follow(&mut self, wanted: Command<N>) -> Command<N> {
        self.wanted_mm = wanted.offset_mm;
        let grown = libm::log(self.help.max(1.0)) / libm::log(self.enough);
        let allowed = if self.engaged { 1.0 } else { grown };
        self.share = bounded(allowed, self.share - SHARE_STEP, self.share + SHARE_STEP);
        if self.is_whole() {
            return wanted;
        }
        Command::straight(
            1.0 + self.share * (wanted.rate - 1.0),
            scale(self.share, wanted.offset_mm),
        )
    }

    /// Bets on a decision: the squares of the errors without the correction, with the full
    /// correction, and as measured.
    fn judge(&mut self, open_mm2: f64, with_mm2: f64, now_mm2: f64) {
        let gained = |open_mm2: f64, with_mm2: f64| {
            (open_mm2 - with_mm2) / (open_mm2 + with_mm2 + NOISE_MM * NOISE_MM)
        };
        if self.engaged {
            self.harm = (self.harm * (1.0 - BET * gained(open_mm2, now_mm2))).max(1.0);
            if self.harm >= 1.0 / ALPHA {
                (self.engaged, self.help, self.harm) = (false, 1.0, 1.0);
                self.enough *= 2.0;
            }
            return;
        }
        let [open, with] = self.block_mm2;
        self.block_mm2 = [open + open_mm2, with + with_mm2];
        self.decisions += 1;
        if self.decisions < BLOCK {
            return;
        }
        let [open, with] = self.block_mm2.map(|sum| sum / f64::from(BLOCK));
        (self.block_mm2, self.decisions) = ([0.0; 2], 0);
        self.help *= 1.0 + BET * gained(open, with);
        if self.help >= self.enough {
            (self.engaged, self.harm) = (true, 1.0);
        } else if with > HOPELESS * (open + NOISE_MM * NOISE_MM) {
            self.begin_anew([0.0; N]);
        }
    }

    /// Begins anew from a commanded offset, without evidence.
    fn begin_anew(&mut self, offset_mm: [f64; N]) {
        self.engaged = false;
        (self.share, self.help) = (0.0, self.help.min(1.0));
        (self.wanted_mm, self.wanted) = (offset_mm, self.commanded);
        (self.block_mm2, self.decisions) = ([0.0; 2], 0);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::contour_error::ContourError;
    use crate::window::tests::Line;
    use crate::window::{KnotSource, Preview, Register};

    const SERVO_S: f64 = 0.001;
    const LAG_KNOTS: u32 = 20;

    /// Shares of a controller that wants `gain` times the error without it as its offset, over two
    /// seconds in which that error is `open_mm` at each decision; the tool feels `real` times the
    /// offset of the trial's own servo.
    fn shares(gain: f64, real: f64, open_mm: impl Fn(u32) -> f64) -> [f64; 200] {
        let (mut register, mut preview) = (Register::default(), Preview::new(SERVO_S));
        let (mut trial, mut felt) = (CorrectionTrial::<2>::new(0.005), FeltOffset::<2>::NONE);
        let mut offset_mm = [0.0; 2];
        core::array::from_fn(|n| {
            let decision = n as u32;
            for period in 0..10 {
                register.push(Line.knot(SERVO_S * f64::from(10 * decision + period)));
            }
            let tau_s = SERVO_S * f64::from(10 * decision + 9);
            preview.fill(&mut Line, tau_s, 0.02);
            let window = Window {
                register: &register,
                preview: &preview,
                tau_s,
                feed_period_s: 0.01,
                offset_mm,
                offset_mm_s: [0.0; 2],
            };
            felt.go_on(
                offset_mm,
                &window,
                [f64::from(LAG_KNOTS.min(10 * decision)) * SERVO_S, 0.005],
            );
            let vector_mm = [0.0, open_mm(decision) - real * felt.felt_mm[1]];
            let index = -(LAG_KNOTS.min(10 * decision) as i32);
            let measured = Measured {
                position_mm: [0.0; 2],
                contour: ContourError {
                    vector_mm,
                    index,
                    ..ContourError::NONE
                },
            };
            trial.observe(&window, &measured);
            offset_mm = trial
                .follow(Command::straight(1.0, [0.0, gain * open_mm(decision)]))
                .offset_mm;
            trial.share
        })
    }

    /// 20 um that turn slowly.
    fn slow(decision: u32) -> f64 {
        0.02 * libm::sin(0.05 * f64::from(decision))
    }

    #[test]
    fn what_helps_enters_within_a_third_of_a_second_and_stays() {
        let shares = shares(1.0, 1.0, slow);
        assert!(
            shares[0] == 0.0 && shares[33..].iter().all(|share| *share == 1.0),
            "{shares:?}"
        );
    }

    #[test]
    fn a_wrong_sign_stays_out_and_a_gain_three_times_too_large_as_soon_as_it_overshoots() {
        let wrong = shares(-1.0, 1.0, slow);
        assert!(wrong.iter().all(|share| *share == 0.0), "{wrong:?}");
        // Until the tool has followed, even three times the error makes it smaller.
        let large = shares(3.0, 1.0, slow);
        assert!(
            large[..20].iter().all(|share| *share < 0.5)
                && large[20..].iter().all(|share| *share == 0.0),
            "{large:?}"
        );
    }

    #[test]
    fn what_the_servo_makes_harmful_leaves_within_a_tenth_of_a_second() {
        // The trial sees the tool follow, but it goes three times as far.
        let shares = shares(1.0, 3.0, slow);
        let whole = shares.iter().position(|share| *share == 1.0);
        let left = whole.and_then(|from| shares[from..].iter().position(|share| *share < 1.0));
        assert!(left.is_none_or(|decisions| decisions <= 10), "{shares:?}");
        assert!(
            shares.iter().filter(|share| **share == 1.0).count() < 20,
            "{shares:?}"
        );
    }

    #[test]
    fn of_corrections_that_neither_help_nor_harm_few_enter() {
        // An offset of the size of the error that has nothing to do with it: r has no positive
        // mean.
        let entered = (0..200_u32).filter(|seed| {
            let mut state = u64::from(*seed)
                .wrapping_mul(0x9E37_79B9_7F4A_7C15)
                .wrapping_add(1);
            let noise: [f64; 200] = core::array::from_fn(|_| {
                state ^= state << 13;
                state ^= state >> 7;
                state ^= state << 17;
                0.02 * (state % 2001) as f64 / 1000.0 - 0.02
            });
            shares(1.0, 1.0, |decision| noise[decision as usize]).contains(&1.0)
        });
        let entered = entered.count();
        // Twice alpha of 200 is 20.
        assert!(entered <= 20, "{entered} of 200");
    }
}
