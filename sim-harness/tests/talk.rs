//! How much does the command say, and where? `-q`, `-v`, help, `doctor`, and a log from stdin.

mod common;

use common::{Folder, RUN, Said, reference};
use std::io::Write;
use std::process::{Command, Stdio};

fn replay(folder: &Folder, more: &[&str]) -> Said {
    folder.replay(&[more, &["run01.csv"]].concat())
}

#[test]
fn quiet_keeps_results_and_errors_only() {
    // A column that the format does not know is warned of.
    let folder = Folder::new().with("run01.csv", &RUN.replacen("speed_kmh", "speed_kmh,other", 1).replace('\n', ",\n"));
    let loud = replay(&folder, &[]);
    let quiet = replay(&folder, &["-q"]);
    assert!(loud.err.contains("warning: ") || loud.err.contains("error: "), "{}", loud.err);
    assert_eq!((quiet.code, quiet.out), (loud.code, loud.out));
    let errors: String =
        loud.err.lines().filter(|line| line.starts_with("error: ")).map(|line| format!("{line}\n")).collect();
    assert_eq!(quiet.err, errors);
    let missing = folder.replay(&["-q", "nowhere.csv"]);
    assert!(missing.code != Some(0) && missing.err.contains("error: nowhere.csv"), "{}", missing.err);
}

#[test]
fn verbose_says_what_is_read_and_written_and_when() {
    let folder = Folder::new().with("run01.csv", RUN);
    assert_eq!(replay(&folder, &[]).err, "");
    let said = replay(&folder, &["--verbose"]).err;
    let stage =
        |words: &str| said.lines().position(|line| line.ends_with(words)).unwrap_or_else(|| panic!("{words}: {said}"));
    let order = [
        stage("train.toml"),
        stage("read run01.csv"),
        stage("replayed 1 run"),
        stage("wrote out/report.html"),
        stage("done"),
    ];
    assert!(order.is_sorted(), "{said}");
    let times: Vec<f64> = said
        .lines()
        .map(|line| line.strip_prefix('[').and_then(|line| line.split_once(" s] ")).unwrap().0.trim().parse().unwrap())
        .collect();
    assert!(times.is_sorted(), "{said}");
    // Other commands, the option before or behind their name.
    let imported = folder.done(&["-v", "import", "run01.csv", "--out", "runs"]).err;
    assert!(imported.contains("] read run01.csv\n") && imported.contains("] wrote "), "{imported}");
    let checked = folder.rundown(&["check", "run01.csv", "-v"]).err;
    assert!(checked.contains("] read run01.csv\n") && checked.ends_with("] done\n"), "{checked}");
    let both = replay(&folder, &["-q", "-v"]);
    assert_eq!(both.code, Some(2));
}

/// What becomes of the exit code where stdout, or stderr, takes nothing more.
#[cfg(target_os = "linux")]
fn code(folder: &Folder, arguments: &[&str], out: Stdio, err: Stdio) -> Option<i32> {
    let mut command = Command::new(env!("CARGO_BIN_EXE_rundown"));
    command.current_dir(folder.path("")).args(arguments).stdout(out).stderr(err).status().unwrap().code()
}

#[test]
#[cfg(target_os = "linux")]
fn a_full_stdout_is_said_and_a_closed_one_or_a_full_stderr_stops_nothing() {
    let folder = Folder::new().with("run01.csv", RUN);
    let full = || Stdio::from(std::fs::OpenOptions::new().write(true).open("/dev/full").unwrap());
    let closed = || {
        let (reader, writer) = std::io::pipe().unwrap();
        drop(reader);
        Stdio::from(writer)
    };
    let check = ["check", "run01.csv", "--out", "checked", "--json"];
    for arguments in [&check[..], &["simulate", "--example"], &["gap", "--print-config"], &["completions", "bash"]] {
        assert_eq!(code(&folder, arguments, full(), Stdio::null()), Some(4), "{arguments:?}");
        assert_eq!(code(&folder, arguments, closed(), Stdio::null()), Some(0), "{arguments:?}");
    }
    for stderr in [&full as &dyn Fn() -> Stdio, &closed] {
        let folder = Folder::new().with("run01.csv", RUN);
        assert_eq!(code(&folder, &["-v", "check", "run01.csv", "--out", "checked"], Stdio::null(), stderr()), Some(0));
        assert!(folder.path("checked").join("report.html").is_file());
        assert_eq!(code(&folder, &["replay", "nowhere.csv"], Stdio::null(), stderr()), Some(2));
    }
}

