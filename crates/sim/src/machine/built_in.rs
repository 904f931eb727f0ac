//! Built-in machines: the machine files that the program contains, by name. A new one is a file in
//! `crates/sim/machines/` and a row here.

/// Machines that need no file: name and text.
pub const BUILT_IN_MACHINES: &[(&str, &str)] = &[
    ("tnv40", include_str!("../../machines/tnv40.toml")),
    ("heavy", include_str!("../../machines/heavy.toml")),
    ("sticky", include_str!("../../machines/sticky.toml")),
    ("rough", include_str!("../../machines/rough.toml")),
    ("soft", include_str!("../../machines/soft.toml")),
    ("coarse", include_str!("../../machines/coarse.toml")),
    ("workshop", include_str!("../../machines/workshop.toml")),
    ("stiff", include_str!("../../machines/stiff.toml")),
    ("router", include_str!("../../machines/router.toml")),
    ("emps", include_str!("../../machines/emps.toml")),
    ("sinumerik", include_str!("../../machines/sinumerik.toml")),
];

/// Machine that programs run on by default: of the built-in machines, the one most like a real
/// workshop machine.
pub const DEFAULT_MACHINE: &str = "workshop";
