//! Sweeps: the figures of `run`, content addresses, shards, and what is left when a sweep is killed
//! or the disk is full.

use std::collections::BTreeMap;
use std::path::PathBuf;
use std::process::Stdio;
use std::time::Duration;

use serde_json::Value;

use crate::command::{Folder, Ran, skipped};
use crate::json_keys;

const SQUARE: &str = "G21 G90 G64\nG1 X5 F1200\nG1 Y5\nG1 X0\nG1 Y0\nM2\n";
const CALLER: &str = "G21 G90 G64\nG1 X1 F1200\nO<side> call\nM2\n";
const SIDE: &str = "O<side> sub\nG1 Y4\nO<side> endsub\nM2\n";
/// Three programs, one of them with a mistake, on two machines with two controllers, and a single
/// job.
const JOBS: &str = "programs = ['circle.ngc', 'more/*.ngc']\nmachines = ['tnv40', 'mine.toml']\n\
    controllers = ['uncorrected', 'feedforward']\n[each]\ntolerance_um = 10\n\
    [[job]]\nprogram = 'circle.ngc'\nmachine = 'tnv40'\n";

fn folder() -> Folder {
    let folder = Folder::new();
    std::fs::create_dir(folder.path().join("more")).unwrap();
    folder.file("more/square.ngc", SQUARE);
    folder.file("more/wrong.ngc", "G1 X1 F100\nG2 X5 Y0 R1\nM2\n");
    folder.file(
        "mine.toml",
        "base = 'tnv40'\nname = 'mine'\naxis.x.kp_1_s = 40\n",
    );
    folder.file("JOBS.toml", JOBS);
    folder
}

/// The results in a folder, by the names of their files. Files under way come and go meanwhile.
fn results(folder: &Folder, out: &str) -> BTreeMap<String, Vec<u8>> {
    let entries = |folder: PathBuf| {
        std::fs::read_dir(folder)
            .into_iter()
            .flatten()
            .flatten()
            .map(|entry| entry.path())
    };
    let files = entries(folder.path().join(out)).flat_map(entries);
    let results = files.filter(|path| path.extension().is_some_and(|ending| ending == "json"));
    results
        .map(|path| {
            (
                path.file_name().unwrap().to_str().unwrap().to_owned(),
                std::fs::read(path).unwrap(),
            )
        })
        .collect()
}

fn swept(folder: &Folder, options: &[&str]) -> Ran {
    folder.run(&[&["sweep", "JOBS.toml"], options].concat())
}

fn value(text: &[u8]) -> Value {
    serde_json::from_slice(text).unwrap()
}

/// Selects the keys of a result that `run` does not write.
fn of_sweep(result: &Value) -> Value {
    let keys = ["format", "version", "address", "job", "error"];
    let of_result = keys
        .iter()
        .filter_map(|&key| Some((key.to_owned(), result.get(key)?.clone())));
    Value::Object(of_result.collect())
}

/// Results without what the clock says of the ticks, and what a sweep adds.
fn figures(mut result: Value) -> Value {
    for run in result["runs"].as_array_mut().unwrap() {
        for key in ["tick_median_us", "tick_p999_us"] {
            run.as_object_mut().unwrap().remove(key).unwrap();
        }
    }
    // The day on which the model was identified.
    for reported in ["/assumed/model_from", "/settings/Model"] {
        if let Some(Value::String(text)) = result.pointer_mut(reported)
            && let Some((before, "0")) = text
                .rsplit_once(", 2")
                .map(|(before, date)| (before, &date[..1]))
        {
            *text = before.to_owned();
        }
    }
    for key in ["job", "address"] {
        result.as_object_mut().unwrap().remove(key);
    }
    result
}

#[test]
fn a_job_has_the_figures_of_run_and_a_mistake_stops_no_other() {
    let folder = folder();
    let ran = swept(&folder, &["--out", "all"]);
    assert_eq!(
        (ran.code, ran.stdout.as_str()),
        (Some(1), "13 jobs: 13 computed, 0 found, 4 with mistakes\n")
    );
    assert!(
        ran.remarked().contains("more/wrong.ngc on tnv40")
            && ran.remarked().contains("1.000000 mm is too small"),
        "{ran:?}"
    );
    let all = results(&folder, "all");
    assert_eq!(all.len(), 13);
    for result in all.values().map(|text| value(text)) {
        let job = |key: &str| result["job"][key].as_str().unwrap().to_owned();
        json_keys::hold("sweep", &of_sweep(&result));
        if result.get("error").is_some() {
            assert_eq!(
                (
                    job("program").as_str(),
                    result["error"]["findings"][0]["line"].as_u64()
                ),
                ("more/wrong.ngc", Some(2))
            );
            continue;
        }
        let (program, machine, controller) = (job("program"), job("machine"), job("controller"));
        let cut = [
            "run",
            &program,
            "--machine",
            &machine,
            "--controller",
            &controller,
        ];
        let line = [
            &cut[..],
            &["--tolerance", "10", "--band", "0", "--json", "run.json"],
        ]
        .concat();
        folder.run(&line);
        let of_run = value(&folder.read("run.json"));
        assert_eq!(figures(result), figures(of_run), "{line:?}");
    }
    let again = swept(&folder, &["--out", "all"]);
    assert_eq!(
        (again.code, again.stdout.as_str()),
        (Some(1), "13 jobs: 0 computed, 13 found, 4 with mistakes\n")
    );
    assert_eq!(results(&folder, "all"), all);
}

