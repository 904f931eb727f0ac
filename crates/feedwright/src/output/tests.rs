//! Whole or not at all, whatever goes wrong.

use miette::Diagnostic;

use super::*;

fn names(folder: &Path) -> Vec<String> {
    let mut names: Vec<String> = fs::read_dir(folder)
        .unwrap()
        .map(|entry| entry.unwrap().file_name().to_string_lossy().into_owned())
        .collect();
    names.sort();
    names
}

fn start(path: &Path) -> OutputFile {
    OutputFiles::default().start(path).unwrap()
}

fn refusal(path: &Path, inputs: &[&Path]) -> OutputError {
    OutputFiles::new(inputs.iter().copied())
        .start(path)
        .err()
        .expect("the output is refused")
}

#[test]
fn the_target_appears_on_commit_and_not_before() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("trace.csv");
    let mut file = start(&path);
    file.write_all(b"t_s\n").unwrap();
    assert!(!path.exists());
    file.commit().unwrap();
    assert_eq!(fs::read(&path).unwrap(), b"t_s\n");
    assert_eq!(names(folder.path()), ["trace.csv"]);
}

#[test]
fn a_dropped_output_leaves_the_old_file_and_nothing_else() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("trace.csv");
    fs::write(&path, "old").unwrap();
    let mut file = start(&path);
    file.write_all(&vec![b'x'; 3 * BUFFER_BYTES]).unwrap();
    assert_eq!(names(folder.path()).len(), 2);
    drop(file);
    assert_eq!(names(folder.path()), ["trace.csv"]);
    assert_eq!(fs::read(&path).unwrap(), b"old");
}

#[test]
fn an_end_from_outside_leaves_the_old_files_and_nothing_else() {
    struct Ended;
    impl Watch for Ended {
        fn is_cancelled(&self) -> bool {
            true
        }
    }
    let folder = tempfile::tempdir().unwrap();
    let [old, new] = ["old.csv", "new.csv"].map(|name| folder.path().join(name));
    fs::write(&old, "old").unwrap();
    let mut files = OutputFiles::default();
    let files = [&old, &new].map(|path| files.start(path).unwrap());
    assert!(matches!(
        OutputFile::commit_all(files.into(), &Ended),
        Err(OutputError::Cancelled(_))
    ));
    assert_eq!(names(folder.path()), ["old.csv"]);
    assert_eq!(fs::read(&old).unwrap(), b"old");
}

#[test]
fn a_panic_leaves_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("trace.csv");
    let panicked = std::panic::catch_unwind(|| {
        let mut file = start(&path);
        file.write_all(b"half").unwrap();
        panic!("in the middle");
    });
    assert!(panicked.is_err());
    assert!(names(folder.path()).is_empty());
    start(&path).commit().unwrap();
}

#[test]
fn targets_that_are_no_files_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    assert!(matches!(
        refusal(folder.path(), &[]),
        OutputError::IsDirectory { .. }
    ));
    assert!(matches!(
        refusal(&folder.path().join("new/"), &[]),
        OutputError::IsDirectory { .. }
    ));
    let missing = refusal(&folder.path().join("none/trace.csv"), &[]);
    assert!(
        missing
            .help()
            .unwrap()
            .to_string()
            .starts_with("create the directory first: mkdir -p "),
        "{missing}"
    );
    fs::write(folder.path().join("file"), "").unwrap();
    assert!(matches!(
        refusal(&folder.path().join("file/trace.csv"), &[]),
        OutputError::Io {
            step: FileOperation::Create,
            ..
        }
    ));
}

#[test]
fn inputs_are_never_replaced_even_through_links() {
    let folder = tempfile::tempdir().unwrap();
    let input = folder.path().join("part.ngc");
    fs::write(&input, "G0 X1").unwrap();
    assert!(matches!(
        refusal(&input, &[&input]),
        OutputError::IsInput { .. }
    ));
    let detour = folder
        .path()
        .join("../")
        .join(folder.path().file_name().unwrap())
        .join("part.ngc");
    assert!(matches!(
        refusal(&detour, &[&input]),
        OutputError::IsInput { .. }
    ));
    #[cfg(unix)]
    {
        let link = folder.path().join("link.ngc");
        std::os::unix::fs::symlink(&input, &link).unwrap();
        assert!(matches!(
            refusal(&link, &[&input]),
            OutputError::IsInput { .. }
        ));
    }
}

#[test]
fn two_outputs_do_not_share_a_target() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("same.csv");
    let mut files = OutputFiles::default();
    files.start(&path).unwrap().commit().unwrap();
    assert!(matches!(
        files.start(&path).err(),
        Some(OutputError::Twice { .. })
    ));
}

