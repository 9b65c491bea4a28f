//! The surface of the score around the optimum: each parameter alone, and the two readings' noise against each other.

use super::parameters::{COUNT, PARAMETERS, Place, within};
use super::score::Bench;
use crate::study::figures::Picture;
use rundown_files::column::{Column, filled};
use rundown_pages::chart::{Figure, Grid, Layer, Panel, Stroke, range_of};
use rundown_pages::colours;

/// Places along a parameter, to each side.
const HALF: i32 = 8;
/// How far is looked to each side, in decades.
const REACH: f64 = 1.5;
/// The plane: noise of the location against noise of the speed.
const PLANE: [usize; 2] = [8, 9];
/// Loss of likelihood a sample at which the colours end.
const DEEPEST: f64 = 2.0;
/// A scale of losses ends here at least.
const FINEST: f64 = 0.01;

/// Places that [`profiles`] and [`plane`] ask for.
pub const EVALUATIONS: usize = COUNT * (2 * HALF as usize + 1) + (HALF as usize + 1) * (HALF as usize + 1);

#[derive(Clone, Copy, Debug, PartialEq)]
struct Spot {
    value: f64,
    /// Cost above the optimum's.
    above: f64,
    negative: bool,
}

/// A place on a profile.
#[derive(Debug)]
pub struct SurfaceRow {
    parameter: &'static str,
    value: f64,
    above: f64,
    negative: bool,
}

/// The columns of `tune_profiles.csv`.
pub fn profile_columns() -> Vec<Column<SurfaceRow>> {
    let unit = "that of the parameter";
    let negative = "`yes` where a coefficient is negative somewhere, or `no`";
    vec![
        Column::text("parameter", "name of the parameter, as in `tune.json`", |row: &SurfaceRow| row.parameter),
        Column::number("value", unit, "its value, the others as at the optimum", |row: &SurfaceRow| row.value),
        Column::number("cost_above_optimum", "nat", LOSS, |row: &SurfaceRow| row.above).empty_when(NO_FILTER),
        Column::text("negative_coefficient", negative, |row: &SurfaceRow| if row.negative { "yes" } else { "no" }),
    ]
}

const LOSS: &str = "loss of likelihood a sample, less that of the optimum";
const NO_FILTER: &str = "no filter runs with these values, or the search does not go there";

/// A place of the plane: noise of location, m, of speed, km/h, and the loss.
type PlaneRow = [f64; 3];

/// The columns of `tune_plane.csv`.
pub fn plane_columns() -> Vec<Column<PlaneRow>> {
    vec![
        Column::number("location_sd_m", "m", "standard deviation of the location reading", |row: &PlaneRow| row[0]),
        Column::number("speed_sd_kmh", "km/h", "standard deviation of the speed reading", |row: &PlaneRow| row[1]),
        Column::number("cost_above_optimum", "nat", LOSS, |row: &PlaneRow| row[2]).empty_when(NO_FILTER),
    ]
}

fn spot(bench: &Bench, place: &Place, value: f64, least: f64) -> Spot {
    let score = bench.score(place);
    Spot {
        value,
        above: score.map_or(f64::INFINITY, |score| score.cost() - least),
        negative: score.is_none_or(|score| score.negative_samples > 0),
    }
}

pub fn profiles(bench: &Bench, optimum: &Place, table1: &Place, done: impl Fn()) -> Picture {
    // The simplex ends at the end of a range give or take its last digits.
    let optimum = within(optimum);
    let least = bench.cost(&optimum);
    let (mut figures, mut rows) = (Vec::new(), Vec::new());
    for (index, parameter) in PARAMETERS.iter().enumerate() {
        let [from, to] = parameter.ends();
        let spots: Vec<Spot> = (-HALF..=HALF)
            .filter_map(|step| {
                let mut place = optimum;
                place[index] += REACH * f64::from(step) / f64::from(HALF);
                done();
                let is_within = (from..=to).contains(&place[index]);
                is_within.then(|| spot(bench, &place, place[index], least))
            })
            .collect();
        for spot in &spots {
            let value = parameter.value(spot.value);
            rows.push(SurfaceRow { parameter: parameter.name, value, above: spot.above, negative: spot.negative });
        }
        figures.push(panel(index, &spots, optimum[index], table1[index]));
    }
    Picture {
        name: "tune_profiles".to_owned(),
        caption: "Loss of likelihood a sample along each parameter, the others as at the optimum, each in a scale of its own, from 0.01 to 2; crosses: a coefficient is negative somewhere. Solid green: the optimum, dashed: Table 1 where it is in reach.".to_owned(),
        drawing: Grid::new("Likelihood along each parameter", "A panel for each parameter, lowest at the optimum", 3, figures)
        .into(),
        numbers: filled(profile_columns(), rows),
    }
}

