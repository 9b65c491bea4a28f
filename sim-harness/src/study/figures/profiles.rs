//! Fig. 2: all measured speed profiles over location.

use super::{Drawn, Picture};
use rundown_files::column::{Column, filled};
use rundown_pages::chart::{Figure, Layer, Panel, range_of};
use rundown_pages::colours;

/// A measured sample.
#[derive(Debug)]
pub struct ProfileRow {
    run: String,
    location_m: f64,
    speed_kmh: f64,
}

/// The columns of `fig2_speed_profiles.csv`.
pub fn columns() -> Vec<Column<ProfileRow>> {
    vec![
        Column::text("run", "name of the run", |row: &ProfileRow| row.run.clone()),
        Column::number("location_m", "m", "measured location", |row: &ProfileRow| row.location_m),
        Column::number("speed_kmh", "km/h", "measured speed", |row: &ProfileRow| row.speed_kmh),
    ]
}

pub fn profiles(drawn: &[Drawn], all: u64) -> Picture {
    let lines: Vec<Vec<Option<(f64, f64)>>> =
        drawn.iter().map(|run| run.profile().map(|p| p.map(|(m, kmh)| (m / 1000.0, kmh))).collect()).collect();
    let points = || lines.iter().flatten().flatten();
    let figure = Figure::new(
        "Fig. 2: speed profiles",
        "Measured speed over location, a thin line for each run",
        "location along the track, km",
        range_of(points().map(|p| p.0)),
        [Panel::new(
            "speed, km/h",
            620,
            vec![Layer::threads(
                format!("measured, {} of {all} runs", drawn.len()),
                colours::MEASURED,
                (12.0 / lines.len() as f64).clamp(0.15, 1.0),
                lines.clone(),
            )],
            "no run",
        )
        .within(0.0..range_of(points().map(|p| p.1)).end.max(10.0) * 1.05)],
    );
    let rows = drawn.iter().flat_map(|run| {
        let of = |(location_m, speed_kmh)| ProfileRow { run: run.name().to_owned(), location_m, speed_kmh };
        run.profile().flatten().map(of)
    });
    Picture {
        name: "fig2_speed_profiles".to_owned(),
        caption: format!("Measured speed over location, {} of {all} runs.", drawn.len()),
        drawing: figure.into(),
        numbers: filled(columns(), rows),
    }
}
