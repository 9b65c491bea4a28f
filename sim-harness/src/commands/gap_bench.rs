//! `rundown gap-bench`: how often `rundown gap` finds what was hidden, and nothing else.

use super::{Failure, screen};
use crate::gap_bench::draw::{SIZES, Set, SetRequest, Size, kinds};
use crate::gap_bench::folder;
use crate::gap_bench::nuisance::Nuisance;
use crate::gap_bench::score::Score;
use crate::gap_bench::table::{Done, tables};
use crate::gap_bench::{BenchError, blind};
use crate::study::write;
use clap::builder::PossibleValuesParser;
use rand::seq::IndexedRandom;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;
use rundown_files::WriteError;
use rundown_files::folder::{Provenance, write as write_folder};
use rundown_gap::answer::tables as gap_tables;
use rundown_pages::numbers::counted;
use rundown_truth::habits::DriverKind;
use std::path::{Path, PathBuf};
use std::{process::ExitCode, time::Instant};

const EXAMPLES: &str = "\
Examples:
  The full table, as in docs/gap-bench.md:
    rundown gap-bench --out bench

  One kind in one size, ten times, with the keys beside what was found:
    rundown gap-bench --kind warm_up --size faint --sets 10 --none 0 --pairs 0 --list

  Automatic trains, whose runs are alike, hiding nothing:
    rundown gap-bench --sets 0 --pairs 0 --driver ato --list

  What recorders do wrong, hiding nothing:
    rundown gap-bench --sets 0 --pairs 0 --nuisance effort-gain --nuisance effort-late --nuisance location-off

  Sets of others, each with its key in the folder `keys`:
    rundown gap-bench --folder theirs --list

Each set is written as `rundown simulate` does it, its truth is removed, and `rundown gap` investigates the rest.

Files in the output folder:
  tables.md     false alarms, shares that were named, errors of size and place, what was named instead
  sets.json     each set with its key and its score";

/// Arguments of `rundown gap-bench`.
#[derive(Debug, clap::Args)]
#[command(after_help = EXAMPLES, after_long_help = format!("{EXAMPLES}\n\n{}", super::AFTER_HELP))]
pub struct Arguments {
    /// Kinds of hidden effects; all without it
    #[arg(long, value_name = "NAME", value_parser = PossibleValuesParser::new(kinds()))]
    kind: Vec<String>,
    /// Sizes; all without it
    #[arg(long, value_enum)]
    size: Vec<HowLarge>,
    /// Logs with or without an effort column; both without it
    #[arg(long, value_enum)]
    effort: Option<Effort>,
    /// Sets of each kind, size and effort
    #[arg(long, value_name = "N", default_value_t = 1)]
    sets: u64,
    /// Sets in which nothing is hidden, of each effort and with clean and with dirty sensors
    #[arg(long, value_name = "N", default_value_t = 12)]
    none: u64,
    /// Sets with two effects, of each size and effort
    #[arg(long, value_name = "N", default_value_t = 6)]
    pairs: u64,
    /// Instead of the sets without an effect, as many with each of these faults of recorders and descriptions
    #[arg(long, value_enum, value_name = "NAME")]
    nuisance: Vec<Nuisance>,
    /// Share of the sets with an effect that have dirty sensors
    #[arg(long, value_name = "SHARE", default_value_t = 0.25)]
    dirty: f64,
    /// Services beyond the case study: short hops, metros and trams, signals at danger, a little wind, momentary
    /// efforts that differ from run to run
    #[arg(long)]
    rough: bool,
    /// Who drives in all sets, whatever their seeds draw
    #[arg(long, value_enum, value_name = "NAME")]
    driver: Option<Driver>,
    /// Runs of a set
    #[arg(long, value_name = "N", default_value_t = 67, value_parser = clap::value_parser!(u16).range(5..=1000))]
    runs: u16,
    /// Seed of all draws
    #[arg(long, value_name = "SEED", default_value_t = 1)]
    seed: u64,
    /// Only the sets with these seeds, which --list prints
    #[arg(long, value_name = "SEED")]
    only: Vec<u64>,
    /// Keep the sets with their residuals, each under its seed, in the folder `sets` of the results: for `rundown gap`
    /// and other tools
    #[arg(long)]
    keep: bool,
    /// Sets of others instead: a folder of sets as `rundown simulate` writes them, and of each its key, keys/NAME.json
    #[arg(long, value_name = "DIR", conflicts_with_all = ["kind", "size", "sets", "none", "pairs", "nuisance", "dirty", "rough", "driver", "runs", "seed", "only", "keep"])]
    folder: Option<PathBuf>,
    /// Print each set with its key
    #[arg(long)]
    list: bool,
    /// Folder for the results; made when it does not exist
    #[arg(long, value_name = "DIR", default_value = "out/gap-bench")]
    out: PathBuf,
}

/// How large the hidden effect is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
enum HowLarge {
    /// Well above the noise.
    Clear,
    /// In between.
    Medium,
    /// At the limit.
    Faint,
}

