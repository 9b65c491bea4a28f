//! Can the documents be trusted? Links lead somewhere, tests that are named exist, the library's snippet runs; lines
//! are short, words are the field's.

#[path = "documents/snippet.rs"]
mod snippet;

use host_tests::accuracy::{NOMINAL, train};
use host_tests::prelude::*;
use host_tests::project::{files, root, shown, text};
use std::collections::BTreeSet;
use std::fs;

/// Longest line of prose. Tables, code and headings may be longer.
const LINE: usize = 120;

/// Words of nobody's field, and what to write instead. Whole words; of code its names, comments and strings.
const NOT: &[(&str, &str)] = &[
    ("took no part", "hold-out runs"),
    ("held-out", "hold-out"),
    ("drawn anew", "resampled, bootstrap"),
    ("anew", "again"),
    ("signs of whole runs", "sign-flip test over runs"),
    ("cannot be told", "not distinguishable from, cannot be written"),
    ("told from", "distinguished from"),
    ("told apart", "distinguished"),
    ("is told", "is found, is reported"),
    ("would tell", "would separate them"),
    ("has for itself", "per-run random effects"),
    ("second thoughts", "backward re-check"),
    ("the way ahead", "the distance ahead"),
    ("ways between stops", "distances between stops"),
    ("gauge", "gain of the effort sensor"),
    ("turn of power", "on/off cycle"),
    ("turns of power", "on/off cycles"),
    ("pull", "powering phase"),
    ("pulls", "powering phases"),
    ("witness", "reference implementation, probe regressor"),
    ("witnesses", "evidence, probe regressors"),
    ("chance leaves", "is consistent with noise"),
    ("flutters", "publishing hysteresis"),
    ("by luck", "unreliably"),
];

/// Files whose names end so: path and text.
fn read(end: &str) -> Vec<(PathBuf, String)> {
    files("", end).into_iter().map(|path| (path.clone(), text(path))).collect()
}

fn documents() -> Vec<(PathBuf, String)> {
    read(".md")
}

/// The lines outside of code blocks, with their numbers.
fn lines(text: &str) -> impl Iterator<Item = (usize, &str)> {
    outside_code(text, |line| Some(line))
}

/// The comments of a file outside of code blocks and tables.
fn comments(text: &str) -> impl Iterator<Item = (usize, &str)> {
    outside_code(text, said).filter(|(_, line)| said(line).is_some_and(|said| !said.trim_start().starts_with('|')))
}

/// What stands behind the slashes of a comment.
fn said(line: &str) -> Option<&str> {
    Some(line.trim_start().strip_prefix("//")?.trim_start_matches(['/', '!']))
}

/// The lines outside of code blocks of those in which prose stands, with their numbers.
fn outside_code(text: &str, prose: fn(&str) -> Option<&str>) -> impl Iterator<Item = (usize, &str)> {
    let mut code = false;
    text.lines().enumerate().filter_map(move |(index, line)| {
        let fence = prose(line)?.trim_start().starts_with("```");
        code ^= fence;
        (!code && !fence).then_some((index + 1, line))
    })
}

/// A line without what stands between backticks.
fn without_code(line: &str) -> String {
    line.split('`').step_by(2).collect::<Vec<_>>().join("`")
}

/// As GitHub makes it of a heading: small letters, digits, `_` and `-`, blanks as `-`.
fn anchor(heading: &str) -> String {
    let kept = heading.trim_start_matches('#').trim().to_lowercase();
    kept.chars()
        .filter(|letter| letter.is_alphanumeric() || " -_".contains(*letter))
        .map(|letter| if letter == ' ' { '-' } else { letter })
        .collect()
}

fn anchors(text: &str) -> BTreeSet<String> {
    lines(text).filter(|(_, line)| line.starts_with('#')).map(|(_, line)| anchor(line)).collect()
}

/// All findings at once, each as `file:line: ..`.
fn report(findings: &[String]) {
    assert!(findings.is_empty(), "\n{}", findings.join("\n"));
}

fn place(path: &Path, line: usize) -> String {
    format!("{}:{line}", shown(path))
}

/// Of these lines of a file the too long ones.
fn too_long<'a>(path: &Path, lines: impl Iterator<Item = (usize, &'a str)>) -> Vec<String> {
    let lengths = lines.map(|(number, line)| (number, line.chars().count())).filter(|(_, length)| *length > LINE);
    lengths.map(|(number, length)| format!("{}: {length} characters, at most {LINE}", place(path, number))).collect()
}