#[test]
fn shards_and_workers_change_nothing_and_a_changed_list_moves_no_job() {
    let folder = folder();
    swept(&folder, &["--out", "one", "--workers", "1"]);
    let one = results(&folder, "one");
    swept(&folder, &["--out", "three", "--workers", "3"]);
    assert_eq!(results(&folder, "three"), one);
    let shard = |number: usize, out: &str| {
        swept(&folder, &["--out", out, "--shard", &format!("{number}/3")]);
        results(&folder, out)
    };
    let parts = [1, 2, 3].map(|number| shard(number, &format!("part{number}")));
    assert_eq!(parts.iter().map(BTreeMap::len).sum::<usize>(), one.len());
    assert_eq!(
        parts
            .clone()
            .into_iter()
            .flatten()
            .collect::<BTreeMap<_, _>>(),
        one
    );
    for (out, folders) in [
        ("one.csv", &["one"][..]),
        ("parts.csv", &["part1", "part2", "part3", "one"]),
    ] {
        folder
            .run(&[&["merge"], folders, &["--out", out]].concat())
            .succeeded();
    }
    let table = folder.text("one.csv");
    assert_eq!(
        (&table, table.lines().count()),
        (&folder.text("parts.csv"), 14)
    );
    let page =
        std::fs::read_to_string(concat!(env!("CARGO_MANIFEST_DIR"), "/../../docs/sweeps.md"))
            .unwrap();
    for column in table.lines().next().unwrap().split(',') {
        assert!(
            page.contains(&format!("`{column}`")),
            "docs/sweeps.md lacks the column {column}"
        );
    }
    // The folder is not part of a result.
    std::fs::create_dir(folder.path().join("elsewhere")).unwrap();
    let from_there = folder
        .command()
        .args(["sweep", "../JOBS.toml", "--out", "../there"])
        .current_dir(folder.path().join("elsewhere"))
        .output();
    assert_eq!(from_there.unwrap().status.code(), Some(1));
    assert_eq!(results(&folder, "there"), one);
    folder.file(
        "JOBS.toml",
        JOBS.replace("'circle.ngc', ", "")
            .replace("'uncorrected', ", ""),
    );
    let fewer = [1, 2, 3].map(|number| shard(number, &format!("fewer{number}")));
    for (part, fewer) in parts.iter().zip(&fewer) {
        assert!(
            fewer
                .iter()
                .all(|(name, text)| part.get(name) == Some(text))
        );
    }
    assert_eq!(fewer.iter().map(BTreeMap::len).sum::<usize>(), 5);
}

#[test]
fn the_address_follows_from_all_content_and_from_nothing_else() {
    let folder = folder();
    folder.file("more/wrong.ngc", CALLER);
    folder.file("more/side.ngc", SIDE);
    let jobs = |list: &str| folder.file("JOBS.toml", list);
    jobs(
        "[[job]]\nprogram = 'more/wrong.ngc'\nmachine = 'mine.toml'\ncontroller = 'uncorrected'\n",
    );
    let computed = || {
        swept(&folder, &["--out", "all"])
            .succeeded()
            .stdout
            .contains(" 1 computed")
    };
    assert!(computed() && !computed());
    folder.file("more/side.ngc", SIDE.replace("Y4", "Y5"));
    assert!(computed(), "a subroutine");
    folder.file(
        "mine.toml",
        "# A remark\nbase = 'tnv40'\nname = 'mine'\naxis.x.kp_1_s = 40\n",
    );
    folder.file("more/other.ngc", SQUARE);
    assert!(
        !computed(),
        "a remark in a machine file, a program that is not called"
    );
    folder.file(
        "mine.toml",
        "base = 'tnv40'\nname = 'mine'\naxis.x.kp_1_s = 41\n",
    );
    assert!(computed(), "a machine");
    folder.file("more/wrong.ngc", CALLER.replace("1200", "1300"));
    assert!(computed(), "a program");
    for key in [
        "seed = 2",
        "tolerance_um = 500.0",
        "feed_mm_s = 10.0",
        "against = 'feedforward'",
        "dialect = 'linuxcnc'",
    ] {
        jobs(&format!(
            "[[job]]\nprogram = 'more/wrong.ngc'\nmachine = 'mine.toml'\ncontroller = 'uncorrected'\n{key}\n"
        ));
        assert!(computed() && !computed(), "{key}");
    }
    // A damaged result counts as missing.
    for file in folder
        .content()
        .into_keys()
        .filter(|path| path.is_file() && path.starts_with(folder.path().join("all")))
    {
        std::fs::write(&file, &std::fs::read(&file).unwrap()[..100]).unwrap();
    }
    folder
        .run(&["merge", "all", "--out", "all.csv"])
        .refused(&["damaged", "sweep again"]);
    assert!(computed());
}

