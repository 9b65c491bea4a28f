//! The case study, of simulated or recorded runs: its runs gathered, its claims judged, its figures drawn and written.

use super::described::{DescribedCase, described, simulated};
use super::words::{json_of, table};
use super::{Arguments, Study};
use crate::commands::{Failure, NOTHING_USABLE, SOME_RUNS_FAILED, screen};
use crate::output::files;
use crate::simulation::scenario_file::Simulation;
use crate::study::case::{calm, case_study};
use crate::study::claims::{self, Claim};
use crate::study::figures::{Eyes, Picture, brake, histograms, power, profiles, run, slope};
use crate::study::gather::{Estimators, GatherError, Gathered, Rows, gather};
use crate::study::page::{self, StudyPage};
use crate::study::run_pages::RunPages;
use crate::study::slope::{self as self_test, SlopePlan};
use crate::study::{source::RunSource, trials::Trials, write, write::RunTable};
use rundown::{estimator::config::Config, model::track::Track, model::train::Train};
use rundown_files::folder::{self, Provenance};
use rundown_files::parquet::RunWriter;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

/// Vehicles of the slope in the report.
const FEW_VEHICLES: usize = 30;
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

/// One case study: what is studied, and how.
pub(super) struct Part<'a> {
    pub(super) config: Config,
    /// Where no recorded runs are given.
    pub(super) simulation: Simulation,
    /// Its runs are not put right.
    pub(super) as_recorded: bool,
    /// The last figure.
    pub(super) last: Option<&'a Picture>,
}

/// Out: what the command ends with, and the claims.
pub(super) fn study_part(arguments: &Arguments, part: Part<'_>, out: &Path) -> Result<(ExitCode, Vec<Claim>), Failure> {
    let Part { config, simulation, as_recorded, last } = part;
    arguments.keep_runs.as_deref().map_or(Ok(()), |file| place_of_runs(file, out))?;
    let described = described(arguments, &config, simulation, as_recorded)?;
    let inputs: Vec<PathBuf> = described.inputs.iter().chain(&arguments.config).cloned().collect();
    let study = folder::write("study", out, &Provenance::begin(&inputs), |folder| {
        let study = study(
            described,
            config,
            arguments.seed(),
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
        screen::print(&screen::small_errors(study.small_errors));
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

/// Before the work: the folder of the file is made. Not within the results, which are replaced as a whole and have a
/// `runs.parquet` of their own.
fn place_of_runs(file: &Path, out: &Path) -> Result<(), Failure> {
    let [whole, results] = [file, out].map(|path| std::path::absolute(path).unwrap_or_else(|_| path.to_owned()));
    if whole.starts_with(results) {
        let (out, file) = (out.display(), file.display());
        return Err(Failure::arguments(format_args!(
            "--keep-runs: expected a file outside of --out {out}, found {file}"
        )));
    }
    let parent = file.parent().filter(|parent| !parent.as_os_str().is_empty());
    Ok(parent.map_or(Ok(()), files::folder)?)
}

/// The simulated case study of the demo.
pub(in crate::commands) fn of_case_study(seed: u64, out: &Path) -> Result<Study, Failure> {
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
        let message = format_args!("--example: expected the name of a run that could be used, found {name}");
        return Err(Failure::arguments(message));
    }
    let trials = Trials::of(&config, &estimators, &track, &gathered.drawn)?;
    let others = of_others(&mut described.others, &config, &estimators, &track)?;
    let claims = claims::over_sets(claims::claims(&gathered, &train, &trials), &others);
    // What the slope is does not depend on the runs of this study: it is measured on simulated vehicles on the paper's
    // line.
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
    let gradient_sd_permille = config.track_doubt.gradient_sd_permille;
    Ok(Study { gathered, claims, answers: test.answers, small_errors: described.small_errors, gradient_sd_permille })
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
