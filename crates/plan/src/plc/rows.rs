//! What an event is called, and which row of a timeline it stands in: one for each unit of the
//! machine.
use feedwright_gcode::canon::EventKind;

use super::PlcEvent;

/// An event for people.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct EventName {
    /// Row of the timeline: the unit of the machine that is at work.
    pub row: String,
    /// Label of the event.
    pub label: String,
}

/// Names an event; what the machine builder named goes first.
pub fn named(kind: &EventKind, events: &[PlcEvent]) -> EventName {
    if let Some(event) = builders(kind, events) {
        return EventName {
            row: event.row.clone(),
            label: event.label.clone(),
        };
    }
    let (row, label) = match kind {
        EventKind::Dwell { seconds } => ("dwell", format!("dwell {seconds} s")),
        EventKind::SpindleSpeed { rpm } => ("spindle", format!("spindle speed {rpm} rev/min")),
        EventKind::MCode { code, p, .. } => m_code(*code, *p),
        EventKind::ToolSelect { tool } => ("tool", format!("T{tool} selected")),
        EventKind::Message { text } => ("message", text.clone()),
        EventKind::SpindleSync {
            pitch_mm: Some(pitch_mm),
        } => (
            "spindle",
            format!("feed coupled to the spindle, {pitch_mm} mm/rev"),
        ),
        EventKind::SpindleSync { pitch_mm: None } => {
            ("spindle", "feed free of the spindle".to_owned())
        }
        EventKind::Probe => ("probe", "probe".to_owned()),
        EventKind::ProgramEnd => ("stop", "program end".to_owned()),
    };
    EventName {
        row: row.to_owned(),
        label,
    }
}

/// Returns the machine builder's entry for an M-code: the entry with its P word before the entry
/// for any P word.
pub(super) fn builders<'a>(kind: &EventKind, events: &'a [PlcEvent]) -> Option<&'a PlcEvent> {
    let EventKind::MCode { code, p, .. } = kind else {
        return None;
    };
    let of_code = |event: &&PlcEvent| event.code == *code;
    let exact = events
        .iter()
        .filter(of_code)
        .find(|event| event.p.is_some_and(|own| *p == Some(f64::from(own))));
    exact.or_else(|| {
        events
            .iter()
            .filter(of_code)
            .find(|event| event.p.is_none())
    })
}

fn m_code(code: u16, p: Option<f64>) -> (&'static str, String) {
    let what = match code {
        0 => ("stop", "program stop"),
        1 => ("stop", "optional stop"),
        2 | 30 => ("stop", "program end"),
        3 => ("spindle", "spindle clockwise"),
        4 => ("spindle", "spindle counter-clockwise"),
        5 => ("spindle", "spindle stop"),
        19 => ("spindle", "spindle orientation"),
        6 => ("tool", "tool change"),
        61 => ("tool", "tool number set"),
        7 => ("coolant", "mist coolant"),
        8 => ("coolant", "flood coolant"),
        9 => ("coolant", "coolant off"),
        60 => ("pallet", "pallet change"),
        62 | 64 => ("output", "output on"),
        63 | 65 => ("output", "output off"),
        67 | 68 => ("output", "analog output"),
        66 => ("input", "waits for an input"),
        _ => ("other", ""),
    };
    let (row, label) = what;
    let word = p.map_or(String::new(), |p| format!(" P{p}"));
    let space = if label.is_empty() { "" } else { " " };
    (row, format!("M{code}{word}{space}{label}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn m(code: u16, p: Option<f64>) -> EventKind {
        EventKind::MCode { code, p, q: None }
    }

    #[test]
    fn every_unit_has_a_row_of_its_own() {
        let row = |kind: &EventKind| named(kind, &[]).row;
        let rows = [6, 8, 3, 0, 64, 150].map(|code| row(&m(code, None)));
        assert_eq!(
            rows,
            ["tool", "coolant", "spindle", "stop", "output", "other"]
        );
        assert_eq!(row(&EventKind::Dwell { seconds: 1.0 }), "dwell");
        assert_eq!(named(&m(64, Some(3.0)), &[]).label, "M64 P3 output on");
        assert_eq!(named(&m(150, None), &[]).label, "M150");
    }

    #[test]
    fn the_builders_names_go_first_and_the_most_exact_of_them() {
        let event = |p, label: &str| PlcEvent {
            code: 64,
            p,
            row: "lamp".into(),
            label: label.into(),
            takes_s: 0.0,
        };
        let events = [event(None, "some lamp"), event(Some(3), "red lamp")];
        let label = |p| named(&m(64, p), &events).label;
        assert_eq!(
            [Some(3.0), Some(1.0), None].map(label),
            ["red lamp", "some lamp", "some lamp"]
        );
        assert_eq!(named(&m(64, Some(1.0)), &events[1..]).row, "output");
    }
}
