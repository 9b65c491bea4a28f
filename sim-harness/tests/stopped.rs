//! A command that is stopped at any moment: is the folder of its results the old one or the new one?

mod common;

use common::{Folder, RUN, another, reference};
use serde_json::Value;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::time::Instant;

/// What a folder holds by its path in it, but for the manifest, which has times.
fn content(folder: &Path) -> BTreeMap<PathBuf, Vec<u8>> {
    let mut found = BTreeMap::new();
    let mut folders = vec![folder.to_owned()];
    while let Some(next) = folders.pop() {
        for entry in std::fs::read_dir(&next).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                folders.push(path);
            } else if !path.ends_with("manifest.json") {
                found.insert(path.strip_prefix(folder).unwrap().to_owned(), std::fs::read(&path).unwrap());
            }
        }
    }
    found
}

/// The manifest lists what lies in its folder, with its size.
fn assert_listed(folder: &Path) {
    let manifest: Value = serde_json::from_slice(&std::fs::read(folder.join("manifest.json")).unwrap()).unwrap();
    let outputs = manifest["outputs"].as_array().unwrap().iter();
    let listed: BTreeMap<PathBuf, u64> =
        outputs.map(|file| (file["file"].as_str().unwrap().into(), file["bytes"].as_u64().unwrap())).collect();
    let found: BTreeMap<PathBuf, u64> =
        content(folder).into_iter().map(|(path, bytes)| (path, bytes.len() as u64)).collect();
    assert_eq!(listed, found);
}

fn spawned(folder: &Folder, arguments: &[&str]) -> Child {
    let mut command = Command::new(env!("CARGO_BIN_EXE_rundown"));
    command.current_dir(folder.path("")).args(arguments).stdout(Stdio::null()).stderr(Stdio::null());
    command.spawn().unwrap()
}

/// Kills the second command at moments spread over its time. After each the folder `out` is as one of both left it.
fn killed_at(kills: u32, folder: &Folder, old: &[&str], new: &[&str]) {
    let out = folder.path("out");
    folder.done(old);
    let old_content = content(&out);
    let begun = Instant::now();
    folder.done(new);
    let took = begun.elapsed();
    let new_content = content(&out);
    assert_ne!(old_content, new_content);
    let mut left = [0, 0];
    for kill in 0..kills {
        folder.done(old);
        let mut child = spawned(folder, new);
        // A little beyond the end, too: other tests may slow this one down.
        std::thread::sleep(took.mul_f64(1.1 * f64::from(kill) / f64::from(kills)));
        child.kill().unwrap();
        child.wait().unwrap();
        let found = content(&out);
        assert!(found == old_content || found == new_content, "kill {kill} of {kills}: {:?}", found.keys());
        assert_listed(&out);
        left[usize::from(found == new_content)] += 1;
    }
    assert!(left[0] > 0, "none of {kills} kills came before the end");
    folder.done(new);
    assert_eq!(content(&out), new_content);
    // Nothing that a killed command left is there any more.
    let hidden = |path: &PathBuf| path.file_name().unwrap().to_string_lossy().starts_with('.');
    let beside: Vec<PathBuf> = std::fs::read_dir(folder.path("")).unwrap().map(|entry| entry.unwrap().path()).collect();
    assert!(!beside.iter().any(hidden), "{beside:?}");
}

#[test]
fn a_replay_that_is_killed_leaves_the_old_results_or_the_new_ones() {
    let mut folder = Folder::new();
    for (name, number) in ["a", "b", "c", "d"].into_iter().zip(0..) {
        folder = folder.with(&format!("logs/{name}.csv"), &another(number));
    }
    let (train, track) = (reference("train.toml"), reference("track.toml"));
    let all = ["replay", "--train", &train, "--track", &track, "--out", "out"];
    killed_at(24, &folder, &[&all[..], &["--mode", "paper", "logs/a.csv"]].concat(), &[&all[..], &["logs"]].concat());
}

#[test]
fn a_simulation_that_is_killed_leaves_the_old_data_set_or_the_new_one() {
    let folder = Folder::new();
    let simulate = ["simulate", "--out", "out", "--force"];
    let more = [&simulate[..], &["--runs", "12"]].concat();
    killed_at(16, &folder, &[&simulate[..], &["--runs", "4", "--seed", "2"]].concat(), &more);
}

