//! Lathe cycles G70 to G72.2: a profile, written as a subroutine, is roughed out in straight passes
//! or finished along itself.
//!
//! The cycle's block calls the subroutine; `state/lathe.rs` keeps its motions instead of handing
//! them out. `words` are those that only a profile has. When it returns, `corners` and `profile`
//! bring it into the cycle's own coordinates (`cycle_plane`), and `offset` puts a curve beside it;
//! `pockets` finds where it goes down, and `roughing` and `finishing` make motions of it. What
//! LinuxCNC 2.9 does was found by trying programs on it; those that showed it are the `turning_*`
//! of `crates/plan/tests/oracle_data`.

pub(crate) mod cycle_plane;
mod corners;
mod profile;
mod offset;
pub(crate) mod pockets;
mod roughing;
mod finishing;
mod words;

use crate::canon::Plane;
use crate::motion::feed::Speed;
use crate::state::Interpreter;
use crate::state::lathe::{CHANGED, LatheCycle, LatheWork, ProfileCall};
use crate::text::block::Block;
use crate::text::codes::{Group, spelled};
use crate::text::diagnostic::{LineFault, Read, Short};
use crate::text::expression::INTEGER_WITHIN;
use crate::text::source::Mark;

/// Passes of one cycle: more is a mistake in I or P.
pub(super) const MAX_PASSES: f64 = 10_000.0;
/// LinuxCNC's depth of a pass and retraction where I and R are missing, in the unit of the program.
const DEFAULT_DEPTH: f64 = 1.0;
const DEFAULT_RETRACTION: f64 = 0.5;

const BEFORE: &str = "write such codes before the cycle";

impl Interpreter {
    /// G70 to G72.2: goes to the start; the reader then calls the profile.
    pub(crate) fn lathe_cycle(&mut self, block: &Block, code: u16) -> Read<()> {
        let name = spelled(code);
        let fault = |at, message: String| LineFault::new("gcode::lathe", at, message);
        let at = block
            .code(Group::Motion)
            .map_or(block.whole(), |word| word.at());
        // Axis words alone go straight from here on, in a profile and behind a cycle that was
        // refused.
        self.modal.motion = 10;
        if self.lathe.is_some() {
            return Err(fault(
                at,
                format!("{name} stands inside the profile of another lathe cycle"),
            ));
        }
        if matches!(code, 700 | 710) && !block.has(b'q') && !block.has_axes() {
            let unit = if code == 700 {
                "inches: write G20"
            } else {
                "millimeters: write G21"
            };
            return Err(
                fault(at, format!("{name} without words is no cycle of a lathe"))
                    .hint(format!("as a unit of other controls, {name} means {unit}")),
            );
        }
        if self.modal.plane != Plane::Zx {
            return Err(
                fault(at, format!("{name} needs the plane G18 (ZX)")).hint("write G18 before it")
            );
        }
        if self.frame.rotation_deg != 0.0 {
            return Err(fault(
                at,
                format!("{name} cannot run in a rotated coordinate system"),
            )
            .hint("rotation is R of G10 L2; write G10 L2 P0 R0 to end it"));
        }
        if self.compensates() {
            let message = format!("{name} with cutter compensation is not read by this version");
            return Err(fault(at, message)
                .hint("write G40 before it; D of the cycle is a distance to the profile"));
        }
        let Some(number) = block.get(b'q') else {
            return Err(fault(
                at,
                format!("Q (number of the profile's subroutine) is missing for {name}"),
            )
            .hint("write Q100 for a profile between O100 sub and O100 endsub"));
        };
        if !(0.0..1e15).contains(&number) || (number - number.round()).abs() > INTEGER_WITHIN {
            return Err(fault(
                block.at(b'q'),
                format!("Q{} is no number of a subroutine", Short(number)),
            ));
        }
        let work = self.lathe_work(block, code)?;
        let target = self.target(block)?;
        self.go(block, target, Speed::Rapid)?;
        self.wanted = Some(ProfileCall {
            label: (number.round() as u64).to_string().into_bytes(),
            at: block.at(b'q'),
        });
        self.lathe = Some(Box::new(LatheCycle {
            code,
            block: block.clone(),
            line: self.line,
            mark: Mark::default(),
            level: self.calls.level,
            start: self.here,
            feed: (self.modal.feed, self.modal.feed_unit_mm),
            modes: self.lathe_modes(),
            work,
            motions: Vec::new(),
            corners: Vec::new(),
            corner: None,
            fault: None,
        }));
        Ok(())
    }

