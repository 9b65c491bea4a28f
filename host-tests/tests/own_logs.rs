//! Logs as they come from trains, through import, diagnosis and replay: does what always holds hold, and did the answer
//! change?
//!
//! The folders of `data/logs`, and the folder `RUNDOWN_LOGS` where that is set (docs/replay.md). Logs that are no run
//! logs, or lie beside an `import.toml`, are imported first. With the emulator a run of each folder is played to the
//! firmware too. The answer is compared with `golden/runs.csv` in the folder, which `BLESS=1` (or `RUNDOWN_BLESS=1`)
//! writes.

use host_tests::prelude::*;
use host_tests::reference::data;
use host_tests::target::{compare, firmware};
use rundown::model::state::resistance_sd;
use rundown_files::effect_file;
use rundown_files::replay::ReplayedRun;
use rundown_wire::{Learned, Validity};
use sim_harness::replaying::{Replayed, Request};
use sim_harness::session::description;
use std::ffi::OsString;
use std::fmt::Write as _;
use std::process::ExitCode;
use tempfile::TempDir;

/// Columns behind the name, each with the share by which a value may differ: other platforms round alike, so this only
/// hides the printing.
const COLUMNS: [(&str, f64); 9] = [
    ("rows", 0.0),
    ("steps", 0.0),
    ("invalid", 0.0),
    ("learned_s", 1e-6),
    ("r20_n_per_kg", 1e-6),
    ("r100_n_per_kg", 1e-6),
    ("sd_r100_n_per_kg", 1e-6),
    ("coasts", 0.0),
    ("coast_error_kmh", 1e-6),
];
/// What is published may foresee the coasts so much worse than the description, by chance: few coasts were foreseen.
const WORSE: f64 = 1.25;
/// More invalid ticks than this are said.
const SILENT_SHARE: f64 = 0.1;

/// A folder of logs, with what was made of it.
struct Logs {
    folder: PathBuf,
    replayed: Replayed,
    /// Holds the imported runs.
    _imported: TempDir,
}

impl Logs {
    fn of(folder: &Path) -> Self {
        let imported = tempfile::tempdir().unwrap();
        let own = |name: &str| Some(folder.join(name)).filter(|path| path.is_file());
        let runs = if folder.join("runs").is_dir() { folder.join("runs") } else { folder.to_owned() };
        let runs = match own("import.toml") {
            None if are_run_logs(&runs) => runs,
            mapping => import(&runs, mapping, &imported.path().join("runs")),
        };
        let track = own("track.toml").or_else(|| only_track(folder));
        let train = own("train.toml").unwrap_or_else(|| data("reference/train.toml"));
        let track = track.unwrap_or_else(|| panic!("{}: expected a track.toml, found none", folder.display()));
        let request = Request { config: own("config.toml"), ..Request::new(vec![runs], train, track) };
        let replayed = request.open().and_then(|opened| opened.replay(|| ()));
        let replayed = replayed.unwrap_or_else(|error| panic!("{error}"));
        assert!(!replayed.runs.is_empty(), "{}: {:?}", folder.display(), replayed.failed);
        Self { folder: folder.to_owned(), replayed, _imported: imported }
    }

    /// What is said about all of it, on the screen and in the JSON.
    fn said(&self) -> String {
        let Replayed { runs, failed, notes, .. } = &self.replayed;
        let failed = failed.iter().map(|failed| failed.error.clone());
        let warnings = runs.iter().flat_map(|run| run.warnings.clone());
        failed.chain(warnings).chain(notes.iter().cloned()).collect::<Vec<_>>().join("\n")
    }
}

fn only_track(folder: &Path) -> Option<PathBuf> {
    let entries = folder.read_dir().ok()?.filter_map(|entry| Some(entry.ok()?.path()));
    let mut tracks = entries.filter(|path| {
        let name = path.file_name().unwrap_or_default().to_string_lossy();
        name.starts_with("track_") && name.ends_with(".toml")
    });
    tracks.next().filter(|_| tracks.next().is_none())
}

fn are_run_logs(runs: &Path) -> bool {
    let set = RunSet::find(&[runs.to_owned()]);
    set.is_ok_and(|set| set.files.iter().all(|file| RunLog::read(&file.path, BadRows::Refuse).is_ok()))
}

