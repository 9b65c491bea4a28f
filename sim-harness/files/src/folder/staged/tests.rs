use super::*;
use tempfile::TempDir;

/// What a folder holds, but for the manifest.
fn content(out: &Path) -> Vec<(String, String)> {
    let files = entries(out).unwrap().into_iter().filter(|path| path != Path::new(MANIFEST));
    files.map(|path| (path.display().to_string(), fs::read_to_string(out.join(&path)).unwrap())).collect()
}

fn expected(files: &[(&str, &str)]) -> Vec<(String, String)> {
    files.iter().map(|(name, text)| ((*name).to_owned(), (*text).to_owned())).collect()
}

fn fill(folder: &Path, files: &[(&str, &str)]) {
    for (name, text) in files {
        let path = folder.join(name);
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        fs::write(path, text).unwrap();
    }
}

fn begun(out: &Path, files: &[(&str, &str)]) -> Staged {
    let staged = Staged::begin("replay", out).unwrap();
    fill(staged.path(), files);
    staged
}

fn written(out: &Path, files: &[(&str, &str)]) {
    begun(out, files).done(&Provenance::begin(&[])).unwrap();
}

/// Stops here, as a command that is killed: nothing is cleaned up, and the lock is gone.
fn killed(mut staged: Staged) -> PathBuf {
    let (folder, lock) = (std::mem::take(&mut staged.folder), staged._lock.take());
    drop(lock);
    std::mem::forget(staged);
    folder
}

const OLD: [(&str, &str); 3] = [("a.csv", "old a"), ("deep/b.csv", "old b"), ("stale.csv", "old")];
const NEW_FILES: [(&str, &str); 3] = [("a.csv", "new a"), ("deep/b.csv", "new b"), ("more.csv", "new")];

fn names_beside(place: &TempDir) -> Vec<String> {
    let mut names: Vec<String> =
        fs::read_dir(place.path()).unwrap().map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
    names.sort();
    names
}

#[test]
fn new_results_replace_all_of_the_old_ones() {
    let place = TempDir::new().unwrap();
    let out = place.path().join("above/out");
    written(&out, &OLD);
    assert_eq!(content(&out), expected(&OLD));
    written(&out, &NEW_FILES);
    assert_eq!(content(&out), expected(&NEW_FILES));
    assert_eq!(fs::read_dir(place.path().join("above")).unwrap().count(), 1);
}

#[test]
fn files_of_others_and_of_other_commands_stay() {
    let place = TempDir::new().unwrap();
    let out = place.path().join("out");
    written(&out, &OLD);
    fill(&out, &[("notes.txt", "mine"), ("deep/mine.csv", "mine")]);
    written(&out, &NEW_FILES);
    let mut all = expected(&NEW_FILES);
    all.extend(expected(&[("notes.txt", "mine"), ("deep/mine.csv", "mine")]));
    all.sort();
    assert_eq!(content(&out), all);
    let other = Staged::begin("gap", &out).unwrap();
    fill(other.path(), &[("gap.json", "gap")]);
    other.done(&Provenance::begin(&[])).unwrap();
    all.extend(expected(&[("gap.json", "gap")]));
    all.sort();
    assert_eq!(content(&out), all);
    assert_eq!(names_beside(&place), ["out"]);
}

#[test]
fn a_command_that_is_killed_while_it_writes_leaves_the_old_results_and_the_next_one_cleans_up() {
    let place = TempDir::new().unwrap();
    let out = place.path().join("out");
    written(&out, &OLD);
    let left = killed(begun(&out, &NEW_FILES[..1]));
    assert!(left.is_dir());
    assert_eq!(content(&out), expected(&OLD));
    written(&out, &NEW_FILES);
    assert_eq!(content(&out), expected(&NEW_FILES));
    assert_eq!(names_beside(&place), ["out"]);
}

#[test]
fn one_that_is_killed_after_the_exchange_leaves_the_new_results() {
    let place = TempDir::new().unwrap();
    let out = place.path().join("out");
    written(&out, &NEW_FILES);
    fs::rename(&out, place.path().join("new")).unwrap();
    written(&out, &OLD);
    exchange(&place.path().join("new"), &out).unwrap();
    fs::rename(place.path().join("new"), place.path().join(".out.rundown-new")).unwrap();
    assert_eq!(content(&out), expected(&NEW_FILES));
    drop(Staged::begin("replay", &out).unwrap());
    assert_eq!(content(&out), expected(&NEW_FILES));
    assert_eq!(names_beside(&place), ["out"]);
}

