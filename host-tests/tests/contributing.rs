//! Are the lists of `CONTRIBUTING.md` true? Each is compared with the files that mention its worked example.

use host_tests::project::{files, root, shown, text};
use rundown_wire::EffectKind;
use std::collections::BTreeSet;
use std::path::PathBuf;

/// The files of the table below a heading.
fn listed(heading: &str) -> BTreeSet<String> {
    let text = text("CONTRIBUTING.md");
    let (_, after) = text.split_once(&format!("## {heading}\n")).unwrap_or_else(|| panic!("no heading {heading}"));
    let section = after.split("\n## ").next().unwrap();
    let rows = section.lines().filter_map(|line| line.strip_prefix("| `")?.split_once('`'));
    let files: BTreeSet<String> = rows.map(|(file, _)| file.to_owned()).collect();
    assert!(!files.is_empty(), "{heading}: no table of files");
    files
}

/// Files whose code, tests and remarks left out, has one of these words.
fn mentions(words: &[&str], not_below: &[&str]) -> BTreeSet<String> {
    let folders = ["src", "wire", "sim-harness", "xtask", "host-tests"];
    let files: Vec<PathBuf> = folders.into_iter().flat_map(|folder| files(folder, ".rs")).collect();
    let has = |path: &PathBuf| {
        let text = text(path);
        let code = text.split("#[cfg(test)]\nmod tests").next().unwrap();
        let lines = code.lines().filter(|line| !line.trim_start().starts_with("//"));
        lines.into_iter().any(|line| words.iter().any(|word| line.contains(word)))
    };
    let own = "host-tests/tests/contributing.rs";
    let found = files.iter().filter(|path| has(path)).map(|path| shown(path));
    let found = found.filter(|file| !file.ends_with("/tests.rs"));
    found.filter(|file| file != own && !not_below.iter().any(|folder| file.starts_with(folder))).collect()
}

/// Name of the worked example of an effect.
const EXAMPLE: &str = "starting_resistance";

/// Walks the catalogue and names all that its kinds lack.
#[test]
fn every_kind_has_its_files_and_its_meaning() {
    let mut missing = Vec::new();
    for kind in EffectKind::ALL {
        // An unknown effect is no law but a table: the truth has none.
        let files = listed("An effect").into_iter().filter(|_| kind != EffectKind::Unknown);
        let files = files.map(|file| file.replace(EXAMPLE, kind.name())).filter(|file| !root().join(file).is_file());
        missing.extend(files.map(|file| format!("{kind}: expected {file}, found no file")));
        // The trait asks for the rest; that each acts, and alike on both sides, is asked in `catalogue.rs`.
        let candidate = format!("sim-harness/gap/src/candidates/{}.rs", kind.name());
        let finds = ["fn families(", "fn beside(", "fn limit("];
        if root().join(&candidate).is_file() && !finds.iter().any(|one| text(&candidate).contains(one)) {
            missing.push(format!("{kind}: expected one of {finds:?} in {candidate}, found none"));
        }
        if kind.parameters().is_empty() || kind.parameters().iter().any(|parameter| parameter.meaning.is_empty()) {
            missing.push(format!("{kind}: expected what each of its parameters means in wire/src/catalogue.rs"));
        }
        if !kind.summary().ends_with('.') {
            missing.push(format!("{kind}: expected a sentence as its summary, found {:?}", kind.summary()));
        }
    }
    assert!(missing.is_empty(), "{}", missing.join("\n"));
}

/// No other code, tests left out, knows the worked example by its name.
#[test]
fn an_effect_is_the_files_that_are_listed() {
    assert!(EffectKind::ALL.iter().any(|kind| kind.name() == EXAMPLE), "{EXAMPLE}: no kind; choose another example");
    let found = mentions(&["starting_resistance", "StartingResistance"], &["host-tests", "sim-harness/tests"]);
    assert_eq!(found, listed("An effect"));
}

#[test]
fn files_that_are_listed_exist() {
    for heading in ["A sensor column", "A frame", "A board", "The recogniser of regimes"] {
        for file in listed(heading) {
            assert!(root().join(&file).is_file(), "{heading}: {file}");
        }
    }
}

/// The truth has a wind of its own, which no log shows.
#[test]
fn a_sensor_column_is_at_most_six_files() {
    let words = ["\"headwind_mps\"", "pub headwind_mps", ".headwind_mps", "Self::Headwind", "Meaning::Headwind"];
    let mut found =
        mentions(&words, &["sim-harness/truth", "sim-harness/src/simulation", "sim-harness/tests", "host-tests"]);
    // Where it is described as a column of a log, or by its key in `import.toml`.
    let row =
        |line: &str| line.starts_with("| `headwind_mps`") || line.starts_with("| ") && line.contains(", `headwind` |");
    let documents = files("docs", ".md").into_iter().filter(|path| text(path).lines().any(row));
    found.extend(documents.map(|path| shown(&path)));
    assert!(found.len() <= 6, "{found:?}");
    assert_eq!(found, listed("A sensor column"));
}

#[test]
fn a_frame_is_the_files_that_are_listed_and_its_users() {
    let found = mentions(
        &["struct SwitchingPoints", "Body::SwitchingPoints"],
        &["sim-harness/src/display", "src/onboard/frames.rs"],
    );
    let listed: BTreeSet<String> = listed("A frame").into_iter().filter(|file| file.ends_with(".rs")).collect();
    assert_eq!(found, listed);
    assert!(text("WIRE.md").contains("\n### 4 switching_points"));
}

/// Its name may stand where the recogniser is kept and called, its law nowhere else.
#[test]
fn the_recogniser_is_one_file() {
    let found = mentions(&["struct RecogniserConfig", "struct Recogniser "], &[]);
    assert_eq!(found, listed("The recogniser of regimes"));
}

/// Each board has a folder with its memory, and a feature where it is not the default.
#[test]
fn a_board_is_a_folder_and_a_feature() {
    let manifest = text("Cargo.toml");
    let choice = text("src/board/mod.rs");
    let folders = std::fs::read_dir(root().join("src/board")).unwrap().map(|entry| entry.unwrap().path());
    let boards: Vec<PathBuf> = folders.filter(|path| path.is_dir()).collect();
    assert!(boards.len() >= 2);
    for board in boards {
        let name = board.file_name().unwrap().to_str().unwrap();
        assert!(board.join("board.x").is_file(), "{name} has no board.x");
        assert!(choice.contains(&format!("mod {name};")), "{name} is not chosen");
        assert!(name == "l475" || manifest.contains(&format!("\n{name} = [")), "{name} has no feature");
    }
}