fn import(runs: &Path, mapping: Option<PathBuf>, to: &Path) -> PathBuf {
    let mut words: Vec<OsString> = ["rundown", "import"].map(OsString::from).into();
    words.extend([runs.into(), "--out".into(), to.into()]);
    words.extend(mapping.into_iter().flat_map(|path| ["--mapping".into(), path.into()]));
    let code = sim_harness::commands::run(words);
    let fine = [ExitCode::SUCCESS, ExitCode::from(1)].map(|code| format!("{code:?}"));
    assert!(fine.contains(&format!("{code:?}")), "{}: cannot be imported, see above", runs.display());
    to.to_owned()
}

fn all() -> Vec<Logs> {
    let mut folders: Vec<PathBuf> =
        data("logs").read_dir().unwrap().map(|entry| entry.unwrap().path()).filter(|path| path.is_dir()).collect();
    folders.sort();
    assert!(folders.len() >= 3, "{folders:?}");
    folders.extend(std::env::var_os("RUNDOWN_LOGS").map(PathBuf::from));
    folders.iter().map(|folder| Logs::of(folder)).collect()
}

fn resistance(run: &ReplayedRun, speed_kmh: f64) -> (f64, f64) {
    let (v, mean) = (speed_kmh / 3.6, run.vehicle_after.mean);
    (mean[0] + v * (mean[1] + v * mean[2]), resistance_sd(&run.vehicle_after, v))
}

fn invalid(run: &ReplayedRun) -> usize {
    run.estimates.iter().filter(|estimate| matches!(estimate.validity, Validity::Invalid(_))).count()
}

#[test]
fn every_row_is_a_step_or_is_named() {
    for logs in all() {
        for run in &logs.replayed.runs {
            assert_eq!(run.estimates.len() + run.dropped.len(), run.rows, "{}", run.path.display());
            assert!(run.estimates.windows(2).all(|pair| pair[0].time_s < pair[1].time_s), "{}", run.path.display());
        }
        let replayed: usize = logs.replayed.runs.len() + logs.replayed.failed.len();
        assert!(replayed > 0, "{}", logs.folder.display());
    }
}

#[test]
fn estimates_are_finite_and_their_covariances_positive_definite() {
    for logs in all() {
        for run in &logs.replayed.runs {
            for estimate in &run.estimates {
                let place = || format!("{} at {} s", run.path.display(), estimate.time_s);
                assert!(estimate.belief.is_finite(), "{}", place());
                assert!(estimate.belief.covariance.cholesky().is_some(), "{}", place());
            }
            assert!(run.vehicle_after.is_finite(), "{}", run.path.display());
        }
    }
}

#[test]
fn what_is_published_is_a_train_and_foresees_coasts_no_worse_than_the_description() {
    for logs in all() {
        let mut sums = [0.0; 2];
        for run in &logs.replayed.runs {
            let place = run.path.display();
            let foresight = &run.summary.foresight;
            assert!(foresight.learned_mps.is_finite() && foresight.described_mps.is_finite(), "{place}");
            sums[0] += foresight.learned_mps;
            sums[1] += foresight.described_mps;
            if run.learned == Learned::Learned {
                let r: Vec<f64> = (0..=16).map(|step| resistance(run, 10.0 * f64::from(step)).0).collect();
                assert!(r[0] > 0.0 && r.windows(2).all(|pair| pair[0] <= pair[1]), "{place}: r(v) = {r:?}");
            }
        }
        let last = logs.replayed.runs.iter().rev().find(|run| run.learned == Learned::Learned);
        if let Some(run) = last {
            let worse = sums[0] > WORSE * WORSE * sums[1];
            assert!(!worse, "{}: squares of the errors {sums:?}, and it is published", run.path.display());
        }
    }
}

/// By its path, or its name before the colon: within a sentence a name may be part of any word.
fn names(said: &str, run: &ReplayedRun) -> bool {
    let before_colon = |line: &str| {
        line.split_once(": ").is_some_and(|(names, _)| names.split([',', ' ']).any(|name| name == run.name))
    };
    said.contains(&run.path.display().to_string()) || said.lines().any(before_colon)
}

#[test]
fn no_defect_is_silent() {
    for logs in all() {
        let said = logs.said();
        for run in &logs.replayed.runs {
            let (count, all) = (invalid(run), run.estimates.len());
            let named = names(&said, run);
            assert!(count as f64 <= SILENT_SHARE * all as f64 || named, "{}: {count} of {all}", run.path.display());
            assert!(run.is_used || named, "{}", run.path.display());
            assert!(run.dropped.is_empty() || named, "{}", run.path.display());
        }
        if logs.replayed.runs.iter().all(|run| run.summary.learned_s == 0.0) {
            assert!(said.contains("nothing was learned"), "{}: {said}", logs.folder.display());
        }
    }
}