/// Results among files of others are moved one by one: killed after each of the steps, the next command ends it.
#[test]
fn one_that_is_killed_among_files_of_others_is_brought_to_its_end() {
    for moved in 0..=NEW_FILES.len() + 1 {
        let place = TempDir::new().unwrap();
        let out = place.path().join("out");
        written(&out, &OLD);
        fill(&out, &[("notes.txt", "mine")]);
        let staged = begun(&out, &NEW_FILES);
        let files = entries(staged.path()).unwrap();
        let manifest = Provenance::begin(&[]).manifest("replay", staged.path(), &files, Vec::new()).unwrap();
        fs::write(staged.path().join(MANIFEST), manifest).unwrap();
        let left = killed(staged);
        fs::rename(left, out.join(READY)).unwrap();
        for name in files.iter().map(PathBuf::as_path).chain([Path::new(MANIFEST)]).take(moved) {
            fs::create_dir_all(out.join(name).parent().unwrap()).unwrap();
            fs::rename(out.join(READY).join(name), out.join(name)).unwrap();
        }
        if moved > NEW_FILES.len() {
            // The manifest goes last: what was stale is gone by then.
            fs::remove_file(out.join("stale.csv")).unwrap();
        }
        drop(Staged::begin("replay", &out).unwrap());
        let mut all = expected(&NEW_FILES);
        all.extend(expected(&[("notes.txt", "mine")]));
        all.sort();
        assert_eq!(content(&out), all, "after {moved} files");
        assert_eq!(names_beside(&place), ["out"]);
    }
}

#[test]
fn a_folder_in_the_way_of_a_file_is_named_and_nothing_changes() {
    let place = TempDir::new().unwrap();
    let out = place.path().join("out");
    written(&out, &OLD);
    fill(&out, &[("more.csv/mine.txt", "mine")]);
    let before = content(&out);
    let error = begun(&out, &NEW_FILES).done(&Provenance::begin(&[])).unwrap_err();
    assert!(error.to_string().contains("more.csv is a folder and lies in the way"), "{error}");
    assert_eq!(content(&out), before);
    assert_eq!(names_beside(&place), ["out"]);
}

#[test]
fn a_manifest_of_others_a_file_as_folder_and_a_second_writer_are_refused() {
    let place = TempDir::new().unwrap();
    let out = place.path().join("out");
    let refused = |out: &Path| Staged::begin("replay", out).unwrap_err().to_string();
    fill(&out, &[(MANIFEST, "{\"name\": \"my web page\"}")]);
    assert!(refused(&out).contains("expected no manifest.json there, or one of rundown"));
    fill(&out, &[(MANIFEST, "{\"command\": \"replay\", \"outputs\": [{\"file\": \"../passwords\"}]}")]);
    assert!(refused(&out).contains("found another one"));
    let file = out.join(MANIFEST);
    assert!(refused(&file.join("deeper")).contains("manifest.json is a file"));
    let free = place.path().join("free");
    let first = begun(&free, &OLD);
    assert!(refused(&free).contains("another rundown command is writing there"));
    first.done(&Provenance::begin(&[])).unwrap();
    assert_eq!(content(&free), expected(&OLD));
}

#[test]
fn a_link_to_a_folder_stays_one() {
    let place = TempDir::new().unwrap();
    let (real, link) = (place.path().join("real"), place.path().join("link"));
    fs::create_dir(&real).unwrap();
    #[cfg(unix)]
    {
        std::os::unix::fs::symlink(&real, &link).unwrap();
        written(&link, &OLD);
        written(&link, &NEW_FILES);
        assert!(link.is_symlink());
        assert_eq!(content(&real), expected(&NEW_FILES));
    }
}

#[test]
fn the_manifest_lists_every_file_with_its_digest() {
    let place = TempDir::new().unwrap();
    let out = place.path().join("out");
    let (input, nowhere) = (place.path().join("in.csv"), place.path().join("nowhere.csv"));
    fs::write(&input, "abc").unwrap();
    let provenance = Provenance::begin(&[input, nowhere]);
    let staged = begun(&out, &[("deep/b.csv", "abc")]);
    staged.done(&provenance).unwrap();
    let manifest: serde_json::Value = serde_json::from_str(&fs::read_to_string(out.join(MANIFEST)).unwrap()).unwrap();
    // SHA-256 of "abc" as FIPS 180-4 gives it.
    let digest = "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad";
    assert_eq!(manifest["outputs"], serde_json::json!([{ "file": "deep/b.csv", "bytes": 3, "sha256": digest }]));
    assert_eq!((&manifest["inputs"][0]["sha256"], &manifest["inputs"][0]["bytes"]), (&digest.into(), &3.into()));
    assert!(manifest["inputs"][1]["sha256"].is_null());
    let time = |name: &str| manifest[name].as_str().unwrap().parse::<jiff::Timestamp>().unwrap();
    assert!(time("started") <= time("ended"));
}

fn written_by(command: &str, out: &Path, files: &[(&str, &str)]) {
    let staged = Staged::begin(command, out).unwrap();
    fill(staged.path(), files);
    staged.done(&Provenance::begin(&[])).unwrap();
}

