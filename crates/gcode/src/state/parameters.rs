//! Parameters of a program: numbered `#1`-`#5601`, named `#<local>` and `#<_global>`.
//!
//! Numbers 1-30 and names without a leading underscore belong to the subroutine call; all others
//! are global. The numbers with a meaning are those of RS-274/NGC (NISTIR 6556, section 3.2.1) as
//! LinuxCNC extends them.

use std::collections::HashMap;
use std::ops::Range;

use crate::text::expression::PARAMETERS;

/// `#1`-`#30` belong to the call.
pub(crate) const LOCALS: usize = 30;
/// `#1`-`#33` belong to the call of a macro of Fanuc.
pub(crate) const MACRO_LOCALS: usize = 33;
/// Named parameters that a program may have. Each costs about 100 bytes; a program that makes more
/// of them builds names in an endless loop.
const MAX_NAMES: usize = 100_000;

/// First of the nine coordinates that G28 goes to.
pub(crate) const HOME_1: usize = 5161;
/// First of the nine coordinates that G30 goes to.
pub(crate) const HOME_2: usize = 5181;
/// Parameter that is 1 while G92 is active.
pub(super) const G92_ACTIVE: usize = 5210;
/// First of the nine G92 offsets.
pub(super) const G92_FIRST: usize = 5211;
/// Number of the active coordinate system, 1-9.
pub(super) const SYSTEM: usize = 5220;
/// First number of coordinate system 1; the next systems follow at distance [`SYSTEM_STRIDE`]; the
/// tenth is its rotation.
pub(super) const SYSTEM_FIRST: usize = 5221;
/// Distance between the numbers of two coordinate systems.
pub(super) const SYSTEM_STRIDE: usize = 20;
/// First of the nine coordinates of a successful probe; the tenth says whether there was one.
pub(crate) const PROBE_FIRST: usize = 5061;
/// Result of M66.
pub(crate) const INPUT: usize = 5399;
/// Number of the tool in the spindle, then nine offsets, diameter, two angles, orientation.
pub(super) const TOOL_FIRST: usize = 5400;
/// Current position in the active coordinate system, computed when read.
pub(super) const POSITION_FIRST: usize = 5420;

/// Values of all parameters.
#[derive(Debug)]
pub(crate) struct ParameterTable {
    numbered: Vec<f64>,
    globals: HashMap<Vec<u8>, f64>,
    /// Named locals of each call level, the main program first.
    locals: Vec<HashMap<Vec<u8>, f64>>,
    names: usize,
}

impl ParameterTable {
    pub(super) fn new() -> Self {
        let mut numbered = vec![0.0; PARAMETERS];
        numbered[SYSTEM] = 1.0;
        Self {
            numbered,
            globals: HashMap::new(),
            locals: vec![HashMap::new()],
            names: 0,
        }
    }

    /// Value of `#index`; `index` is below [`PARAMETERS`].
    pub(super) fn get(&self, index: usize) -> f64 {
        self.numbered.get(index).copied().unwrap_or(0.0)
    }

    pub(crate) fn set(&mut self, index: usize, value: f64) {
        if let Some(slot) = self.numbered.get_mut(index) {
            *slot = value;
        }
    }

    /// Nine consecutive values.
    pub(crate) fn nine(&self, first: usize) -> [f64; 9] {
        std::array::from_fn(|axis| self.get(first + axis))
    }

    pub(crate) fn set_nine(&mut self, first: usize, values: [f64; 9]) {
        for (axis, value) in values.into_iter().enumerate() {
            self.set(first + axis, value);
        }
    }

    /// Value of the parameter called `name` (lower case, no blanks).
    pub(crate) fn named(&self, name: &[u8]) -> Option<f64> {
        self.scope(name).get(name).copied()
    }

    fn scope(&self, name: &[u8]) -> &HashMap<Vec<u8>, f64> {
        if name.first() == Some(&b'_') {
            &self.globals
        } else {
            self.locals.last().unwrap_or(&self.globals)
        }
    }

    /// Sets or makes the parameter called `name`; false when there are too many.
    pub(crate) fn set_named(&mut self, name: &[u8], value: f64) -> bool {
        let is_global = name.first() == Some(&b'_');
        let scope = match self.locals.last_mut() {
            Some(locals) if !is_global => locals,
            _ => &mut self.globals,
        };
        if let Some(slot) = scope.get_mut(name) {
            *slot = value;
        } else if self.names >= MAX_NAMES {
            return false;
        } else {
            scope.insert(name.to_vec(), value);
            self.names += 1;
        }
        true
    }

    /// Begins a call: the arguments become `#1`-`#30`; returns the caller's.
    pub(crate) fn enter(&mut self, arguments: &[f64]) -> [f64; MACRO_LOCALS] {
        self.locals.push(HashMap::new());
        let saved = self.local_numbers();
        self.set_locals(arguments);
        saved
    }

    /// Gives the locals values, from `#1` on.
    pub(crate) fn set_locals(&mut self, values: &[f64]) {
        self.numbered[1..=values.len()].copy_from_slice(values);
    }

    /// Ends a call: `saved` is what `enter` returned, as far as it belongs to the call.
    pub(crate) fn leave(&mut self, saved: &[f64]) {
        if self.locals.len() > 1 {
            self.names -= self.locals.pop().map_or(0, |scope| scope.len());
        }
        self.set_locals(saved);
    }

    /// `#1`-`#33`.
    fn local_numbers(&self) -> [f64; MACRO_LOCALS] {
        std::array::from_fn(|n| self.get(n + 1))
    }
}

/// Variables that are vacant when a program begins.
const VACANT: [Range<usize>; 3] = [1..34, 100..200, 500..1000];

impl ParameterTable {
    /// Variables of macros begin without a value.
    pub(super) fn empty_variables(&mut self) {
        for index in VACANT.into_iter().flatten() {
            self.set(index, f64::NAN);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_call_has_its_own_locals_and_shares_globals() {
        let mut parameters = ParameterTable::new();
        parameters.set(1, 7.0);
        parameters.set(31, 8.0);
        parameters.set_named(b"a", 1.0);
        parameters.set_named(b"_g", 2.0);
        let saved = parameters.enter(&[5.0; LOCALS]);
        assert_eq!((parameters.get(1), parameters.get(31)), (5.0, 8.0));
        assert_eq!(
            (parameters.named(b"a"), parameters.named(b"_g")),
            (None, Some(2.0))
        );
        parameters.leave(&saved[..LOCALS]);
        assert_eq!(
            (parameters.get(1), parameters.named(b"a")),
            (7.0, Some(1.0))
        );
    }

    #[test]
    fn names_are_limited() {
        let mut parameters = ParameterTable::new();
        assert!((0..MAX_NAMES).all(|n| parameters.set_named(format!("n{n}").as_bytes(), 0.0)));
        assert!(!parameters.set_named(b"one_more", 0.0));
        assert!(parameters.set_named(b"n5", 3.0));
    }
}