/// As `driver.kind` of a scenario.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
#[value(rename_all = "snake_case")]
enum Driver {
    Intercity,
    ShortHops,
    HopAndCoast,
    Ato,
}

impl Driver {
    fn kind(self) -> DriverKind {
        match self {
            Self::Intercity => DriverKind::CaseStudy,
            Self::ShortHops => DriverKind::ShortHop,
            Self::HopAndCoast => DriverKind::HopAndCoast,
            Self::Ato => DriverKind::Automatic,
        }
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
enum Effort {
    With,
    Without,
}

/// Does what the arguments say.
pub(super) fn run(arguments: &Arguments) -> Result<ExitCode, Failure> {
    if !(0.0..=1.0).contains(&arguments.dirty) {
        let found = arguments.dirty;
        return Err(Failure::arguments(format_args!("--dirty: expected a share of 0 to 1, found {found}")));
    }
    if let Some(folder) = &arguments.folder {
        return of_folder(folder, arguments);
    }
    let provenance = Provenance::begin(&[]);
    let requests = requests(arguments);
    let sets = arguments.out.join("sets");
    let bar = screen::progress(requests.len());
    let done = requests
        .into_par_iter()
        .map(|request| {
            let kept = arguments.keep.then(|| sets.join(request.seed.to_string()));
            let done = one(request, kept.as_deref())?;
            if arguments.list {
                bar.suspend(|| screen::print(&line(&done)));
            }
            bar.inc(1);
            Ok(done)
        })
        .collect::<Result<Vec<Done>, BenchError>>()
        .map_err(Failure::refused)?;
    bar.finish_and_clear();
    let text = tables(&done);
    write_results(&arguments.out, &provenance, &text, &done)?;
    let longest = done.iter().map(|d| d.seconds).fold(0.0, f64::max);
    screen::print(&format!(
        "{}, the longest investigation {longest:.1} s; results: {}\n",
        counted(done.len(), "set", "sets"),
        arguments.out.display()
    ));
    Ok(ExitCode::SUCCESS)
}

/// Sets of others beside their keys.
fn of_folder(folder: &Path, arguments: &Arguments) -> Result<ExitCode, Failure> {
    let provenance = Provenance::begin(&[]);
    let keys = folder::keys(folder).map_err(Failure::refused)?;
    let sets: Vec<_> =
        keys.iter().flat_map(|key| efforts(arguments).iter().map(move |effort| (key, *effort))).collect();
    let bar = screen::progress(sets.len());
    let judged = sets
        .into_par_iter()
        .map(|((name, key), effort)| {
            let judged = folder::judge(folder, name, key, effort)?;
            if arguments.list {
                bar.suspend(|| screen::print(&judged.line()));
            }
            bar.inc(1);
            Ok(judged)
        })
        .collect::<Result<Vec<folder::JudgedSet>, std::io::Error>>()
        .map_err(Failure::refused)?;
    bar.finish_and_clear();
    let text = folder::tables(&judged);
    write_results(&arguments.out, &provenance, &text, &judged)?;
    let absent = judged.iter().filter(|one| one.absent).count();
    let sets = counted(judged.len() - absent, "set", "sets");
    let without = if absent > 0 { format!(", {absent} without a folder") } else { String::new() };
    screen::print(&format!("{sets}{without}; results: {}\n", arguments.out.display()));
    Ok(ExitCode::SUCCESS)
}

/// Tables, on screen too, and the sets that they are made of.
fn write_results(out: &Path, provenance: &Provenance, text: &str, sets: &impl serde::Serialize) -> Result<(), Failure> {
    let json = serde_json::to_string_pretty(sets).map_err(Failure::not_written)?;
    write_folder("gap-bench", out, provenance, |folder| -> Result<(), WriteError> {
        write::text(&folder.join("tables.md"), text)?;
        write::text(&folder.join("sets.json"), &(json + "\n"))
    })?;
    screen::print(text);
    Ok(())
}

/// With an effort column, without, or both.
fn efforts(arguments: &Arguments) -> &'static [bool] {
    match arguments.effort {
        None => &[true, false],
        Some(Effort::With) => &[true],
        Some(Effort::Without) => &[false],
    }
}

/// All sets, each with its own seed.
fn requests(arguments: &Arguments) -> Vec<SetRequest> {
    let efforts = efforts(arguments);
    let sizes: Vec<Size> = match arguments.size.is_empty() {
        true => SIZES.to_vec(),
        false => arguments.size.iter().map(|size| SIZES[*size as usize]).collect(),
    };
    let chosen = |kind: &&str| arguments.kind.is_empty() || arguments.kind.iter().any(|k| k == kind);
    let kinds: Vec<&'static str> = kinds().filter(chosen).collect();
    let mut rng = ChaCha8Rng::seed_from_u64(arguments.seed);
    let mut requests = Vec::new();
    let nuisances: Vec<Option<Nuisance>> = match arguments.nuisance.is_empty() {
        true => vec![None],
        false => arguments.nuisance.iter().copied().map(Some).collect(),
    };
    let mut request = |kinds: Vec<&'static str>, size, effort, dirty, rng: &mut ChaCha8Rng| {
        for &nuisance in &nuisances {
            requests.push(SetRequest {
                kinds: kinds.clone(),
                size,
                effort,
                dirty,
                rough: arguments.rough,
                driver: arguments.driver.map(Driver::kind),
                nuisance,
                runs: usize::from(arguments.runs),
                seed: rng.random_range(0..u64::from(u32::MAX)),
            });
        }
    };
    for &effort in efforts {
        for _ in 0..arguments.none {
            for dirty in [false, true] {
                request(Vec::new(), Size::Clear, effort, dirty, &mut rng);
            }
        }
        for &size in &sizes {
            for &kind in &kinds {
                for _ in 0..arguments.sets {
                    let dirty = rng.random_bool(arguments.dirty);
                    request(vec![kind], size, effort, dirty, &mut rng);
                }
            }
            for _ in 0..arguments.pairs {
                let dirty = rng.random_bool(arguments.dirty);
                let pair = kinds.sample(&mut rng, 2).copied().collect();
                request(pair, size, effort, dirty, &mut rng);
            }
        }
    }
    requests.retain(|request| arguments.only.is_empty() || arguments.only.contains(&request.seed));
    requests
}