/// Whichever command wrote last, each knows which files are its own.
#[test]
fn stale_files_go_after_another_command_wrote_there_and_files_that_it_replaced_are_its_own() {
    let place = TempDir::new().unwrap();
    let out = place.path().join("out");
    written_by("replay", &out, &[("a.csv", "old a"), ("b.csv", "old b"), ("report.html", "replay")]);
    written_by("check", &out, &[("check.json", "check"), ("report.html", "check")]);
    written_by("gap", &out, &[("gap.json", "gap")]);
    written_by("replay", &out, &[("a.csv", "new a")]);
    let all = expected(&[("a.csv", "new a"), ("check.json", "check"), ("gap.json", "gap"), ("report.html", "check")]);
    assert_eq!(content(&out), all);
    written_by("check", &out, &[("check.json", "new")]);
    assert_eq!(content(&out), expected(&[("a.csv", "new a"), ("check.json", "new"), ("gap.json", "gap")]));
    let manifest: serde_json::Value = serde_json::from_str(&fs::read_to_string(out.join(MANIFEST)).unwrap()).unwrap();
    let earlier = manifest["earlier"].as_array().unwrap().iter();
    let mut earlier: Vec<(&str, &str)> =
        earlier.map(|of| (of["command"].as_str().unwrap(), of["outputs"][0]["file"].as_str().unwrap())).collect();
    earlier.sort_unstable();
    assert_eq!(earlier, [("gap", "gap.json"), ("replay", "a.csv")]);
    assert!(manifest["earlier"][0]["earlier"].is_null(), "{manifest:#}");
}

/// A command whose results are in place has no claim to the name that it used before.
#[test]
fn the_end_of_a_command_leaves_the_work_of_the_next_one_alone() {
    let place = TempDir::new().unwrap();
    let out = place.path().join("out");
    for others in [None, None, Some(("notes.txt", "mine"))] {
        fill(&out, others.as_slice());
        let mut first = begun(&out, &OLD);
        let files = entries(&first.folder).unwrap();
        first.put(&Provenance::begin(&[]), &files).unwrap();
        let second = begun(&out, &NEW_FILES);
        drop(first);
        assert!(second.path().join("more.csv").exists());
        second.done(&Provenance::begin(&[])).unwrap();
        let mut found = content(&out);
        found.retain(|(name, _)| name != "notes.txt");
        assert_eq!(found, expected(&NEW_FILES));
    }
}

/// Each ends with its results or the refusal that names the other; what is in place belongs together.
#[test]
fn commands_that_overlap_do_not_remove_the_work_of_one_another() {
    for others in [false, true] {
        let place = TempDir::new().unwrap();
        let out = place.path().join("out");
        if others {
            fill(&out, &[("notes.txt", "mine")]);
        }
        let one = |writer: usize| {
            let mut done = 0;
            for round in 0..100 {
                let text = format!("{writer} {round}");
                let ended = Staged::begin("replay", &out).and_then(|staged| {
                    for name in ["a.csv", "b.csv", "c/d.csv"] {
                        let path = staged.path().join(name);
                        fs::create_dir_all(path.parent().unwrap()).unwrap();
                        fs::write(&path, &text).unwrap();
                    }
                    staged.done(&Provenance::begin(&[]))
                });
                match ended {
                    Ok(()) => done += 1,
                    Err(error) => assert!(error.to_string().contains("another rundown command is writing"), "{error}"),
                }
            }
            done
        };
        let done: usize = std::thread::scope(|scope| {
            let writers: Vec<_> = (0..3)
                .map(|writer| {
                    scope.spawn({
                        let one = &one;
                        move || one(writer)
                    })
                })
                .collect();
            writers.into_iter().map(|writer| writer.join().unwrap()).sum()
        });
        assert!(done > 0);
        let mut found = content(&out);
        found.retain(|(name, _)| name != "notes.txt");
        assert_eq!(found.len(), 3, "{found:?}");
        assert!(found.iter().all(|(_, text)| *text == found[0].1), "{found:?}");
        assert_eq!(names_beside(&place), ["out"]);
    }
}

#[test]
fn people_are_shown_the_place_of_the_results() {
    for (path, place) in [
        ("out/.v.rundown-new/report.html", "out/v/report.html"),
        ("v/.rundown-new/a.csv", "v/a.csv"),
        ("v/.rundown-ready/a.csv", "v/a.csv"),
        ("/v/.hidden/a.csv", "/v/.hidden/a.csv"),
        ("..v.rundown-new/a", ".v/a"),
    ] {
        assert_eq!(shown(Path::new(path)), Path::new(place));
    }
}

#[test]
fn what_was_read_and_what_nobody_listed_is_not_replaced() {
    let place = TempDir::new().unwrap();
    let out = place.path().join("out");
    fs::create_dir_all(&out).unwrap();
    fs::write(out.join("a.csv"), "a log of mine").unwrap();
    let refused = |provenance: &Provenance| begun(&out, &[("a.csv", "new")]).done(provenance).unwrap_err().to_string();
    assert!(refused(&Provenance::begin(&[])).contains("a.csv is there and no result of rundown"));
    assert!(refused(&Provenance::begin(&[out.join("a.csv")])).contains("a.csv was read for the results"));
    assert_eq!(content(&out), expected(&[("a.csv", "a log of mine")]));
    // Its own result is no input of the next one, until it is read for it.
    fs::remove_file(out.join("a.csv")).unwrap();
    written(&out, &[("a.csv", "old")]);
    assert!(refused(&Provenance::begin(&[out.join("a.csv")])).contains("was read for the results"));
    written(&out, &[("a.csv", "new")]);
    assert_eq!(content(&out), expected(&[("a.csv", "new")]));
}
