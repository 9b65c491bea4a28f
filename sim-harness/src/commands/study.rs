//! `rundown study`: the paper's case study on simulated or recorded runs, and the self-test of learning.

mod readings;

use super::experiment::{self, Choice};
use super::recorded::{OpenedCase, RecordedRuns};
use super::{Failure, NOTHING_USABLE, SOME_RUNS_FAILED, WRONG_ARGUMENTS, screen};
use crate::output::files;
use crate::study::case::{calm, case_study, skewed_case_study};
use crate::study::claims::{Claim, Verdict, summary};
use crate::study::figures::{Eyes, Picture, brake, histograms, power, profiles, run, slope};
use crate::study::gather::{Estimators, GatherError, Gathered, Rows, gather};
use crate::study::page::{self, StudyPage, known};
use crate::study::readings::comparison;
use crate::study::run_pages::RunPages;
use crate::study::slope::{SlopeAnswer, SlopePlan};
use crate::study::{claims, description, slope as self_test, tunnel as tunnel_at_best, write};
use crate::{
    simulation::scenario_file::Simulation, study::source::RunSource, study::trials::Trials, study::write::RunTable,
};
use rundown::{estimator::config::Config, model::track::Track, model::train::Train, tick::paper::Difference};
use rundown_files::folder::{self, Provenance};
use rundown_files::{WriteError, parquet::RunWriter, track_file::TrackFile, train_file::TrainFile};
use rundown_pages::numbers::counted;
use serde_json::json;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

const EXAMPLES: &str = "\
Examples:
  Every figure and table of the case study, over 20 sets of runs:
    rundown study --all --seeds 20 --out paper

  The paper's 67 runs, simulated, with the truth beside every figure:
    rundown study --out study

  Recorded runs, folders of logs or of Parquet files:
    rundown study --runs logs/ --train train.toml --track track.toml --out study

  Runs of rundown simulate, whose truth lies beside them and is shown:
    rundown study --runs hidden --train hidden/train.toml --track hidden/track.toml --out study

  A scenario of your own, as for rundown simulate, and a fleet of it:
    rundown study --scenario scenario.toml --out study
    rundown study --count 10000 --out fleet

  Does the estimate follow the true resistance, how closely, and how closely could it?
    rundown study --truth-slope --out slope

  The claims over 20 sets of runs, each with the share of seeds in which it holds:
    rundown study --seeds 20 --out study

  Which reading of the text, with which recorder, gives the paper's figures? (--seeds 20: about four minutes)
    rundown study --readings --out readings
    rundown study --readings --runs logs/ --train train.toml --track track.toml --out readings

  Why did the paper see no tunnel?
    rundown study --tunnel --out tunnel

  What the paper leaves to future work, each question an experiment with a table and a figure
    rundown study --list-experiments
    rundown study --experiment sampling --out sampling
    rundown study --experiment wind --values 0,3,6 --out wind

Files in the output folder:
  report.html, report/  Table 1 and Figs. 1 to 9, each with the paper's statement, our value and the truth
  fig*.svg, fig*.csv    each picture, and the numbers it draws
  slope_*.svg, *.csv    estimated over true deviation of the resistance; slope.csv has slopes and bounds
  claims.csv, .md       the paper's numeric claims: reproduced or not, and why
  readings.md           of --readings, its table, as docs/paper.md quotes it
  slope.md              of --truth-slope, its table, as docs/study.md quotes it
  runs.csv, .parquet    a row for each run: both modes and the truth
  train.toml, track.toml  of simulated runs: what recorded ones bring with them";

/// Vehicles of the slope in the report.
const FEW_VEHICLES: usize = 30;
const SEED: u64 = 1;

