//! `rundown demo`: the paper's case study, simulated, through the on-board code, and a short table of what it says;
//! then a hidden effect, found.

use super::study::{Study, of_case_study};
use super::{Failure, gap, screen};
use crate::simulation::scenario_file::{HIDDEN_EFFECT, Simulation};
use crate::{simulation::folder, study::case::case_study, study::claims::Verdict, study::description};
use rundown::{model::resistance::Davis, model::units::KmPerHour};
use rundown_pages::numbers::counted;
use rundown_truth::scenario::Scenario;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

const SPEEDS_KMH: [f64; 3] = [60.0, 100.0, 140.0];
/// The same runs every time.
const SEED: u64 = 1;

#[derive(Debug, clap::Args)]
pub struct Arguments {
    /// Folder for the results; made when it does not exist
    #[arg(long, value_name = "DIR", default_value = "out/demo")]
    out: PathBuf,
}

/// Simulates and replays the runs, writes what `rundown study` writes, and prints the table. Then what `rundown gap`
/// says of runs with a hidden effect.
pub(super) fn run(arguments: &Arguments) -> Result<ExitCode, Failure> {
    screen::print(
        "The paper's 67 runs are simulated and replayed through the code of the board, in the paper's mode and in the gated\n\
         one; then 67 runs through a tunnel that the model lacks are simulated, and the tunnel is looked for. About 12 s.\n\n",
    );
    let study = of_case_study(SEED, &arguments.out)?;
    let simulation = case_study()?;
    let described = description::of(&simulation)?;
    screen::print(&table(&study, &simulation.scenario, &described.train.davis()));
    let code = hidden_effect(&arguments.out)?;
    screen::print(&to_open(&arguments.out));
    Ok(code)
}

/// Three lines: what to look at, and how to go on.
fn to_open(out: &Path) -> String {
    format!(
        "\nopen {}: the case study, figure by figure, with the truth\n\
         open {}: where model and train disagree, and the tunnel that explains it\n\
         your own logs: `rundown import --help`, then `rundown replay` and `rundown gap`; README.md has the commands\n",
        out.join("report.html").display(),
        out.join("gap").join("report.html").display()
    )
}

/// Hides a tunnel in simulated runs and looks for it with the description that does not have it.
fn hidden_effect(out: &Path) -> Result<ExitCode, Failure> {
    let simulation = Simulation::parse("hidden_effect.toml".as_ref(), HIDDEN_EFFECT);
    let simulation = simulation?;
    let set = out.join("hidden");
    screen::print(&format!(
        "\nA hidden effect: {} with {}, investigated with a model that lacks it\n",
        counted(simulation.runs, "run", "runs"),
        simulation.name
    ));
    folder::write(&simulation, &set, true, || ())?;
    gap::run(&gap::Arguments::of_set(&set, out.join("gap")))
}

fn table(study: &Study, scenario: &Scenario, stated: &Davis) -> String {
    let of_vehicle = scenario.train.davis.scaled(scenario.davis_scale);
    let truth = Davis { r0: of_vehicle.r0, r1: of_vehicle.r1, r2: of_vehicle.r2 };
    let gathered = &study.gathered;
    let mean = |moments: &[crate::study::moments::Moments; 3]| {
        let [r0, r1, r2] = moments.map(|m| m.mean().unwrap_or(f64::NAN));
        Davis { r0, r1, r2 }
    };
    let paper = mean(&gathered.paper.davis);
    let mut text = format!(
        "{}, {}, through the code of the board\n\n{:19} {:>12} {:>12} {:>12}   {}\n",
        counted(gathered.paper.runs as usize, "simulated run", "simulated runs"),
        counted(gathered.rows as usize, "sample", "samples"),
        "running resistance",
        "described",
        "true",
        "paper's mode",
        "gated mode, the vehicle after the last run, 95 %"
    );
    for speed_kmh in SPEEDS_KMH {
        let v = KmPerHour(speed_kmh).to_mps();
        let of = |davis: &Davis| format!("{:.5} N/kg", davis.resistance_n_per_kg(v));
        let gated = gathered.units.first();
        text += &format!(
            "{:19} {:>12} {:>12} {:>12}   {}\n",
            format!("  at {speed_kmh} km/h"),
            of(stated),
            of(&truth),
            of(&paper),
            gated.map_or_else(String::new, |(_, davis)| screen::resistance(davis, speed_kmh))
        );
    }
    text += "\nslope of estimated on true deviation, 60/100/140 km/h, after one run (1 follows the truth, 0 does not see it)\n";
    for answer in &study.answers {
        let [a, b, c] = answer.slope;
        text += &format!("  {:17} {a:.2} / {b:.2} / {c:.2}\n", answer.mode);
    }
    let seconds = |m: &crate::study::moments::Moments| {
        format!("{:.0} \u{b1} {:.0} s", m.mean().unwrap_or(f64::NAN), m.sd().unwrap_or(f64::NAN))
    };
    text += &format!(
        "\nfinal coast         {} (true {})\nfinal brake         {} (true {})\n",
        seconds(&gathered.gated.coast_s),
        seconds(&gathered.truth.coast_s),
        seconds(&gathered.gated.brake_s),
        seconds(&gathered.truth.brake_s),
    );
    let count = |verdict| study.claims.iter().filter(|c| c.verdict == verdict).count();
    text += &format!(
        "claims of the paper {} reproduced, {} not, {} without data\n",
        count(Verdict::Reproduced),
        count(Verdict::Not) + count(Verdict::NotVisible),
        count(Verdict::NoData)
    );
    text
}