#[test]
fn a_log_from_stdin_is_replayed_as_one_from_a_file() {
    let folder = Folder::new().with("stdin.csv", RUN);
    assert_eq!(folder.replay(&["stdin.csv"]).code, Some(0));
    let expected = folder.read("out/stdin.estimates.csv");
    let replayed = |text: &str| {
        let mut child = Command::new(env!("CARGO_BIN_EXE_rundown"))
            .current_dir(folder.path(""))
            .args([
                "replay",
                "--train",
                &reference("train.toml"),
                "--track",
                &reference("track.toml"),
                "--out",
                "piped",
                "-",
            ])
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .unwrap();
        child.stdin.take().unwrap().write_all(text.as_bytes()).unwrap();
        let output = child.wait_with_output().unwrap();
        (output.status.code(), String::from_utf8(output.stderr).unwrap())
    };
    assert_eq!(replayed(RUN), (Some(0), String::new()));
    assert_eq!(folder.read("piped/stdin.estimates.csv"), expected);
    let (code, said) = replayed("time_s,location_m,speed_kmh\n0,0,fast\n");
    assert_eq!(code, Some(6));
    assert!(said.contains("error: -:2:3: speed_kmh: expected a number, found \"fast\""), "{said}");
}

/// A line that ends although the next one, the rest of its sentence, begins with a word that would have fitted.
fn broken_early(text: &str, width: usize) -> Option<(String, String)> {
    let indentation = |line: &str| line.len() - line.trim_start().len();
    let mut pairs = text.lines().zip(text.lines().skip(1));
    let early = |(line, next): &(&str, &str)| {
        let word = next.split_whitespace().next().unwrap_or_default();
        let prose = |line: &str| !line.trim().is_empty() && !line.trim().contains("  ");
        prose(line)
            && prose(next)
            && indentation(line) <= indentation(next)
            && !line.ends_with(':')
            && word.starts_with(|c: char| c.is_ascii_lowercase())
            && !["rundown", "recorder"].contains(&word)
            && line.chars().count() + 1 + word.len() <= width
    };
    pairs.find(early).map(|(line, next)| (line.to_owned(), next.to_owned()))
}

#[test]
fn help_is_wrapped_once() {
    let help = |columns: &str, name: &str| {
        let output = Command::new(env!("CARGO_BIN_EXE_rundown")).env("COLUMNS", columns).args(["help", name]).output();
        String::from_utf8(output.unwrap().stdout).unwrap()
    };
    let replay =
        ["replay", "check", "import", "simulate", "study", "tune", "gap", "gap-bench", "export", "convert", "demo"];
    for name in replay {
        for width in [80, 100] {
            let text = help(&width.to_string(), name);
            assert!(text.contains("Usage: rundown"), "{name}: {text}");
            assert!(text.lines().all(|line| line.chars().count() <= width), "{name} at {width} columns:\n{text}");
            assert_eq!(broken_early(&text, width), None, "{name} at {width} columns");
        }
    }
}

#[test]
fn a_key_that_is_there_is_not_overwritten_and_runs_that_are_kept_are_named() {
    let folder = Folder::new();
    folder.done(&["provision", "--train-id", "1", "--out", "key.bin"]);
    let again = folder.rundown(&["provision", "--train-id", "1", "--out", "key.bin"]);
    assert_eq!(again.code, Some(4));
    assert!(again.err.contains("key.bin: expected a new file"), "{}", again.err);
    let kept = ["study", "-v", "--count", "2", "--no-run-pages", "--out", "study", "--keep-runs", "kept.parquet"];
    let said = folder.done(&kept).err;
    assert!(said.contains("] wrote kept.parquet\n"), "{said}");
}

#[test]
fn doctor_says_what_is_missing_and_how_to_mend_it() {
    let output = Command::new(env!("CARGO_BIN_EXE_rundown")).arg("doctor").env("PATH", "").output().unwrap();
    let said = String::from_utf8(output.stdout).unwrap();
    // Nothing of a board is there, and runs can be replayed all the same.
    assert_eq!(output.status.code(), Some(0), "{said}");
    for (name, mend) in [
        ("probe-rs", "cargo install --locked probe-rs-tools"),
        ("QEMU", "cargo xtask setup"),
        ("Chromium", "apt-get install chromium chromium-driver"),
        ("Python", "apt-get install python3 python3-venv"),
    ] {
        let mut lines = said.lines().skip_while(|line| !line.starts_with(&format!("missing  {name}")));
        assert!(lines.next().is_some() && lines.next().is_some_and(|line| line.ends_with(mend)), "{name}: {said}");
    }
    assert!(said.lines().any(|line| line.starts_with("ok       replay")), "{said}");
}