#[derive(Debug, clap::Args)]
#[command(after_help = EXAMPLES, after_long_help = format!("{EXAMPLES}\n\n{}", super::AFTER_HELP))]
pub struct Arguments {
    #[command(flatten)]
    recorded: RecordedRuns,
    /// Scenario of simulated runs, as for rundown simulate; without it the case study
    #[arg(long, value_name = "S.toml", conflicts_with = "runs")]
    scenario: Option<PathBuf>,
    /// Simulated runs; without it as many as the scenario says, of which each unit has as many
    #[arg(long, value_name = "N", conflicts_with = "runs")]
    count: Option<usize>,
    /// Seed of everything that is simulated; replaces that of the scenario
    #[arg(long, value_name = "SEED")]
    seed: Option<u64>,
    /// Configuration of the estimator; what it leaves out keeps its default, its mode is not used
    #[arg(long, value_name = "C.toml")]
    config: Option<PathBuf>,
    /// Name of the run of Figs. 3, 5 and 6; without it the one that is nearest to the paper's by its largest speed, its brake and its regimes
    #[arg(long, value_name = "RUN")]
    example: Option<String>,
    /// Folder for the results; made when it does not exist
    #[arg(long, value_name = "DIR", default_value = "out/study")]
    out: PathBuf,
    /// Also write the runs themselves, as one Parquet file outside of --out that --runs takes
    #[arg(long, value_name = "FILE.parquet")]
    keep_runs: Option<PathBuf>,
    #[command(flatten)]
    pages: super::RunPagesChoice,
    /// Only the self-test of learning: vehicles with 0.7 to 1.3 of the described resistance
    #[arg(long, conflicts_with_all = ["runs", "scenario", "count", "example", "keep_runs"])]
    truth_slope: bool,
    /// Only the comparison of readings of the text: with many recorders on simulated runs, or on recorded ones (--runs)
    #[arg(long, conflicts_with_all = ["count", "example", "keep_runs", "truth_slope", "config"])]
    readings: bool,
    /// All of it: the case study with both efforts and by two recorders, its claims beside each other, the readings, the self-test of learning and the tunnel, each in a folder of its own
    #[arg(long, conflicts_with_all = ["runs", "scenario", "count", "example", "keep_runs", "truth_slope", "readings", "tunnel", "config", "json"])]
    all: bool,
    /// Only the tunnel at Best: what the paper's mode and rundown gap make of it
    #[arg(long, conflicts_with_all = ["runs", "scenario", "example", "keep_runs", "truth_slope", "readings", "config"])]
    tunnel: bool,
    /// Only one of the experiments that the paper leaves to future work, or all; --seeds sets (5) of --count runs (20)
    #[arg(long, value_name = "NAME", value_parser = experiment::choices(), conflicts_with_all = ["runs", "scenario", "example", "keep_runs", "truth_slope", "readings", "config", "all", "tunnel"])]
    experiment: Option<Choice>,
    /// Values of your own for the experiment, in the unit of its axis, in place of its variants
    #[arg(long, value_name = "X,Y,...", requires = "experiment", value_delimiter = ',', allow_hyphen_values = true)]
    values: Vec<f64>,
    /// Print the names and questions of the experiments, and nothing else
    #[arg(long)]
    list_experiments: bool,
    /// Simulated sets of runs, each with a seed of its own: claims are judged on each (1), readings compared on all (5)
    #[arg(long, value_name = "N", conflicts_with_all = ["runs", "truth_slope", "tunnel"], value_parser = clap::value_parser!(u16).range(1..))]
    seeds: Option<u16>,
    /// Vehicles of the self-test
    #[arg(long, value_name = "N", default_value_t = 25, requires = "truth_slope", value_parser = clap::value_parser!(u16).range(3..))]
    vehicles: u16,
    /// Runs of each vehicle of the self-test
    #[arg(long, value_name = "N", default_value_t = 67, requires = "truth_slope", value_parser = clap::value_parser!(u16).range(1..))]
    vehicle_runs: u16,
    /// Print the results as JSON to stdout, and nothing else
    #[arg(long)]
    json: bool,
}

