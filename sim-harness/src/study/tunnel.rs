//! Why "no influence was observed" (section 4.2): a tunnel in the truth, in the coefficients of the paper's mode, and
//! in `rundown gap`.
//!
//! In: the scenario with the tunnel, and the same without it. Out: by how much r0 of the paper's loop differs along the
//! line, backward and forward, and what the gap workflow finds on the runs with the tunnel.

use super::case::{Case, FleetUnit};
use super::figures::Picture;
use super::readings::pass::Filter;
use super::readings::reading::Reading;
use super::{Refused, description, moments::Moments};
use crate::simulation::folder;
use crate::simulation::scenario_file::Simulation;
use rayon::prelude::*;
use rundown::model::effects::EffectKind;
use rundown::model::line::Line;
use rundown::tick::paper::Difference;
use rundown_files::column::{Column, Filled, filled};
use rundown_gap::{config::GapConfig, input::Input};
use rundown_pages::chart::{Figure, Grid, Layer, Panel, Stroke};
use rundown_pages::colours;
use rundown_pages::numbers::counted;
use std::path::Path;

const WITH_TUNNEL: &str = include_str!("../../../data/scenarios/tunnel_best.toml");
/// Length of a stretch over which r0 is averaged, m.
const STRETCH_M: f64 = 500.0;
/// Speed at which the drag is drawn, m/s.
const DRAWN_MPS: f64 = 130.0 / 3.6;

/// Where extra drag acts, m, and how much, N/(kg (m/s)²).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Drag {
    pub from_m: f64,
    pub to_m: f64,
    pub k: f64,
}

#[derive(Clone, Debug)]
pub struct TunnelAnswer {
    /// Location, m, and r0 with over without the tunnel less 1, backward and forward, of each stretch.
    pub r0: Vec<(f64, [f64; 2])>,
    pub truth: Drag,
    /// Tunnels that the gap workflow names, with their confidence.
    pub found: Vec<(Drag, f64)>,
    pub named: Vec<&'static str>,
    pub runs: usize,
}

/// Drives, filters and investigates; the runs with the tunnel are written below `out`.
///
/// # Errors
/// What cannot be driven, written or investigated.
pub fn answer(
    out: &Path,
    seed: Option<u64>,
    runs: Option<usize>,
    tell: impl Fn(&str),
) -> Result<TunnelAnswer, Refused> {
    let mut with = Simulation::parse(Path::new("tunnel_best.toml"), WITH_TUNNEL)?;
    with.seed = seed.unwrap_or(with.seed);
    with.runs = runs.unwrap_or(with.runs);
    // The description of the line has a tunnel nearby, which the workflow would take for granted.
    with.track.tunnel.clear();
    let mut without = with.clone();
    without.scenario.effects.clear();
    let truth = tunnel(&with)?;
    tell("the paper's mode with and without the tunnel");
    let [inside, outside] = [mean_r0(&with)?, mean_r0(&without)?];
    let of_stretch = |(index, (a, b)): (usize, (&[Moments; 2], &[Moments; 2]))| {
        let share = |i: usize| Some(a[i].mean()? / b[i].mean()? - 1.0);
        Some(((index as f64 + 0.5) * STRETCH_M, [share(0)?, share(1)?]))
    };
    let r0 = inside.iter().zip(&outside).enumerate().filter_map(of_stretch).collect();
    tell("the gap workflow on the runs with the tunnel");
    let set = out.join("set");
    folder::write(&with, &set, true, || ())?;
    let found = rundown_gap::run(Input::of_set(&set)?, GapConfig::default(), None, |step| tell(step))?.found;
    let tunnels = found.named.iter().filter(|one| one.effect.kind() == EffectKind::TunnelDrag);
    let drag = |one: &rundown_gap::named::Named| {
        let [from_m, to_m, k] = ["from_m", "to_m", "k"].map(|name| one.value(name));
        (Drag { from_m, to_m, k }, one.confidence)
    };
    Ok(TunnelAnswer {
        r0,
        truth,
        found: tunnels.map(drag).collect(),
        named: found.named.iter().map(|one| one.effect.name()).collect(),
        runs: with.runs,
    })
}

/// The tunnel of the scenario, as its file has it.
fn tunnel(simulation: &Simulation) -> Result<Drag, Refused> {
    let file: toml::Table = simulation.text.parse()?;
    let effect = file.get("effect").and_then(|effects| effects.as_array()?.first()?.as_table());
    let value = |name: &str| effect.and_then(|effect| effect.get(name)?.as_float());
    match [value("from_m"), value("to_m"), value("k")] {
        [Some(from_m), Some(to_m), Some(k)] => Ok(Drag { from_m, to_m, k }),
        _ => Err("the scenario has no tunnel".into()),
    }
}