fn one(request: SetRequest, kept: Option<&Path>) -> Result<Done, BenchError> {
    let (seed, kinds) = (request.seed, request.kinds.join(" + "));
    let set = Set::draw(request).map_err(|reason| BenchError { seed, kinds, reason })?;
    let failed = |error: std::io::Error| BenchError::new(&set, error);
    let folder = tempfile::tempdir().map_err(failed)?;
    let folder = kept.unwrap_or(folder.path());
    std::fs::create_dir_all(folder).map_err(failed)?;
    let begun = Instant::now();
    let outcome = blind(&set, folder)?;
    let seconds = begun.elapsed().as_secs_f64();
    if let (Some(folder), Ok(answer)) = (kept, &outcome) {
        // All but the speeds of hold-out runs.
        for (name, bytes) in gap_tables::files(answer).map_err(failed)?.into_iter().take(2) {
            std::fs::write(folder.join(name), bytes).map_err(failed)?;
        }
    }
    let scenario = &set.scenario;
    Ok(Done {
        score: Score::of(&set, &outcome),
        hidden: format!("{:?}", scenario.effects),
        data: format!(
            "{:.0} t, {:?}, {:?}, every {} s",
            scenario.train.mass_kg / 1e3,
            scenario.driver,
            scenario.headings,
            scenario.sensors.sampling_s
        ),
        request: set.request,
        seconds,
    })
}

/// A set in a line, with what was hidden where that was not named.
fn line(done: &Done) -> String {
    let (request, score) = (&done.request, &done.score);
    let word = match (score.exact, score.shared) {
        _ if score.refused.is_some() => "refused",
        (true, _) => "named",
        (false, true) => "shared",
        (false, false) => "missed",
    };
    let outside = match &score.outside[..] {
        [] => String::new(),
        names => format!(", not {}", names.join(", ")),
    };
    let removed = score.removed.map_or("-".to_owned(), |r| format!("{r:.2}"));
    let p_value = score.p_value.map_or("-".to_owned(), |p| format!("{p:.3}"));
    let mut text = format!(
        "{word:<7} {:<24} {:<6} {} {} seed {:<10} {:<44}",
        if request.kinds.is_empty() { "nothing".to_owned() } else { request.kinds.join("+") },
        format!("{:?}", request.size).to_lowercase(),
        if request.effort { "effort   " } else { "no effort" },
        if request.dirty { "dirty" } else { "clean" },
        request.seed,
        done.data,
    );
    if let Some(reason) = &score.refused {
        return format!("{text}\n       {reason}\n");
    }
    text.push_str(&format!(
        " p {p_value} removed {removed} {:.3?} size error {:.2?} place {:.2?} intervals {:?}{outside}  found {}",
        score.gap_mps.unwrap_or_default(),
        score.size_errors,
        score.places,
        score.intervals,
        score.found.join(" + "),
    ));
    if score.left_out > 0 {
        text.push_str(&format!("; {} of {} runs left out", score.left_out, request.runs));
    }
    if !score.rivals.is_empty() {
        text.push_str(&format!(" or {}", score.rivals.join(", ")));
    }
    if !score.candidates.is_empty() {
        text.push_str(&format!("; candidates {}", score.candidates.join(", ")));
    }
    for (name, value, sd) in &score.told {
        text.push_str(&format!("; reported {name} {value:.3} ± {sd:.3}"));
    }
    if let Some((name, value)) = score.nuisance {
        text.push_str(&format!("; there is {name} {value:.3}"));
    }
    if !score.exact && !done.request.kinds.is_empty() {
        text.push_str(&format!("\n       hidden {}", done.hidden));
    }
    text.push('\n');
    text
}