struct DescribedCase {
    train_name: String,
    track_name: String,
    train: Train,
    track: Track,
    source: RunSource,
    words: String,
    /// Of simulated runs: what recorded ones bring with them.
    files: Option<(TrainFile, TrackFile)>,
    /// Other sets on which the claims are judged, too.
    others: Vec<RunSource>,
    /// The files that are read.
    inputs: Vec<PathBuf>,
    /// Of the estimator, where the track has a doubt of its own.
    config: Option<Config>,
}

/// What is kept or shown beside the rows of the runs.
#[derive(Clone, Copy)]
struct Kept<'a> {
    /// A file for the runs themselves.
    runs: Option<&'a Path>,
    /// A page for each.
    pages: bool,
    /// The last figure, beside those of the runs: the tunnel.
    last: Option<&'a Picture>,
}

pub(super) struct Study {
    pub(super) gathered: Gathered,
    pub(super) claims: Vec<Claim>,
    pub(super) answers: Vec<SlopeAnswer>,
}

pub(super) fn run(arguments: &Arguments) -> Result<ExitCode, Failure> {
    let config = super::config(arguments.config.as_deref())?;
    if arguments.list_experiments {
        return Ok(experiment::list());
    }
    if let Some(choice) = arguments.experiment {
        let seed = arguments.seed.unwrap_or(SEED);
        let values = (!arguments.values.is_empty()).then_some(arguments.values.as_slice());
        let extent = experiment::Extent { sets: arguments.seeds, runs: arguments.count, seed, values };
        return match choice {
            Choice::All => experiment::all(&extent, &arguments.out, arguments.json),
            Choice::One(one) => experiment::run(one, &extent, &arguments.out, arguments.json),
        };
    }
    if arguments.all {
        return all(arguments, config);
    }
    if arguments.truth_slope {
        return truth_slope(arguments, config, &arguments.out);
    }
    if arguments.readings {
        return readings::compare(arguments, &arguments.out);
    }
    if arguments.tunnel {
        return tunnel(arguments, &arguments.out).map(|_| ExitCode::SUCCESS);
    }
    let simulation = match &arguments.scenario {
        Some(path) => Simulation::read(path),
        None => case_study(),
    }?;
    let as_recorded = arguments.recorded.as_recorded;
    Ok(case_study_or_runs(arguments, config, simulation, as_recorded, None, &arguments.out)?.0)
}

/// Every figure and table, each part in a folder of its own.
fn all(arguments: &Arguments, config: Config) -> Result<ExitCode, Failure> {
    let part = |name: &str| arguments.out.join(name);
    let mut backward = config;
    backward.paper.difference = Difference::Backward;
    let cases = [
        ("backward", backward, case_study()?, false),
        ("study", config, case_study()?, false),
        ("skewed", config, skewed_case_study()?, true),
        ("skewed_put_right", config, skewed_case_study()?, false),
    ];
    let tunnel = tunnel(arguments, &part("tunnel"))?;
    let (mut codes, mut compared) = (Vec::new(), Vec::new());
    for ((folder, config, simulation, as_recorded), name) in cases.into_iter().zip(claims::markdown::READINGS) {
        let last = (folder == "study").then_some(&tunnel);
        let (code, claims) = case_study_or_runs(arguments, config, simulation, as_recorded, last, &part(folder))?;
        codes.push(code);
        compared.push((name, claims));
    }
    folder::write("study", &part("claims"), &Provenance::begin(&[]), |folder| {
        write::text(&folder.join("claims.md"), &claims::markdown::compared(&compared))
    })?;
    codes.push(readings::compare(arguments, &part("readings"))?);
    codes.push(truth_slope(arguments, config, &part("slope"))?);
    Ok(codes.into_iter().find(|code| *code != ExitCode::SUCCESS).unwrap_or(ExitCode::SUCCESS))
}