/// What the imitations have is found, and found again when they are imported.
#[test]
fn what_the_recorders_of_the_imitations_did_is_said() {
    let said = |name: &str| Logs::of(&data("logs").join(name)).said();
    let locomotive = said("locomotive");
    for words in
        ["speeds are truncated to the step below: 1.000 km/h; put right", "one second more than their clock says"]
    {
        assert!(locomotive.contains(words), "{locomotive}");
    }
    let phone = said("phone");
    assert!(phone.contains("the location stands still while the train runs"), "{phone}");
    let suburban = said("suburban");
    assert!(suburban.contains("the clock goes back at midnight: 86400 s; put right"), "{suburban}");
}

fn values(run: &ReplayedRun) -> [f64; 9] {
    let coasts = run.summary.foresight.trust.coasts;
    let error_kmh = if coasts > 0.0 { 3.6 * (run.summary.foresight.learned_mps / coasts).sqrt() } else { 0.0 };
    let (r100, sd100) = resistance(run, 100.0);
    [
        run.rows as f64,
        run.estimates.len() as f64,
        invalid(run) as f64,
        run.summary.learned_s,
        resistance(run, 20.0).0,
        r100,
        sd100,
        coasts,
        error_kmh,
    ]
}

#[test]
fn the_answer_is_the_last_accepted_one() {
    let bless = ["BLESS", "RUNDOWN_BLESS"].into_iter().any(|name| std::env::var_os(name).is_some());
    for logs in all() {
        let mut text = String::from("run");
        COLUMNS.iter().for_each(|(name, _)| text += &format!(",{name}"));
        for run in &logs.replayed.runs {
            write!(text, "\n{}", run.name).unwrap();
            values(run).iter().for_each(|value| write!(text, ",{value}").unwrap());
        }
        text += "\n";
        let path = logs.folder.join("golden/runs.csv");
        if bless {
            std::fs::create_dir_all(path.parent().unwrap()).unwrap();
            std::fs::write(&path, &text).unwrap();
        }
        let golden = std::fs::read_to_string(&path);
        let golden = golden.unwrap_or_else(|_| panic!("{}: not there yet, BLESS=1 writes it", path.display()));
        assert_eq!(golden.lines().count(), text.lines().count(), "{}", path.display());
        for (expected, found) in golden.lines().zip(text.lines()) {
            let columns = |line: &str| line.split(',').count();
            assert_eq!(columns(expected), columns(found), "{}: columns of {expected}", path.display());
            let near = expected.split(',').zip(found.split(',')).enumerate().all(|(at, (expected, found))| {
                match (expected.parse::<f64>(), found.parse::<f64>()) {
                    (Ok(a), Ok(b)) => (a - b).abs() <= COLUMNS[at - 1].1 * a.abs(),
                    _ => expected == found,
                }
            });
            assert!(near, "{}:\nexpected {expected}\n   found {found}\nBLESS=1 accepts it", path.display());
        }
    }
}

/// Ticks of a run that are played to the firmware: it takes a second for some tens of them.
const PLAYED: usize = 600;

#[test]
#[ignore = "needs the firmware and its emulator: cargo xtask test"]
fn the_board_says_the_bytes_of_the_host() {
    let firmware = firmware().unwrap();
    for Logs { folder, replayed, .. } in all() {
        let run = replayed.runs.iter().min_by_key(|run| run.measurements.len().abs_diff(PLAYED)).unwrap();
        let effects = effect_file::effects(&replayed.track.effect, &replayed.train.effect, Some(&run.name)).unwrap();
        let described = description(&replayed.core_train, &replayed.track, replayed.config);
        let description = Description { effects, ..described };
        let played = &run.measurements[..run.measurements.len().min(PLAYED)];
        let same = compare(&firmware, &description, run.direction, &[played]);
        let same = same.unwrap_or_else(|error| panic!("{}: {error}", run.path.display()));
        println!("{}: {} ticks, {} frames the same", run.path.display(), same.ticks, same.frames);
        assert!(same.ticks == played.len() && same.frames > 3 * same.ticks, "{}", folder.display());
    }
}