/// A link is followed whether its file exists or not.
#[cfg(unix)]
#[test]
fn a_link_to_a_file_that_does_not_exist_is_followed() {
    let folder = tempfile::tempdir().unwrap();
    let place = |name: &str| folder.path().join(name);
    fs::create_dir(place("inner")).unwrap();
    std::os::unix::fs::symlink("inner/next", place("link")).unwrap();
    std::os::unix::fs::symlink("real", place("inner/next")).unwrap();
    let mut file = start(&place("link"));
    file.write_all(b"new").unwrap();
    OutputFile::commit_all(vec![file], &()).unwrap();
    assert_eq!(fs::read(place("inner/real")).unwrap(), b"new");
    assert!(
        ["link", "inner/next"]
            .iter()
            .all(|link| fs::symlink_metadata(place(link)).unwrap().is_symlink())
    );
    for (from, to) in [("a", "b"), ("b", "a")] {
        std::os::unix::fs::symlink(place(to), place(from)).unwrap();
    }
    assert!(
        refusal(&place("a"), &[])
            .to_string()
            .contains("too many symbolic links")
    );
    std::os::unix::fs::symlink("none/file", place("lost")).unwrap();
    assert!(
        matches!(refusal(&place("lost"), &[]), OutputError::Io { hint: Some(hint), .. } if hint.contains("none"))
    );
}

#[cfg(unix)]
#[test]
fn a_link_is_followed_and_permissions_are_kept() {
    use std::os::unix::fs::PermissionsExt;
    let folder = tempfile::tempdir().unwrap();
    let (real, link) = (
        folder.path().join("real.csv"),
        folder.path().join("link.csv"),
    );
    fs::write(&real, "old").unwrap();
    fs::set_permissions(&real, fs::Permissions::from_mode(0o640)).unwrap();
    std::os::unix::fs::symlink(&real, &link).unwrap();
    let mut file = start(&link);
    file.write_all(b"new").unwrap();
    file.commit().unwrap();
    assert_eq!(fs::read(&real).unwrap(), b"new");
    assert!(fs::symlink_metadata(&link).unwrap().is_symlink());
    assert_eq!(
        fs::metadata(&real).unwrap().permissions().mode() & 0o777,
        0o640
    );
}

#[cfg(target_os = "linux")]
#[test]
fn a_full_device_is_reported_by_name() {
    let mut file = start(Path::new("/dev/full"));
    file.write_all(&vec![0; 2 * BUFFER_BYTES]).unwrap();
    let error = OutputFile::commit_all(vec![file], &()).unwrap_err();
    let text = error.to_string();
    assert!(
        text.starts_with("cannot write /dev/full: No space left on device"),
        "{text}"
    );
    // What is free in the folder around a device says nothing about it.
    assert!(
        !text.contains("bytes are free there") && error.help().is_none(),
        "{text}"
    );
}

#[cfg(target_os = "linux")]
#[test]
fn a_full_disk_leaves_neither_file_nor_temporary() {
    let folder = tempfile::tempdir().unwrap();
    let mounted = std::process::Command::new("mount")
        .args(["-t", "tmpfs", "-o", "size=64k", "tmpfs"])
        .arg(folder.path())
        .output()
        .is_ok_and(|output| output.status.success());
    if !mounted {
        eprintln!("SKIPPED: a full disk needs the right to mount a tmpfs; run as root to test it");
        return;
    }
    let path = folder.path().join("trace.csv");
    let mut file = start(&path);
    let error = (0..64).find_map(|_| file.write_all(&[b'x'; 8192]).err());
    drop(file);
    let left = names(folder.path());
    std::process::Command::new("umount")
        .arg(folder.path())
        .status()
        .unwrap();
    let error = OutputError::from_io(error.expect("256 KiB do not fit into 64 KiB"), &path);
    assert!(
        matches!(&error, OutputError::Io { free_bytes: Some(free), .. } if *free < 65536),
        "{error:?}"
    );
    assert!(left.is_empty(), "{left:?}");
}

#[cfg(unix)]
#[test]
fn what_a_killed_process_left_is_removed_and_what_another_one_writes_is_not() {
    let folder = tempfile::tempdir().unwrap();
    let abandoned = folder.path().join(".feedwright-a1b2c3.part");
    fs::write(&abandoned, "half").unwrap();
    fs::write(folder.path().join(".feedwright-notes"), "of somebody else").unwrap();
    let under_way = start(&folder.path().join("first.csv"));
    assert!(!abandoned.exists());
    let second = start(&folder.path().join("second.csv"));
    assert_eq!(names(folder.path()).len(), 3);
    OutputFile::commit_all(vec![under_way, second], &()).unwrap();
    assert_eq!(
        names(folder.path()),
        [".feedwright-notes", "first.csv", "second.csv"]
    );
}

#[test]
fn nothing_goes_to_a_device_before_all_is_complete() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("pipe");
    let made = std::process::Command::new("mkfifo")
        .arg(&path)
        .status()
        .is_ok_and(|status| status.success());
    if !made {
        eprintln!("SKIPPED: no pipe can be made");
        return;
    }
    let reader = std::thread::spawn({
        let path = path.clone();
        move || fs::read(path).unwrap()
    });
    let mut dropped = start(&path);
    dropped.write_all(&vec![b'x'; 3 * BUFFER_BYTES]).unwrap();
    drop(dropped);
    assert_eq!(reader.join().unwrap(), b"");
    assert!(matches!(
        {
            let mut files = OutputFiles::default();
            let first = files.start(Path::new("-")).unwrap();
            (files.start(Path::new("-")).err(), first)
        },
        (Some(OutputError::Twice { .. }), _)
    ));
}