/// `simulation` is what is studied where no recorded runs are given, `as_recorded` or put right. Out: what the command ends with, and the claims.
fn case_study_or_runs(
    arguments: &Arguments,
    config: Config,
    simulation: Simulation,
    as_recorded: bool,
    last: Option<&Picture>,
    out: &Path,
) -> Result<(ExitCode, Vec<Claim>), Failure> {
    arguments.keep_runs.as_deref().map_or(Ok(()), |file| place_of_runs(file, out))?;
    let described = described(arguments, &config, simulation, as_recorded)?;
    let inputs: Vec<PathBuf> = described.inputs.iter().chain(&arguments.config).cloned().collect();
    let study = folder::write("study", out, &Provenance::begin(&inputs), |folder| {
        let study = study(
            described,
            config,
            arguments.seed.unwrap_or(SEED),
            arguments.example.as_deref(),
            Kept { runs: arguments.keep_runs.as_deref(), pages: arguments.pages.run_pages, last },
            folder,
        )?;
        let (notes, failed) = (&study.gathered.notes, &study.gathered.failed);
        notes.iter().for_each(|text| screen::note(text));
        screen::errors(failed);
        arguments.recorded.strict.check(notes.len() + failed.len())?;
        Ok::<_, Failure>(study)
    })?;
    if study.gathered.paper.runs == 0 {
        return Err(Failure::no_runs("no run could be used; the report says why"));
    }
    if arguments.json {
        screen::print(&json_of(&study));
    } else {
        screen::print(&table(&study));
        let report = out.join("report.html");
        screen::print(&format!("\nreport: {}\n", report.display()));
    }
    // As a replay: a study of runs from which nothing can be learned is none.
    let learned = study.gathered.gated.learned_share.mean().is_some_and(|share| share > 0.0);
    if !learned {
        let runs = study.gathered.paper.runs;
        screen::error(&format!(
            "expected a run that coasts or measures its effort, found none of {runs}: nothing was learned"
        ));
    }
    let code = match study.gathered.failed.len() {
        _ if !learned => ExitCode::from(NOTHING_USABLE),
        0 => ExitCode::SUCCESS,
        _ => ExitCode::from(SOME_RUNS_FAILED),
    };
    Ok((code, study.claims))
}

/// What `--json` prints.
fn json_of(study: &Study) -> String {
    let claims: Vec<_> = claims::records(&study.claims).iter().map(rundown_files::table::to_json).collect();
    let json = json!({
        "runs": study.gathered.paper.runs,
        "runs_with_truth": study.gathered.truth.runs,
        "failed": study.gathered.failed.len(),
        "set_aside": study.gathered.set_aside,
        "diagnosis": study.gathered.checks,
        "sets": summary::sets(&study.claims),
        "sets_needed": claims::Sets::needed(summary::sets(&study.claims)),
        "claims_by_kind": summary::counts(&study.claims),
        "claims": claims,
        "truth_slope": study.answers,
    });
    format!("{json:#}\n")
}

/// Before the work: the folder of the file is made. Not within the results, which are replaced as a whole and have a `runs.parquet` of their own.
fn place_of_runs(file: &Path, out: &Path) -> Result<(), Failure> {
    let [whole, results] = [file, out].map(|path| std::path::absolute(path).unwrap_or_else(|_| path.to_owned()));
    if whole.starts_with(results) {
        let message =
            format!("--keep-runs: expected a file outside of --out {}, found {}", out.display(), file.display());
        return Err(Failure { message, code: WRONG_ARGUMENTS });
    }
    let parent = file.parent().filter(|parent| !parent.as_os_str().is_empty());
    Ok(parent.map_or(Ok(()), files::folder)?)
}

fn described(
    arguments: &Arguments,
    config: &Config,
    simulation: Simulation,
    as_recorded: bool,
) -> Result<DescribedCase, Failure> {
    let Some(opened) = arguments.recorded.open(config)? else {
        let seed = arguments.seed.unwrap_or(simulation.seed);
        let count = arguments.count.unwrap_or(simulation.runs);
        let seeds = usize::from(arguments.seeds.unwrap_or(1));
        return simulated(simulation, seed, count, seeds, as_recorded);
    };
    let OpenedCase { train_file, train, track_file, track, source, inputs, mut config, doubt, .. } = opened;
    doubt.into_iter().for_each(|doubt| doubt.raise(&mut config.track_doubt));
    Ok(DescribedCase {
        train_name: train_file.name,
        track_name: track_file.name,
        train,
        track,
        source,
        words: "read from files".to_owned(),
        files: None,
        inputs,
        config: Some(config),
        others: Vec::new(),
    })
}