#[test]
fn lines_of_prose_end_at_120_characters() {
    let prose = |text| lines(text).filter(|(_, line)| !line.starts_with(['|', '#']));
    report(&documents().iter().flat_map(|(path, text)| too_long(path, prose(text))).collect::<Vec<_>>());
}

#[test]
fn comments_end_at_120_characters() {
    report(&read(".rs").iter().flat_map(|(path, text)| too_long(path, comments(text))).collect::<Vec<_>>());
}

#[test]
fn links_lead_to_files_and_headings() {
    let mut findings = Vec::new();
    for (path, text) in documents() {
        for (number, line) in lines(&text) {
            // A link may end on the next line, but its target does not.
            for link in line.split("](").skip(1).filter_map(|rest| rest.split(')').next()) {
                if link.contains("://") {
                    continue;
                }
                let (file, heading) = link.split_once('#').unwrap_or((link, ""));
                let target = if file.is_empty() { path.clone() } else { path.with_file_name("").join(file) };
                let there = fs::exists(&target).unwrap_or(false);
                let found = || heading.is_empty() || anchors(&self::text(&target)).contains(heading);
                if !there || !found() {
                    findings.push(format!("{}: {link} does not exist", place(&path, number)));
                }
            }
        }
    }
    report(&findings);
}

/// Letters, digits, hyphens; one blank between words.
fn words(line: &str) -> String {
    let line = without_code(line).to_lowercase();
    let letters = line.replace(|letter: char| !letter.is_alphanumeric() && !"-'".contains(letter), " ");
    // The space that a vehicle may take has this name on every railway.
    letters.split_whitespace().collect::<Vec<_>>().join(" ").replace("loading gauge", "")
}

/// The words of [`NOT`] in lines of prose, each with the finding.
fn found(path: &Path, lines: &[(usize, String)]) -> Vec<(&'static str, String)> {
    let mut findings = Vec::new();
    for (index, (number, line)) in lines.iter().enumerate() {
        // A phrase may go on in the next line.
        let next = lines.get(index + 1).map_or("", |(_, next)| next);
        let (both, next) = (format!(" {line} {next} "), format!(" {next} "));
        for (not, instead) in NOT {
            let phrase = format!(" {not} ");
            if both.contains(&phrase) && !next.contains(&phrase) {
                findings.push((*not, format!("{}: \"{not}\": write {instead}", place(path, *number))));
            }
        }
    }
    findings
}

#[test]
fn words_are_those_of_the_field() {
    let mut findings = Vec::new();
    for (path, text) in documents() {
        let lines: Vec<(usize, String)> = lines(&text).map(|(number, line)| (number, words(line))).collect();
        findings.extend(found(&path, &lines).into_iter().map(|(_, finding)| finding));
    }
    report(&findings);
}

/// What a line of code says to a reader: its comment and its strings, and the words of its names.
fn prose(line: &str) -> String {
    let (code, comment) = match line.split_once("//") {
        Some((code, comment)) if !code.ends_with(':') => (code, comment),
        _ => (line, ""),
    };
    let strings = code.split('"').skip(1).step_by(2);
    let said = words(&strings.chain([comment]).collect::<Vec<_>>().join(" "));
    // Between other names stands what is no word, so that two of them are no phrase.
    let names = code.split('"').step_by(2).flat_map(|code| code.split(|c: char| !c.is_alphanumeric() && c != '_'));
    let names = names.filter(|name| !KNOWN.contains(name));
    names.map(|name| words(&name.replace('_', " "))).fold(said, |said, name| format!("{said} | {name}"))
}

/// Names of tests that still have such words. The list may only become shorter.
const KNOWN: &[&str] = &[
    "a_mean_a_moment_and_a_late_column_are_told_apart",
    "a_turn_of_power_inside_one_interval_splits_a_coast",
    "speeds_that_are_cut_off_are_told_from_rounded_ones_after_some_runs",
];

/// A line of a page or a script: all of it, for its text may stand anywhere. The instrument of a display is a gauge.
fn prose_of_page(line: &str) -> String {
    words(&line.replace('_', " ")).replace("gauge", "")
}

