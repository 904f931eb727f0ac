//! Sets `has_page` where the page in a browser was built (`web/page`): the command embeds it then.

use std::path::Path;

fn main() {
    println!("cargo::rustc-check-cfg=cfg(has_page)");
    if std::env::var_os("CARGO_FEATURE_COMMAND").is_none() {
        // The library, and so the engine of the page, does not depend on the page.
        println!("cargo::rerun-if-changed=build.rs");
        return;
    }
    println!("cargo::rerun-if-changed=assets/app");
    // The last file that `web/page` writes.
    if Path::new("assets/app/offline.js").exists() {
        println!("cargo::rustc-cfg=has_page");
    }
}