fn simulated(
    simulation: Simulation,
    seed: u64,
    count: usize,
    seeds: usize,
    as_recorded: bool,
) -> Result<DescribedCase, Failure> {
    let of_scenario = description::of(&simulation)?;
    let other = |index| RunSource::simulated(simulation.clone(), comparison::seed_of(seed, index), count, as_recorded);
    let words = match seeds {
        1 => format!("simulated with seed {seed}"),
        _ => format!("simulated with seed {seed}, claims also judged on {} other sets", seeds - 1),
    };
    Ok(DescribedCase {
        train_name: format!("{} (simulated)", simulation.train.name),
        track_name: simulation.track.name.clone(),
        config: None,
        inputs: simulation.file.iter().cloned().collect(),
        files: Some((simulation.train.clone(), simulation.track.clone())),
        train: of_scenario.train,
        track: of_scenario.track,
        words,
        others: (1..seeds).map(other).collect(),
        source: RunSource::simulated(simulation, seed, count, as_recorded),
    })
}

/// The simulated case study of the demo.
pub(super) fn of_case_study(seed: u64, out: &Path) -> Result<Study, Failure> {
    let simulation = case_study()?;
    let runs = simulation.runs;
    let described = simulated(simulation, seed, runs, 1, false)?;
    folder::write("study", out, &Provenance::begin(&[]), |folder| {
        study(described, Config::default(), seed, None, Kept { runs: None, pages: true, last: None }, folder)
    })
}

fn study(
    mut described: DescribedCase,
    config: Config,
    seed: u64,
    example: Option<&str>,
    kept: Kept,
    out: &Path,
) -> Result<Study, Failure> {
    let config = described.config.unwrap_or(config);
    let (train, track) = (described.train, described.track.clone());
    let estimators = Estimators::try_new(config, train, &track)?;
    if let Some((train, track)) = &described.files {
        for (name, text) in [("train.toml", toml::to_string(train)), ("track.toml", toml::to_string(track))] {
            write::text(&out.join(name), &text.map_err(Failure::not_written)?)?;
        }
    }
    let gathered = gathered(&mut described, &estimators, example, kept, out)?;
    if let (Some(name), None, 1..) = (example, &gathered.example, gathered.paper.runs) {
        let message = format!("--example: expected the name of a run that could be used, found {name}");
        return Err(Failure { message, code: WRONG_ARGUMENTS });
    }
    let trials = Trials::of(&config, &estimators, &track, &gathered.drawn)?;
    let others = of_others(&mut described.others, &config, &estimators, &track)?;
    let claims = claims::over_sets(claims::claims(&gathered, &train, &trials), &others);
    // What the slope is does not depend on the runs of this study: it is measured on simulated vehicles on the paper's line.
    let plan = SlopePlan { simulation: calm()?, vehicles: FEW_VEHICLES, runs: 1, seed };
    let test = self_test::self_test(&plan, config, || ())?;
    let slopes = [slope::slope(&test, 1)];
    let pictures = pictures(&gathered, &train);
    let text = page::page(&StudyPage {
        train: &described.train_name,
        track: &described.track_name,
        source: described.words,
        gathered: &gathered,
        pictures: &pictures,
        slopes: &slopes,
        answers: &test.answers,
        claims: &claims,
        sensitivity: &trials.sensitivity,
        filter: config.paper,
        has_run_pages: kept.pages,
        tunnel: kept.last,
    });
    write::pictures(out, &pictures)?;
    write::pictures(out, kept.last.map_or(&[], std::slice::from_ref))?;
    write::pictures(out, &slopes)?;
    write::records(&out.join("claims.csv"), &claims::records(&claims))?;
    write::text(&out.join("claims.md"), &claims::markdown::one(&claims))?;
    write::records(&out.join("slope.csv"), &self_test::records(&test.answers))?;
    write::text(&out.join("fig1_method.svg"), page::METHOD)?;
    write::text(&out.join("report.html"), &text)?;
    Ok(Study { gathered, claims, answers: test.answers })
}