    fn lathe_work(&self, block: &Block, code: u16) -> Read<LatheWork> {
        let unit = self.modal.unit_mm;
        // A distance that must not be negative.
        let distance = |letter: u8, default: f64| {
            let value = block.get(letter).unwrap_or(default);
            if value >= 0.0 && value * unit <= self.settings.coordinate_limit_mm {
                return Ok(value * unit);
            }
            let name = char::from(letter).to_ascii_uppercase();
            let limit = self.settings.coordinate_limit_mm;
            let message = format!(
                "{name}{} of {} is out of range: 0 to {limit} mm",
                Short(value),
                spelled(code)
            );
            Err(LineFault::new("gcode::lathe", block.at(letter), message))
        };
        if code == 700 {
            if block.has(b'r') {
                return Err(LineFault::new(
                    "gcode::unused_word",
                    block.at(b'r'),
                    "R has no meaning with G70",
                ));
            }
            let passes = if block.has(b'p') {
                self.integer(block, b'p', 1, MAX_PASSES as i64)? as u32
            } else {
                1
            };
            return Ok(LatheWork::Finish {
                first_mm: distance(b'd', 0.0)?,
                last_mm: distance(b'e', 0.0)?,
                passes,
            });
        }
        let depth_mm = distance(b'i', DEFAULT_DEPTH)?;
        if depth_mm == 0.0 {
            return Err(LineFault::new(
                "gcode::lathe",
                block.at(b'i'),
                format!("the depth of a pass I of {} must be above 0", spelled(code)),
            ));
        }
        Ok(LatheWork::Rough {
            depth_mm,
            retraction_mm: distance(b'r', DEFAULT_RETRACTION)?,
            left_mm: distance(b'd', 0.0)?,
        })
    }

    /// The end of the program inside a profile: the cycle was not carried out.
    pub(crate) fn check_profile_end(&self, open: bool, at: std::ops::Range<usize>) -> Read<()> {
        if !open {
            return Ok(());
        }
        Err(LineFault::new(
            "gcode::lathe",
            at,
            "the program ends inside the profile of a lathe cycle: nothing of it is cut",
        )
        .hint("end the profile with endsub"))
    }

    /// The profile has been read: carries the cycle out.
    pub(crate) fn finish_lathe(&mut self, lathe: &LatheCycle) -> Read<()> {
        let block = &lathe.block;
        self.line = lathe.line;
        (self.modal.feed, self.modal.feed_unit_mm) = lathe.feed;
        // Reading the profile has moved the reader, and not the tool.
        self.here = lathe.start;
        self.at = self.frame.to_program(&self.here);
        let refuse = |message: String| LineFault::new("gcode::lathe", block.at(b'q'), message);
        if let Some((line, message)) = &lathe.fault {
            let fault = refuse(format!(
                "the profile of {} cannot be used: line {line}: {message}",
                spelled(lathe.code)
            ));
            return Err(if message == CHANGED {
                fault.hint(BEFORE)
            } else {
                fault
            });
        }
        if self.lathe_modes() != lathe.modes {
            return Err(refuse(format!(
                "the profile of {} cannot be used: {CHANGED}",
                spelled(lathe.code)
            ))
            .hint(BEFORE));
        }
        if lathe.motions.is_empty() {
            return Err(
                refuse(format!("the profile of {} is empty", spelled(lathe.code)))
                    .hint("write its motions, with G0 to G3, into the subroutine"),
            );
        }
        if lathe.motions.len() < 2 {
            let message = format!(
                "the profile of {} has one motion, its entry: nothing is cut",
                spelled(lathe.code)
            );
            self.output.warnings.push(*refuse(message));
            return Ok(());
        }
        if lathe
            .corners
            .last()
            .is_some_and(|corner| corner.0 + 1 == lathe.motions.len())
        {
            let message = format!(
                "the corner behind the last motion of the profile of {} has no second side",
                spelled(lathe.code)
            );
            self.output.warnings.push(*refuse(message));
        }
        let done = match lathe.work {
            LatheWork::Finish {
                first_mm,
                last_mm,
                passes,
            } => self.finish_profile(lathe, [first_mm, last_mm], passes),
            LatheWork::Rough {
                depth_mm,
                retraction_mm,
                left_mm,
            } => self.rough(lathe, depth_mm, retraction_mm, left_mm),
        };
        self.at = self.frame.to_program(&self.here);
        done
    }
}