#[test]
fn what_a_list_cannot_mean_is_refused_before_anything_is_done() {
    let folder = folder();
    for (list, says) in [
        ("programs = ['none/*.ngc']", "none fits"),
        (
            "programs = ['circle.ngc']\nmachine = ['tnv40']",
            "unknown field `machine`",
        ),
        (
            "programs = ['circle.ngc']\ncontrollers = ['lqg']",
            "no controller is called 'lqg'",
        ),
        (
            "programs = ['circle.ngc']\nseeds = ['one']",
            "string \"one\"",
        ),
        (
            "programs = ['circle.ngc']\ncontrollers = ['uncorrected']\nsettings = [{ nothing = 1 }]",
            "nothing",
        ),
        ("[[job]]\nprogram = 'circle.ngc'\nfeed = 3", "[[job]] 1"),
        ("programs = ['circle.ngc'\n", "line"),
        ("", "no job"),
    ] {
        folder.file("JOBS.toml", list);
        swept(&folder, &["--out", "all"]).refused(&["JOBS.toml", says]);
        assert!(!folder.path().join("all").exists(), "{list}");
    }
    folder.file("JOBS.toml", JOBS);
    for shard in ["0/3", "4/3", "1", "a/b"] {
        swept(&folder, &["--out", "all", "--shard", shard]).refused(&["--shard", "3/8"]);
    }
    folder
        .run(&["merge", "nowhere", "--out", "all.csv"])
        .refused(&["nowhere: there is no such folder"]);
    folder
        .run(&["merge", "more", "--out", "all.parquet"])
        .refused(&["all.parquet does not say", "to_parquet"]);
    // A file that is not there is no result, and keeps no other job from being done.
    folder.file(
        "JOBS.toml",
        "[[job]]\nprogram = 'none.ngc'\n[[job]]\nprogram = 'circle.ngc'\ncontroller = 'uncorrected'\n",
    );
    swept(&folder, &["--out", "all"]).refused(&[
        "none.ngc: cannot be read",
        "2 jobs: 1 computed",
        "1 without a result",
    ]);
    assert_eq!(results(&folder, "all").len(), 1);
}

/// Needs 10 s of processor time: runs a sweep twice, and kills it between.
#[test]
fn a_sweep_that_is_killed_keeps_what_was_written_and_goes_on() {
    let folder = folder();
    let seeds: Vec<String> = (1..=60).map(|seed| seed.to_string()).collect();
    folder.file(
        "JOBS.toml",
        format!(
            "programs = ['circle.ngc', 'more/square.ngc']\ncontrollers = ['feedforward']\nseeds = [{}]\n",
            seeds.join(",")
        ),
    );
    let line = ["sweep", "JOBS.toml", "--out", "all"];
    let mut sweep = folder
        .command()
        .args(line)
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn()
        .unwrap();
    while results(&folder, "all").len() < 10 {
        std::thread::sleep(Duration::from_millis(5));
    }
    sweep.kill().unwrap();
    sweep.wait().unwrap();
    let kept = results(&folder, "all");
    assert!((10..120).contains(&kept.len()), "{}", kept.len());
    let reported = folder.run(&line).succeeded().stdout;
    assert_eq!(
        reported,
        format!(
            "120 jobs: {} computed, {} found\n",
            120 - kept.len(),
            kept.len()
        )
    );
    let all = results(&folder, "all");
    let half = folder
        .content()
        .into_keys()
        .find(|path| path.to_string_lossy().ends_with(".part"));
    assert_eq!((all.len(), half), (120, None));
    assert!(kept.iter().all(|(name, text)| &all[name] == text));
}

/// A command in a name space of its own, where the folder `small` is a disk of 64 KiB.
#[cfg(target_os = "linux")]
#[test]
fn a_full_disk_is_said_and_leaves_nothing_half_written() {
    let folder = folder();
    std::fs::create_dir(folder.path().join("small")).unwrap();
    let script = "mount -t tmpfs -o size=64k none small || exit 77\n\"$0\" sweep JOBS.toml --out small/all --workers 2\n\
        code=$?\ncp -r small/all kept\nexit $code";
    let command = folder.command();
    let mut unshare = std::process::Command::new("unshare");
    unshare
        .args(["--map-root-user", "--mount", "sh", "-c", script])
        .arg(command.get_program())
        .current_dir(folder.path());
    let Ok(ran) = unshare.output() else {
        return skipped("a full disk: no unshare");
    };
    let ran = Ran::from(ran);
    if ran.code == Some(77) || ran.stderr.contains("unshare failed") {
        return skipped("a full disk: no name spaces");
    }
    ran.refused(&["the sweep ended after", "No space left", "make room"]);
    let kept = results(&folder, "kept");
    assert!((1..13).contains(&kept.len()), "{:?}", kept.keys());
    let files: Vec<PathBuf> = folder
        .content()
        .into_keys()
        .filter(|path| path.to_string_lossy().ends_with(".part"))
        .collect();
    assert!(files.is_empty(), "{files:?}");
    for (name, text) in &kept {
        assert_eq!(value(text)["address"].as_str(), name.strip_suffix(".json"));
    }
}