/// The claims on other sets of runs.
fn of_others(
    sources: &mut [RunSource],
    config: &Config,
    estimators: &Estimators,
    track: &Track,
) -> Result<Vec<Vec<Claim>>, Failure> {
    let bar = screen::progress(sources.iter().map(RunSource::total).sum());
    let one = |source: &mut RunSource| {
        let gathered = gather(source, estimators, None, &mut |_| Ok(()), |count| bar.inc(count as u64));
        let gathered = gathered.map_err(Failure::refused)?;
        let trials = Trials::of(config, estimators, track, &gathered.drawn)?;
        Ok(claims::claims(&gathered, estimators.paper.train(), &trials))
    };
    let found = sources.iter_mut().map(one).collect();
    bar.finish_and_clear();
    found
}

/// Replays all runs and writes their table, and the runs themselves where they are to be kept.
fn gathered(
    described: &mut DescribedCase,
    estimators: &Estimators,
    example: Option<&str>,
    kept: Kept,
    out: &Path,
) -> Result<Gathered, Failure> {
    let mut table = RunTable::begin(out)?;
    let title = page::title(&described.train_name, &described.track_name);
    let pages = || RunPages::begin(out.to_owned(), title, &estimators.gated);
    let mut pages = kept.pages.then(pages).transpose()?;
    let mut kept = kept.runs.map(|path| (path, RunWriter::new(path)));
    let source = &mut described.source;
    let bar = screen::progress(source.total());
    let mut sink = |rows: &Rows| {
        if let Some((_, kept)) = &mut kept {
            kept.write(rows.all.iter().map(|one| one.recording())).map_err(std::io::Error::other)?;
        }
        pages.as_mut().map_or(Ok(()), |pages| pages.add(rows.used)).map_err(std::io::Error::other)?;
        table.add(rows.records)
    };
    let gathered = gather(source, estimators, example, &mut sink, |count| bar.inc(count as u64));
    let gathered = gathered.map_err(|error| match error {
        GatherError::Runs(error) => Failure::refused(error),
        other => Failure::not_written(other),
    })?;
    bar.finish_and_clear();
    table.end()?;
    pages.map_or(Ok(()), RunPages::end)?;
    if let Some((path, writer)) = kept {
        writer.close().map_err(Failure::not_written)?;
        log::info!("wrote {}", path.display());
    }
    Ok(gathered)
}

fn pictures(gathered: &Gathered, train: &Train) -> Vec<Picture> {
    let drawn = &gathered.drawn;
    let mut pictures = vec![profiles::profiles(drawn, gathered.paper.runs)];
    for eyes in Eyes::BOTH {
        let tallies = eyes.pick(&gathered.paper, &gathered.gated);
        pictures.push(histograms::davis(drawn, eyes, &train.davis()));
        pictures.push(histograms::style(drawn, eyes));
        pictures.push(brake::brake(drawn, eyes, tallies, &gathered.truth));
        pictures.push(power::power(drawn, eyes, train));
        pictures.push(power::low_speeds(drawn, eyes, train));
        if let Some(example) = &gathered.example {
            pictures.extend(run::pictures(example, eyes, train));
        }
    }
    pictures
}

