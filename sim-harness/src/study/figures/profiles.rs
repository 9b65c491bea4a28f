//! Fig. 2: all measured speed profiles over location.

use super::{Drawn, Picture, number, text};
use rundown_pages::chart::{Figure, Layer, Panel, range_of};
use rundown_pages::colours;

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
    let records = drawn.iter().flat_map(|run| {
        run.profile().flatten().map(|(location_m, kmh)| {
            vec![text("run", run.name()), number("location_m", location_m), number("speed_kmh", kmh)]
        })
    });
    Picture {
        name: "fig2_speed_profiles".to_owned(),
        caption: format!("Measured speed over location, {} of {all} runs.", drawn.len()),
        drawing: figure.into(),
        records: records.collect(),
    }
}
