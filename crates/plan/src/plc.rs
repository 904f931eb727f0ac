//! The PLC and the spindle unit: how long tool changes, spindle and coolant hold the motion up.
//!
//! The CNC system of Lee, Cho and Jeon (2005), Fig. 1, has both beside the axes. Durations come
//! from the machine file; a spindle speeds up and slows down at a constant rate.

use feedwright_gcode::canon::EventKind;
use serde::Serialize;

mod rows;

pub use rows::{EventName, named};

/// Times for which PLC and spindle hold the motion: table `[plc]`. All are zero without the table.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize)]
pub struct Durations {
    /// M6, with the spindle at rest.
    pub tool_change_s: f64,
    /// M7, M8, M9: until the coolant flows, or has stopped.
    pub coolant_s: f64,
    /// M60: pallet shuttle.
    pub pallet_change_s: f64,
    /// Rate at which the spindle changes its speed, rev/min in a second; 0 is at once.
    pub spindle_rev_min_s: f64,
    /// Most that a rotary axis A, B or C turns in a second, degrees; 0 is no limit, and at once in
    /// a rapid.
    pub rotary_deg_s: f64,
}

/// An M-code that the machine builder gave a meaning: table `[plc.event."M64 P3"]`.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct PlcEvent {
    /// Number behind M.
    pub code: u16,
    /// Its P word; `None` is any or none.
    pub p: Option<u32>,
    /// Row of the timeline to which the event belongs, such as "lamp".
    pub row: String,
    /// Label of the event, such as "lamp on".
    pub label: String,
    /// Time that the event holds the motion, s.
    pub takes_s: f64,
}

/// The state that durations depend on.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Plc {
    durations: Durations,
    events: Vec<PlcEvent>,
    /// Programmed speed, rev/min.
    speed_rev_min: f64,
    /// Speed of the spindle, rev/min; negative is counter-clockwise.
    spindle_rev_min: f64,
}

impl Plc {
    /// Creates the state with these durations and the spindle at rest.
    pub const fn new(durations: Durations) -> Self {
        Self {
            durations,
            events: Vec::new(),
            speed_rev_min: 0.0,
            spindle_rev_min: 0.0,
        }
    }

    /// Sets the M-codes to which the machine builder gave a meaning and a duration.
    #[must_use]
    pub fn with_events(mut self, events: &[PlcEvent]) -> Self {
        self.events = events.to_vec();
        self
    }

    /// Returns the time that the tool waits for an event, s, and updates the spindle speed. M0 and
    /// M1 count as 0 s, because their time depends on the operator.
    pub(crate) fn takes_s(&mut self, kind: &EventKind) -> f64 {
        match kind {
            EventKind::Dwell { seconds } => *seconds,
            EventKind::SpindleSpeed { rpm } => {
                self.speed_rev_min = *rpm;
                // A change of S under way goes on while the tool moves.
                self.spindle_rev_min =
                    self.spindle_rev_min.signum() * if self.runs() { *rpm } else { 0.0 };
                0.0
            }
            EventKind::MCode { code: 3, .. } => self.spin_to(self.speed_rev_min),
            EventKind::MCode { code: 4, .. } => self.spin_to(-self.speed_rev_min),
            EventKind::MCode { code: 5, .. } => self.spin_to(0.0),
            EventKind::MCode { code: 6, .. } => self.spin_to(0.0) + self.durations.tool_change_s,
            EventKind::MCode { code: 7..=9, .. } => self.durations.coolant_s,
            EventKind::MCode { code: 60, .. } => self.durations.pallet_change_s,
            kind => rows::builders(kind, &self.events).map_or(0.0, |event| event.takes_s),
        }
    }

    /// Returns the time that a rotary axis takes to turn, s.
    pub fn turn_s(&self, degrees: f64) -> f64 {
        degrees / self.most_deg_s()
    }

    /// Rate at which a rotary axis turns at most, degrees/s; infinite without a limit.
    pub(crate) const fn most_deg_s(&self) -> f64 {
        if self.durations.rotary_deg_s > 0.0 {
            self.durations.rotary_deg_s
        } else {
            f64::INFINITY
        }
    }

    fn runs(&self) -> bool {
        self.spindle_rev_min != 0.0
    }

    /// Time to reach a speed, s.
    fn spin_to(&mut self, wanted_rev_min: f64) -> f64 {
        let change = (wanted_rev_min - self.spindle_rev_min).abs();
        self.spindle_rev_min = wanted_rev_min;
        if self.durations.spindle_rev_min_s > 0.0 {
            change / self.durations.spindle_rev_min_s
        } else {
            0.0
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const DURATIONS: Durations = Durations {
        tool_change_s: 5.0,
        coolant_s: 0.5,
        pallet_change_s: 10.0,
        spindle_rev_min_s: 2000.0,
        rotary_deg_s: 60.0,
    };

    fn m(code: u16) -> EventKind {
        EventKind::MCode {
            code,
            p: None,
            q: None,
        }
    }

    #[test]
    fn the_spindle_spins_up_reverses_and_stops_at_its_rate() {
        let mut plc = Plc::new(DURATIONS);
        assert_eq!(plc.takes_s(&EventKind::SpindleSpeed { rpm: 6000.0 }), 0.0);
        assert_eq!(plc.takes_s(&m(3)), 3.0);
        assert_eq!(plc.takes_s(&m(3)), 0.0);
        assert_eq!(plc.takes_s(&m(4)), 6.0);
        assert_eq!(plc.takes_s(&m(5)), 3.0);
    }

    #[test]
    fn a_tool_change_waits_for_the_spindle_to_stop() {
        let mut plc = Plc::new(DURATIONS);
        plc.takes_s(&EventKind::SpindleSpeed { rpm: 4000.0 });
        plc.takes_s(&m(3));
        assert_eq!(plc.takes_s(&m(6)), 7.0);
        assert_eq!(plc.takes_s(&m(6)), 5.0);
    }

    #[test]
    fn rotary_axes_turn_at_their_rate_or_at_once() {
        assert_eq!(Plc::new(DURATIONS).turn_s(90.0), 1.5);
        assert_eq!(Plc::default().turn_s(90.0), 0.0);
        assert_eq!(
            [
                Plc::new(DURATIONS).most_deg_s(),
                Plc::default().most_deg_s()
            ],
            [60.0, f64::INFINITY]
        );
    }

    #[test]
    fn coolant_pallet_and_the_rest_take_what_the_file_says() {
        let mut plc = Plc::new(DURATIONS);
        assert_eq!(
            [7, 8, 9, 60, 0, 1].map(|code| plc.takes_s(&m(code))),
            [0.5, 0.5, 0.5, 10.0, 0.0, 0.0]
        );
        assert_eq!(Plc::default().takes_s(&m(6)), 0.0);
    }

    #[test]
    fn what_the_builder_named_takes_what_the_builder_says() {
        let event = |p, takes_s| PlcEvent {
            code: 64,
            p,
            row: "lamp".to_owned(),
            label: "on".to_owned(),
            takes_s,
        };
        let mut plc = Plc::new(DURATIONS).with_events(&[event(None, 1.0), event(Some(3), 0.25)]);
        let output = |p| EventKind::MCode {
            code: 64,
            p,
            q: None,
        };
        assert_eq!(
            [Some(3.0), Some(2.0), None].map(|p| plc.takes_s(&output(p))),
            [0.25, 1.0, 1.0]
        );
        assert_eq!(plc.takes_s(&m(65)), 0.0);
    }
}