fn panel(index: usize, spots: &[Spot], optimum: f64, table1: f64) -> Figure {
    let parameter = &PARAMETERS[index];
    let ends = [spots.first(), spots.last()].map(|spot| spot.map_or(optimum, |spot| spot.value));
    let unit = match parameter.unit {
        "" => String::new(),
        unit => format!(", {unit}"),
    };
    let name = match parameter.name {
        "beta" => "beta".to_owned(),
        "kappa" => "log10(5 + kappa)".to_owned(),
        name => format!("log10 {name}{unit}"),
    };
    let shown = |spot: &&Spot| spot.above.is_finite();
    let place = |spot: &Spot| (spot.value, spot.above.min(DEEPEST));
    let line = spots.iter().filter(shown).map(|s| Some(place(s)));
    let negative = spots.iter().filter(shown).filter(|s| s.negative);
    // A scale of its own, but none so fine that a parameter which does not matter seems to.
    let losses = range_of(spots.iter().filter(shown).map(|s| place(s).1));
    let most = losses.end.max(FINEST);
    let losses = losses.start.min(-0.05 * most)..1.05 * most;
    Figure::in_grid(
        name,
        ends[0]..ends[1],
        Panel::new(
            "loss a sample",
            260,
            vec![
                Layer::line("", colours::MEASURED, Stroke::Solid, line.collect()),
                Layer::marks("", colours::INVALID, negative.map(place).collect()),
                Layer::verticals("optimum", colours::TRUTH, Stroke::Thin, vec![optimum]),
                Layer::verticals("Table 1", colours::LIMIT, Stroke::Dashed, vec![table1]),
            ],
            "no place in reach",
        )
        .within(losses),
    )
}

/// The score over the noise of both readings.
pub fn plane(bench: &Bench, optimum: &Place, done: impl Fn()) -> Picture {
    let optimum = within(optimum);
    let least = bench.cost(&optimum);
    let step = 2.0 * REACH / f64::from(HALF);
    let at = |axis: usize, k: i32| optimum[PLANE[axis]] + step * f64::from(k - HALF / 2);
    let (mut cells, mut rows) = (Vec::new(), Vec::new());
    for i in 0..=HALF {
        for j in 0..=HALF {
            let mut place = optimum;
            place[PLANE[0]] = at(0, i);
            place[PLANE[1]] = at(1, j);
            done();
            // Beyond the ranges there is the score of their ends alone.
            let above = if within(&place) == place { spot(bench, &place, 0.0, least).above } else { f64::INFINITY };
            let around = |middle: f64| middle - 0.5 * step..middle + 0.5 * step;
            cells.push((around(at(0, i)), around(at(1, j)), strength(above)));
            rows.push([PARAMETERS[PLANE[0]].value(at(0, i)), PARAMETERS[PLANE[1]].value(at(1, j)), above]);
        }
    }
    let figure = Figure::new(
        "Likelihood over the noise of both readings",
        "Strong where the likelihood is largest",
        "log10 location_sd, m",
        at(0, 0) - 0.5 * step..at(0, HALF) + 0.5 * step,
        [Panel::new(
            "log10 speed_sd, km/h",
            620,
            vec![
                Layer::cells(
                    format!("loss a sample: strong 0, none {DEEPEST} and more"),
                    colours::CONSTANT_TERM,
                    cells,
                ),
                Layer::marks("optimum", colours::ESTIMATED, vec![(optimum[PLANE[0]], optimum[PLANE[1]])]),
            ],
            "",
        )
        .within(at(1, 0) - 0.5 * step..at(1, HALF) + 0.5 * step)],
    );
    Picture {
        name: "tune_plane".to_owned(),
        caption: format!(
            "Loss of likelihood a sample over the noise of both readings, the other parameters as at the optimum: the stronger the colour, the smaller the loss; no colour at {DEEPEST} and more, or where the search does not go."
        ),
        drawing: figure.into(),
        numbers: filled(plane_columns(), rows),
    }
}

/// Of the colour: full for no loss, none for the deepest.
fn strength(above: f64) -> f64 {
    1.0 - (above / DEEPEST).clamp(0.0, 1.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use super::{super::score::tests::bench, super::search::starts};
    use rundown_files::table::Cell;
    use std::cell::Cell as Counter;

    #[test]
    fn the_surface_asks_for_as_many_places_as_it_says_and_is_level_at_its_centre() {
        let (bench, [centre, _]) = (bench(1), starts());
        let asked = Counter::new(0);
        let count = || asked.set(asked.get() + 1);
        let profiles = profiles(&bench, &centre, &centre, count);
        let plane = plane(&bench, &centre, count);
        assert_eq!(asked.get(), EVALUATIONS);
        let level = |picture: &Picture| {
            let costs = picture.numbers.iter().find(|(about, _)| about.name == "cost_above_optimum").unwrap();
            costs.1.iter().filter(|cell| matches!(cell, Cell::Number(cost) if cost.abs() < 1e-9)).count()
        };
        assert!(level(&profiles) >= COUNT);
        assert!(level(&plane) >= 1);
        assert_eq!([0.0, 1.0, f64::INFINITY].map(strength), [1.0, 0.5, 0.0]);
    }

    #[test]
    fn an_optimum_at_an_end_of_the_search_is_on_its_profile() {
        let (bench, [mut optimum, table1]) = (bench(1), starts());
        let noise = COUNT - 1;
        // The simplex stops at the end of a range, give or take its last digits.
        optimum[noise] = PARAMETERS[noise].ends()[0] - 1e-12;
        let profiles = profiles(&bench, &optimum, &table1, || ());
        let [names, costs] = ["parameter", "cost_above_optimum"]
            .map(|name| &profiles.numbers.iter().find(|(about, _)| about.name == name).unwrap().1);
        let is_optimum = |(name, cost): (&Cell, &Cell)| {
            *name == Cell::from(PARAMETERS[noise].name) && matches!(cost, Cell::Number(cost) if cost.abs() < 1e-9)
        };
        assert!(names.iter().zip(costs).any(is_optimum), "{costs:?}");
    }
}