pub(super) fn table(study: &Study) -> String {
    let (runs, known) = (study.gathered.paper.runs, known(&study.gathered));
    let runs = counted(runs as usize, "run", "runs");
    let (kinds, basis) = (summary::by_kind(&study.claims), summary::basis(&study.claims));
    let elsewhere = summary::elsewhere(&study.claims);
    let mut text = format!("{runs}; {known}\nclaims that hold: {kinds}\n{elsewhere}{basis}\n\n");
    for claim in &study.claims {
        let mark = match claim.verdict {
            Verdict::Reproduced => "yes",
            Verdict::Not => "NO",
            Verdict::NotVisible => "tiny",
            Verdict::NoData => "-",
            Verdict::Elsewhere => "else",
        };
        let sets = match claim.sets.all {
            0 | 1 => String::new(),
            _ => format!(" ({} sets)", claim.sets.words()),
        };
        text += &format!("{:4} {:4} {:9} {}{sets}\n", claim.place, mark, claim.kind.as_str(), claim.statement);
        text += &format!(
            "          paper's mode: {}; gated: {}; truth: {}; error: {}\n",
            claim.paper, claim.gated, claim.truth, claim.error
        );
        if let (Verdict::NotVisible, Some(least)) = (claim.verdict, claim.least) {
            text += &format!("          not visible: below {}\n", least.reason);
        }
    }
    text += "\nDoes the estimate follow the truth? Simulated vehicles with 0.7 to 1.3 of the described resistance:\n";
    text += &self_test::table(&study.answers);
    text
}

fn truth_slope(arguments: &Arguments, config: Config, out: &Path) -> Result<ExitCode, Failure> {
    let provenance = Provenance::begin(&arguments.config.iter().cloned().collect::<Vec<_>>());
    let plan = SlopePlan {
        simulation: calm()?,
        vehicles: usize::from(arguments.vehicles),
        runs: usize::from(arguments.vehicle_runs),
        seed: arguments.seed.unwrap_or(SEED),
    };
    let bar = screen::progress(plan.vehicles * plan.runs);
    let test = self_test::self_test(&plan, config, || bar.inc(1))?;
    bar.finish_and_clear();
    let pictures: Vec<Picture> = plan.stages().into_iter().map(|runs| slope::slope(&test, runs)).collect();
    let json = json!({ "vehicles": plan.vehicles, "runs": plan.runs, "seed": plan.seed, "answers": test.answers });
    let json = format!("{json:#}\n");
    folder::write("study", out, &provenance, |folder| -> Result<(), WriteError> {
        write::pictures(folder, &pictures)?;
        write::records(&folder.join("slope.csv"), &self_test::records(&test.answers))?;
        write::text(&folder.join("slope.md"), &self_test::markdown(&test.answers))?;
        write::text(&folder.join("slope.json"), &json)
    })?;
    match arguments.json {
        true => screen::print(&json),
        false => {
            screen::print(&self_test::table(&test.answers));
            screen::print(&format!("\nresults: {}\n", out.display()));
        }
    }
    Ok(ExitCode::SUCCESS)
}

/// Out: its picture.
fn tunnel(arguments: &Arguments, out: &Path) -> Result<Picture, Failure> {
    let (answer, json) = folder::write("study", out, &Provenance::begin(&[]), |folder| {
        let answer = tunnel_at_best::answer(folder, arguments.seed, arguments.count, screen::note)?;
        let json = tunnel_json(&answer);
        write::pictures(folder, &[answer.picture()])?;
        write::text(&folder.join("tunnel.json"), &json)?;
        Ok::<_, Failure>((answer, json))
    })?;
    match arguments.json {
        true => screen::print(&json),
        false => {
            screen::print(&answer.words());
            screen::print(&format!("\nresults: {}\n", out.display()));
        }
    }
    Ok(answer.picture())
}

fn tunnel_json(answer: &tunnel_at_best::TunnelAnswer) -> String {
    let [backward, forward] = answer.largest();
    let drag = |d: &tunnel_at_best::Drag| json!({ "from_m": d.from_m, "to_m": d.to_m, "k": d.k });
    let json = json!({
        "runs": answer.runs,
        "truth": drag(&answer.truth),
        "r0_differs_by": { "backward": backward, "forward": forward },
        "found": answer.found.iter().map(|(d, _)| drag(d)).collect::<Vec<_>>(),
        "named": answer.named,
    });
    format!("{json:#}\n")
}