#[test]
fn an_import_that_is_killed_leaves_the_old_runs_or_the_new_ones() {
    let folder = Folder::new().with("a.csv", RUN).with("b.csv", RUN);
    killed_at(16, &folder, &["import", "a.csv", "--out", "out"], &["import", "b.csv", "--out", "out"]);
}

#[test]
fn a_replay_of_fewer_runs_leaves_no_estimates_of_the_others_and_files_of_others_alone() {
    let folder = Folder::new().with("logs/a.csv", RUN).with("logs/b.csv", &another(1)).with("out/notes.txt", "mine");
    assert_eq!(folder.replay(&["logs"]).code, Some(0));
    assert!(folder.path("out/b.estimates.csv").exists());
    assert_eq!(folder.replay(&["logs/a.csv"]).code, Some(0));
    assert!(!folder.path("out/b.estimates.csv").exists());
    assert_eq!(folder.read("out/notes.txt"), "mine");
    let manifest = folder.json("out/manifest.json");
    assert_eq!(manifest["command"], "replay");
    assert_eq!(manifest["arguments"][0], "replay");
    let inputs: Vec<&str> = manifest["inputs"].as_array().unwrap().iter().filter_map(|i| i["file"].as_str()).collect();
    assert_eq!(inputs, [&reference("train.toml"), &reference("track.toml"), "logs/a.csv"]);
}

/// Nothing usable: what is there stays.
#[test]
fn a_replay_without_a_usable_run_leaves_the_old_results() {
    let folder = Folder::new().with("a.csv", RUN).with("bad.csv", "time_s,location_m,speed_kmh\n0,x,0\n");
    assert_eq!(folder.replay(&["a.csv"]).code, Some(0));
    let before = content(&folder.path("out"));
    assert_ne!(folder.replay(&["bad.csv"]).code, Some(0));
    assert_eq!(content(&folder.path("out")), before);
    assert_listed(&folder.path("out"));
}

/// Another command that wrote into the folder since does not make its runs those of others.
#[test]
fn a_smaller_data_set_takes_the_place_of_a_larger_one_after_a_replay_into_the_same_folder() {
    let folder = Folder::new().with("logs/a.csv", RUN);
    let simulate = ["simulate", "--out", "out", "--force", "--runs"];
    folder.done(&[&simulate[..], &["4"]].concat());
    assert_eq!(folder.replay(&["logs"]).code, Some(0));
    folder.done(&[&simulate[..], &["2", "--seed", "9"]].concat());
    let names = |path: &str| std::fs::read_dir(folder.path(path)).unwrap().count();
    assert_eq!((names("out/runs"), names("out/truth")), (2 + 1, 2 + 2), "two runs and what belongs to them");
    assert!(folder.path("out/a.estimates.csv").exists(), "the replay stays");
}

#[test]
fn runs_beside_a_manifest_of_another_command_are_not_mixed_with_simulated_or_imported_ones() {
    let folder = Folder::new().with("logs/a.csv", RUN).with("out/runs/run009.csv", RUN).with("out/import.json", "{}");
    assert_eq!(folder.replay(&["logs"]).code, Some(0));
    for command in [&["simulate", "--out", "out", "--force"][..], &["import", "logs/a.csv", "--out", "out"]] {
        let said = folder.rundown(command);
        assert_eq!(said.code, Some(4), "{}", said.err);
        assert!(said.err.contains(&format!("a manifest.json of `rundown {}`", command[0])), "{}", said.err);
    }
}

#[test]
fn of_two_commands_into_one_folder_each_succeeds_or_names_the_other() {
    let folder = Folder::new();
    folder.done(&["simulate", "--out", "out", "--runs", "3"]);
    for round in 0..20 {
        let ended = std::thread::scope(|scope| {
            let one = |runs: &'static str| {
                let folder = &folder;
                scope.spawn(move || folder.rundown(&["simulate", "--out", "out", "--force", "--runs", runs]))
            };
            let both = [one("2"), one("3")];
            both.map(|thread| thread.join().unwrap())
        });
        for said in &ended {
            let is_named = said.code == Some(4) && said.err.contains("another rundown command is writing there");
            assert!(said.code == Some(0) || is_named, "round {round}: {:?} {}", said.code, said.err);
        }
        assert!(ended.iter().any(|said| said.code == Some(0)), "round {round}");
        assert_listed(&folder.path("out"));
        assert_eq!(std::fs::read_dir(folder.path("")).unwrap().count(), 1, "round {round}");
    }
}
