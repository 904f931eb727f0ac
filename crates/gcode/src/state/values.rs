//! Values of parameters that the interpreter itself keeps: modes, positions, variables of a
//! control.

use crate::canon::Plane;
use crate::state::Interpreter;
use crate::state::modal::{FeedMode, Modal};
use crate::state::parameters as numbers;
use crate::text::codes::AXIS_LETTERS;
use crate::text::codes::fanuc::OWN;
use crate::text::expression::ParameterSource;

impl Interpreter {
    /// The parameters that the interpreter itself keeps.
    fn predefined(&self, name: &[u8]) -> Option<f64> {
        let truth = |value: bool| f64::from(u8::from(value));
        let axis = |letter: u8| AXIS_LETTERS.iter().position(|&axis| axis == letter);
        Some(match name {
            [b'_', letter] if axis(*letter).is_some() => self.shown_position(axis(*letter)?),
            [b'_', b'a', b'b', b's', b'_', letter] if axis(*letter).is_some() => {
                let index = axis(*letter)?;
                if (3..6).contains(&index) {
                    self.here[index]
                } else {
                    self.here[index] / self.modal.unit_mm
                }
            }
            b"_vmajor" => 2.9,
            b"_vminor" => 0.0,
            b"_line" => f64::from(self.line),
            b"_ccomp" => {
                if self.compensates() {
                    410.0
                } else {
                    400.0
                }
            }
            b"_coord_system" => match self.frame.system {
                system @ 1..=6 => (530 + 10 * system) as f64,
                system => (584 + system) as f64,
            },
            b"_tool_offset" => truth(self.frame.tool != [0.0; 9]),
            b"_current_tool" => f64::from(self.tool.number),
            b"_selected_tool" => f64::from(self.tool.next),
            b"_current_pocket" => self
                .settings
                .tools
                .get(self.tool.number)
                .map_or(0.0, |tool| f64::from(tool.pocket)),
            b"_selected_pocket" => self
                .settings
                .tools
                .get(self.tool.next)
                .map_or(-1.0, |tool| f64::from(tool.pocket)),
            b"_value" => self.calls.returned.unwrap_or(0.0),
            b"_value_returned" => truth(self.calls.returned.is_some()),
            b"_call_level" => self.calls.level as f64,
            b"_task" => 0.0,
            b"_remap_level" => 0.0,
            _ => return self.modal.predefined(name),
        })
    }

    /// Why a variable of the control cannot be read.
    fn refuses_variable(&self, index: usize) -> Option<String> {
        let is_known = matches!(index, 0..=33 | 100..=999 | 4001 | 4003 | 4006 | 4014 | 4109 | 4119 | 4120
            | 5001..=5003 | 5021..=5023 | 5041..=5043 | 5061..=5070 | 5201..=5400);
        (!is_known).then(|| {
            format!("the variable #{index} is one of the control, whose value is not known here")
        })
    }

    /// Variables of the control: modes, positions.
    fn own_variable(&self, index: usize) -> Option<f64> {
        Some(match index {
            0 => f64::NAN,
            4001 => f64::from(self.modal.motion % OWN) / 10.0,
            4003 => {
                if self.modal.incremental {
                    91.0
                } else {
                    90.0
                }
            }
            4006 => {
                if self.modal.unit_mm == 1.0 {
                    21.0
                } else {
                    20.0
                }
            }
            4014 => 53.0 + self.frame.system as f64,
            4109 => self.modal.feed / self.modal.feed_unit_mm,
            4119 => self.modal.spindle_speed,
            4120 => f64::from(self.tool.number),
            5001..=5003 => self.shown_position(index - 5001),
            5041..=5043 => self.shown_position(index - 5041),
            5021..=5023 => {
                let factor = if index == 5021 && self.modal.diameter {
                    2.0
                } else {
                    1.0
                };
                factor * self.here[index - 5021] / self.modal.unit_mm
            }
            _ => return None,
        })
    }
}

impl Modal {
    /// The parameters that show modes.
    fn predefined(&self, name: &[u8]) -> Option<f64> {
        let truth = |value: bool| f64::from(u8::from(value));
        Some(match name {
            b"_motion_mode" => f64::from(self.motion),
            b"_plane" => match self.plane {
                Plane::Xy => 170.0,
                Plane::Zx => 180.0,
                Plane::Yz => 190.0,
            },
            b"_metric" => truth(self.unit_mm == 1.0),
            b"_imperial" => truth(self.unit_mm != 1.0),
            b"_absolute" => truth(!self.incremental),
            b"_incremental" => truth(self.incremental),
            b"_ijk_absolute_mode" => truth(self.arc_absolute),
            b"_inverse_time" => truth(self.feed_mode == FeedMode::Inverse),
            b"_units_per_minute" => truth(self.feed_mode == FeedMode::PerMinute),
            b"_units_per_rev" => truth(self.feed_mode == FeedMode::PerRevolution),
            b"_lathe_diameter_mode" => truth(self.diameter),
            b"_lathe_radius_mode" => truth(!self.diameter),
            b"_retract_r_plane" => truth(self.retract_to_r),
            b"_retract_old_z" => truth(!self.retract_to_r),
            b"_spindle_rpm_mode" => truth(self.constant_surface.is_none()),
            b"_spindle_css_mode" => truth(self.constant_surface.is_some()),
            b"_spindle_on" => truth(self.spindle_turns != 0),
            b"_spindle_cw" => truth(self.spindle_turns > 0),
            b"_mist" => truth(self.mist),
            b"_flood" => truth(self.flood),
            b"_speed_override" => truth(self.speed_override),
            b"_feed_override" => truth(self.feed_override),
            b"_adaptive_feed" => truth(self.adaptive_feed),
            b"_feed_hold" => truth(self.feed_hold),
            b"_feed" => match self.feed_mode {
                FeedMode::Inverse => self.feed,
                _ => self.feed / self.unit_mm,
            },
            b"_rpm" => self.spindle_speed,
            _ => return None,
        })
    }
}

impl ParameterSource for Interpreter {
    fn is_fanuc(&self) -> bool {
        self.dialect.is_fanuc()
    }

    fn refused(&self, index: usize) -> Option<String> {
        if self.dialect.is_fanuc() {
            self.refuses_variable(index)
        } else {
            None
        }
    }

    fn numbered(&self, index: usize) -> f64 {
        if self.dialect.is_fanuc()
            && let Some(value) = self.own_variable(index)
        {
            return value;
        }
        match index {
            numbers::POSITION_FIRST..=5428 => self.shown_position(index - numbers::POSITION_FIRST),
            _ => self.parameters.get(index),
        }
    }

    fn named(&self, name: &[u8]) -> Option<f64> {
        match self.parameters.named(name) {
            None if name.first() == Some(&b'_') => self.predefined(name),
            value => value,
        }
    }
}