#[test]
fn words_in_code_are_those_of_the_field() {
    let mut findings = Vec::new();
    for (path, text) in read(".rs") {
        // Here they all stand.
        if path.ends_with("tests/documents.rs") {
            continue;
        }
        let lines: Vec<(usize, String)> =
            text.lines().map(prose).enumerate().map(|(at, line)| (at + 1, line)).collect();
        findings.extend(found(&path, &lines).into_iter().map(|(_, finding)| finding));
    }
    let pages = [".js", ".css", ".html", ".py"].into_iter().flat_map(read).chain(assets());
    for (path, text) in pages {
        let lines: Vec<(usize, String)> =
            text.lines().map(prose_of_page).enumerate().map(|(at, line)| (at + 1, line)).collect();
        findings.extend(found(&path, &lines).into_iter().map(|(_, finding)| finding));
    }
    report(&findings);
}

/// Pages and scripts of the programs, those of our own.
fn assets() -> Vec<(PathBuf, String)> {
    let ends = [".js", ".css", ".html"];
    let paths = ["sim-harness/assets/display", "sim-harness/assets/pages"].map(|path| root().join(path));
    let entries = paths.iter().flat_map(|path| path.read_dir().unwrap()).map(|entry| entry.unwrap().path());
    let ours = entries.filter(|path| ends.iter().any(|end| path.to_string_lossy().ends_with(end)));
    ours.map(|path| (path.clone(), text(path))).collect()
}

/// A test is named `file.rs::name`, wherever the file lies.
#[test]
fn tests_that_are_named_exist() {
    let sources = read(".rs");
    let mut findings = Vec::new();
    let mut count = 0;
    for (path, text) in documents() {
        for (number, line) in lines(&text) {
            for (file, test) in line.split('`').skip(1).step_by(2).filter_map(|code| code.split_once(".rs::")) {
                let file = format!("{}.rs", file.rsplit('/').next().unwrap());
                let test = format!("fn {test}(");
                let named = |(source, text): &(PathBuf, String)| source.ends_with(&file) && text.contains(&test);
                count += 1;
                if !sources.iter().any(named) {
                    findings.push(format!("{}: no {test}) in a {file}", place(&path, number)));
                }
            }
        }
    }
    assert!(count > 50, "{count}");
    report(&findings);
}

#[test]
fn the_snippet_of_the_library_learns_the_resistance_of_a_coasting_train() {
    let page = text("docs/library.md");
    let shown = page.split("```rust\n").nth(1).and_then(|rest| rest.split("```").next());
    assert_eq!(shown, Some(include_str!("documents/snippet.rs")));

    // The front page has the lines of its body.
    let front = text("README.md");
    let fragment = front.split("```rust\n").nth(1).and_then(|rest| rest.split("```").next()).expect("a snippet");
    let (imports, body) = fragment.split_once("\n\n").expect("imports, and lines of code");
    let indented: String = body.lines().map(|line| format!("    {line}\n")).collect();
    let snippet = include_str!("documents/snippet.rs");
    assert!(snippet.starts_with(imports) && snippet.contains(&indented), "{fragment}");

    let davis = NOMINAL;
    // It coasts from 140 km/h with a tenth less resistance than described.
    let (mut location_m, mut speed_mps) = (0.0, 140.0 / 3.6);
    let mut log = Vec::new();
    for tick in 0..30 {
        log.push(Measurement {
            time_s: 10.0 * f64::from(tick),
            location_m: Some(location_m),
            speed_mps: Some((speed_mps * 3.6_f64).round() / 3.6),
            effort_n_per_kg: None,
        });
        for _ in 0..100 {
            location_m += 0.1 * speed_mps;
            speed_mps -= 0.1 * 0.9 * davis.resistance_n_per_kg(speed_mps);
        }
    }
    let learned = snippet::learn(train(), &log).unwrap();
    let share = learned.resistance_n_per_kg(30.0) / davis.resistance_n_per_kg(30.0);
    assert!((share - 0.9).abs() < 0.02, "{share}");
}

/// A quiet build hides the minutes of the first one, and that cargo waits for another.
#[test]
fn no_command_of_the_workspace_builds_without_a_word() {
    let config = text(Path::new(".cargo/config.toml"));
    let aliases = config.lines().skip_while(|line| *line != "[alias]").skip(1).take_while(|line| !line.is_empty());
    let aliases: Vec<&str> = aliases.filter(|line| !line.starts_with('#')).collect();
    assert!(aliases.iter().any(|line| line.starts_with("rundown = ")), "{aliases:?}");
    let quiet: Vec<_> = aliases.iter().filter(|line| line.contains("--quiet") || line.contains(" -q ")).collect();
    assert!(quiet.is_empty(), "{quiet:?}");
}
