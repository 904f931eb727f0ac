//! `--dialect` and `--increment` for programs of Fanuc and Haas, from the command line to what is
//! printed.

use crate::command::Folder;

#[test]
fn the_increment_is_an_option_and_its_absence_a_warning() {
    let folder = Folder::new();
    folder.file("part.nc", "O1\nG21 G90 G17 F100\nG1 X10000 Y0\nM30\n");
    let whole = folder.run(&["check", "part.nc"]);
    assert!(
        whole.stdout.contains("10000.000 mm of feed"),
        "{}",
        whole.stdout
    );
    assert!(
        whole
            .stderr
            .contains("no length of the program has a decimal point"),
        "{}",
        whole.stderr
    );
    assert!(
        whole.stderr.contains("--increment 0.001mm"),
        "{}",
        whole.stderr
    );
    let counted = folder.run(&["check", "part.nc", "--increment", "0.001mm"]);
    assert!(
        counted.stdout.contains("10.000 mm of feed"),
        "{}",
        counted.stdout
    );
    assert!(
        !counted.stderr.contains("decimal point"),
        "{}",
        counted.stderr
    );
    let wrong = folder.run(&["check", "part.nc", "--increment", "3mm"]);
    assert!(
        wrong.stderr.contains("'3mm' is no least input increment"),
        "{}",
        wrong.stderr
    );
}

#[test]
fn an_unclear_machine_is_an_error_and_an_option_decides() {
    let folder = Folder::new();
    folder.file(
        "part.nc",
        "O1\nG50 S2500\nG0 G43 H1 Z5.\nG1 X20. F100.\nM30\n",
    );
    let unclear = folder.run(&["check", "part.nc"]);
    assert!(
        unclear.stderr.contains("mill or for a lathe?")
            && unclear.stderr.contains("hint: say which"),
        "{}",
        unclear.stderr
    );
    assert!(unclear.stdout.is_empty(), "{}", unclear.stdout);
    let mill = folder.run(&["check", "part.nc", "--dialect", "fanuc-mill"]);
    assert!(
        mill.stdout
            .contains("read as Fanuc/Haas mill: as was asked for"),
        "{} {}",
        mill.stdout,
        mill.stderr
    );
}