/// r0 of all runs by stretch, backward and forward.
fn mean_r0(simulation: &Simulation) -> Result<Vec<[Moments; 2]>, Refused> {
    let described = description::of(simulation)?;
    let unit = FleetUnit::new(simulation, simulation.seed, 0);
    let runs: Result<Vec<Case>, _> = (0..FleetUnit::runs(simulation)).into_par_iter().map(|i| unit.drive(i)).collect();
    let mut stretches = vec![<[Moments; 2]>::default(); (described.track.length_m() / STRETCH_M).ceil() as usize];
    for case in runs? {
        let run = &case.recording;
        let line = Line { train: &described.train, track: &described.track, direction: run.direction };
        for (index, difference) in [Difference::Backward, Difference::Forward].into_iter().enumerate() {
            let pass = Filter::from(Reading::of(difference).config()).pass(&line, run);
            for (davis, location_m) in pass.davis.iter().zip(&pass.location_m) {
                let stretch = (location_m.max(0.0) / STRETCH_M) as usize;
                stretches.get_mut(stretch).into_iter().for_each(|both| both[index].add(davis[0]));
            }
        }
    }
    Ok(stretches)
}

impl TunnelAnswer {
    /// Largest difference of r0 from the tunnel on, as a share, backward and forward.
    pub fn largest(&self) -> [f64; 2] {
        let behind = || self.r0.iter().filter(|(m, _)| *m >= self.truth.from_m);
        [0, 1].map(|index| behind().map(|(_, shares)| shares[index].abs()).fold(0.0, f64::max))
    }

    pub fn words(&self) -> String {
        let [backward, forward] = self.largest().map(|share| 100.0 * share);
        let drag = |d: &Drag| format!("{:.0} to {:.0} m, k = {:.3e} N/(kg (m/s)\u{b2})", d.from_m, d.to_m, d.k);
        let mut text = format!(
            "{}, tunnel {}\nthe paper's mode: r0 with and without it differs by at most {backward:.3} % (backward), {forward:.3} % (forward)\n",
            counted(self.runs, "run", "runs"),
            drag(&self.truth)
        );
        for (found, confidence) in &self.found {
            text += &format!("rundown gap: tunnel_drag {}, confidence {confidence:.2}\n", drag(found));
        }
        if self.found.is_empty() {
            text += "rundown gap: names no tunnel\n";
        }
        text + &format!("all that it names: {}\n", self.named.join(", "))
    }

    pub fn picture(&self) -> Picture {
        let x = 0.0..self.r0.last().map_or(1.0, |(m, _)| m / 1000.0 + 0.25);
        let line = |legend, colour, index: usize| {
            let points = self.r0.iter().map(|(m, shares)| Some((m / 1000.0, 100.0 * shares[index]))).collect();
            Layer::line(legend, colour, Stroke::Solid, points)
        };
        let span = self.truth.from_m / 1000.0..self.truth.to_m / 1000.0;
        let drag = |d: &Drag| {
            let top = 1e3 * d.k * DRAWN_MPS * DRAWN_MPS;
            let (from, to) = (d.from_m / 1000.0, d.to_m / 1000.0);
            [(x.start, 0.0), (from, 0.0), (from, top), (to, top), (to, 0.0), (x.end, 0.0)].map(Some).to_vec()
        };
        let mut drags = vec![Layer::line("true", colours::TRUTH, Stroke::Solid, drag(&self.truth))];
        drags.extend(
            self.found.iter().map(|(d, _)| Layer::line("rundown gap", colours::ESTIMATED, Stroke::Dashed, drag(d))),
        );
        let panels = [
            Figure::in_grid(
                "location, km",
                x.clone(),
                Panel::new(
                    "r0 of the paper's mode, with less without the tunnel, %",
                    420,
                    vec![
                        Layer::spans("tunnel", colours::LEARNING, 0.3, vec![span]),
                        line("backward", colours::MEASURED, 0),
                        line("forward", colours::ESTIMATED, 1),
                    ],
                    "no run",
                ),
            ),
            Figure::in_grid(
                "location, km",
                x.clone(),
                Panel::new("extra resistance at 130 km/h, 10\u{207b}\u{b3} N/kg", 420, drags, "no run"),
            ),
        ];
        Picture {
            name: "tunnel".to_owned(),
            caption: format!(
                "A tunnel that the description does not have, {}: what it does to r0 of the paper's mode (mean by {STRETCH_M} m), and what rundown gap finds on the same runs with an effort column.",
                counted(self.runs, "run", "runs")
            ),
            drawing: Grid::new(
                "A tunnel in the paper's mode and in the gap workflow",
                "Two panels over location",
                2,
                panels.to_vec(),
            )
            .into(),
            numbers: self.numbers(),
        }
    }

