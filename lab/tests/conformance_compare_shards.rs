//! `feedwright-lab compare` in parts: shards merge to the bytes of the undivided run, and what cannot be merged is said.

use crate::command::Folder;

const ONLY: [&str; 4] = ["--tuning", "defaults", "--only", "circle,tnv40,rough,uncorrected,feedforward"];

fn with<'a>(first: &[&'a str], more: &[&'a str]) -> Vec<&'a str> {
    [first, &ONLY, more].concat()
}

#[test]
fn shards_merge_to_the_bytes_of_the_undivided_run() {
    let folder = Folder::new();
    folder.run(&with(&["compare"], &["--json", "whole.json", "--html", "whole.html"])).succeeded();
    for shard in ["1/2", "2/2"] {
        let rows = format!("{}.jsonl", &shard[..1]);
        folder.run(&with(&["compare"], &["--shard", shard, "--rows", &rows])).succeeded();
    }
    let merged = ["--merge", "1.jsonl,2.jsonl", "--json", "merged.json", "--html", "merged.html"];
    folder.run(&with(&["compare"], &merged)).succeeded();
    assert_eq!(folder.read("whole.json"), folder.read("merged.json"));
    assert_eq!(folder.read("whole.html"), folder.read("merged.html"));

    folder.run(&with(&["compare"], &["--merge", "1.jsonl"])).refused(&["not complete", "feedforward on tnv40: 1 of 1"]);
    folder.run(&with(&["compare"], &["--seed", "2", "--merge", "1.jsonl"])).refused(&["1.jsonl", "other options"]);
    folder.run(&with(&["compare"], &["--merge", "whole.json"])).refused(&["whole.json is no file of rows"]);
}

#[test]
fn a_shard_without_a_place_for_its_rows_and_one_that_is_none_are_refused() {
    let folder = Folder::new();
    folder.run(&with(&["compare"], &["--shard", "1/2"])).refused(&["--rows FILE"]);
    folder.run(&with(&["compare"], &["--shard", "3/2", "--rows", "r.jsonl"])).refused(&["i from 1 to n"]);
}
