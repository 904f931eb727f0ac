//! Tests that `components/feedwright.h` is the header that cbindgen generates from `hal/`. With
//! FEEDWRIGHT_UPDATE_DOCUMENTS set, writes the file.

use std::path::Path;

#[test]
fn the_header_agrees_with_the_library() {
    let here = Path::new(env!("CARGO_MANIFEST_DIR"));
    let (library, header) = (here.join("../hal"), here.join("../components/feedwright.h"));
    let made = cbindgen::generate(library).expect("a header");
    let mut text = Vec::new();
    made.write(&mut text);
    if std::env::var_os("FEEDWRIGHT_UPDATE_DOCUMENTS").is_some() {
        std::fs::write(&header, &text).expect("it is written");
    }
    let kept = std::fs::read(&header).expect("it is there");
    assert!(
        kept == text,
        "FEEDWRIGHT_UPDATE_DOCUMENTS=1 cargo test -p feedwright-servo --test golden_header writes it anew"
    );
}