    fn numbers(&self) -> Filled {
        let r0 =
            self.r0.iter().map(|(m, shares)| TunnelRow { kind: "r0", location_m: *m, drag: None, r0: Some(*shares) });
        let drag = |kind, d: &Drag| TunnelRow { kind, location_m: d.from_m, drag: Some(*d), r0: None };
        let found = self.found.iter().map(|(d, _)| drag("found", d));
        filled(columns(), r0.chain([drag("true", &self.truth)]).chain(found))
    }
}

/// A stretch of the line, or a tunnel.
#[derive(Debug)]
pub struct TunnelRow {
    kind: &'static str,
    location_m: f64,
    drag: Option<Drag>,
    r0: Option<[f64; 2]>,
}

/// The columns of `tunnel.csv`.
pub fn columns() -> Vec<Column<TunnelRow>> {
    let (r0, tunnel) = ("`kind` is not `r0`", "`kind` is `r0`");
    let kind = "`r0`: what the tunnel does to r0 of the paper's mode, `true`: the tunnel, `found`: one that \
        `rundown gap` names";
    let share = "r0 with over without the tunnel, less 1, by the";
    vec![
        Column::text("kind", kind, |row: &TunnelRow| row.kind),
        Column::number("location_m", "m", "middle of the stretch, or where the tunnel begins", |row: &TunnelRow| {
            row.location_m
        }),
        Column::number("to_m", "m", "where the tunnel ends", |row: &TunnelRow| row.drag.map(|drag| drag.to_m))
            .empty_when(tunnel),
        Column::number("k", "N/kg per (m/s)\u{b2}", "extra drag by the square of speed", |row: &TunnelRow| {
            row.drag.map(|drag| drag.k)
        })
        .empty_when(tunnel),
        Column::number("backward", "1", &format!("{share} backward effort"), |row: &TunnelRow| {
            row.r0.map(|both| both[0])
        })
        .empty_when(r0),
        Column::number("forward", "1", &format!("{share} forward effort"), |row: &TunnelRow| {
            row.r0.map(|both| both[1])
        })
        .empty_when(r0),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::output::markdown::{measured, page};

    /// What the document says is what `rundown study --all` wrote.
    #[test]
    fn the_words_of_the_document_are_those_that_were_measured() {
        let json: serde_json::Value = serde_json::from_str(&measured("tunnel.json")).unwrap();
        let words = page("paper.md").split_whitespace().collect::<Vec<_>>().join(" ");
        let value = |path: &str| json.pointer(path).and_then(serde_json::Value::as_f64).unwrap();
        let metres = |path: &str| {
            let metres = value(path).round();
            let (thousands, rest) = ((metres / 1000.0).floor(), metres % 1000.0);
            if thousands >= 10.0 { format!("{thousands} {rest:03}") } else { format!("{metres}") }
        };
        let [backward, forward] = ["backward", "forward"].map(|by| 100.0 * value(&format!("/r0_differs_by/{by}")));
        for sentence in [
            format!("at most {backward:.3} % (backward) or {forward:.3} % (forward)"),
            format!(
                "from {} to {} m with k = {:.3e} N",
                metres("/found/0/from_m"),
                metres("/found/0/to_m"),
                value("/found/0/k")
            ),
        ] {
            assert!(words.contains(&sentence), "{sentence}");
        }
    }

    #[test]
    fn the_scenario_has_58_percent_more_drag_over_1900_m() {
        let simulation = Simulation::parse(Path::new("t.toml"), WITH_TUNNEL).unwrap();
        let found = tunnel(&simulation).unwrap();
        assert!((found.to_m - found.from_m - 1900.0).abs() < 1e-9);
        assert!((found.k / simulation.train.train().unwrap().davis().r2 - 0.58).abs() < 1e-9);
    }

    #[test]
    fn the_paper_mode_hardly_sees_a_tunnel() {
        let mut with = Simulation::parse(Path::new("t.toml"), WITH_TUNNEL).unwrap();
        with.runs = 5;
        let mut without = with.clone();
        without.scenario.effects.clear();
        let [inside, outside] = [&with, &without].map(|simulation| mean_r0(simulation).unwrap());
        let mut compared = 0;
        for (a, b) in inside.iter().zip(&outside) {
            for index in [0, 1] {
                if let (Some(a), Some(b)) = (a[index].mean(), b[index].mean()) {
                    assert!((a / b - 1.0).abs() < 1e-3, "{a} {b}");
                    compared += 1;
                }
            }
        }
        assert!(compared > 100, "{compared}");
    }
}
