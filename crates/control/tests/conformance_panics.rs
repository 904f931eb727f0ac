//! No panic is left in a tick once it is linked: of every controller, in two and in three axes.

#![cfg(target_os = "linux")]
use std::process::Command;

/// Links `tests/linked_tick`, where the handler of a panic cannot be linked.
fn link(more: &[&str]) -> Result<(), String> {
    let output = Command::new(env!("CARGO"))
        .args([
            "rustc",
            "--release",
            "--locked",
            "--quiet",
            "--color",
            "never",
        ])
        .args([
            "--manifest-path",
            concat!(env!("CARGO_MANIFEST_DIR"), "/tests/linked_tick/Cargo.toml"),
        ])
        .args([
            "--target-dir",
            concat!(env!("CARGO_TARGET_TMPDIR"), "/linked_tick"),
        ])
        .args(more)
        // A library may leave symbols open, but for this; what the compiler copies memory with is
        // in the C library.
        .args(["--", "-C", "link-arg=-Wl,-z,defs", "-C", "link-arg=-lc"])
        .output()
        .unwrap();
    if output.status.success() {
        Ok(())
    } else {
        Err(String::from_utf8_lossy(&output.stderr).into_owned())
    }
}

#[test]
fn no_panic_is_left_in_a_tick_and_one_would_be_found() {
    link(&[]).unwrap();
    let message = link(&["--features", "one-panic"]).unwrap_err();
    assert!(message.contains("a_panic_is_left_in_the_tick"), "{message}");
}
