//! r(v) with its band as a table.

use rundown::filter::gaussian::Gaussian;
use rundown_files::column::{Column, Filled, filled};
use sim_harness::report::resistance::Resistance;

/// A speed, and what is known of the resistance there.
struct Row {
    speed_mps: f64,
    found: Option<Resistance>,
}

/// Mean, standard deviation and 95 % interval at these speeds, m/s.
pub fn table(belief: &Gaussian<3>, speeds_mps: &[f64]) -> Filled {
    let rows =
        speeds_mps.iter().map(|speed_mps| Row { speed_mps: *speed_mps, found: Resistance::at(belief, *speed_mps) });
    let of = |value: fn(&Resistance) -> f64| move |row: &Row| row.found.as_ref().map(value);
    let number = |name: &str, meaning: &str, value: fn(&Resistance) -> f64| {
        Column::number(name, "N/kg", meaning, of(value)).empty_when("the belief is not finite")
    };
    let columns = vec![
        Column::number("speed_mps", "m/s", "speed", |row: &Row| row.speed_mps),
        number("resistance_n_per_kg", "running resistance per rotating mass", |r| r.mean_n_per_kg),
        number("sd_n_per_kg", "its standard deviation", |r| r.sd_n_per_kg),
        number("low_n_per_kg", "lower end of the 95 % interval", Resistance::lower),
        number("high_n_per_kg", "upper end of the 95 % interval", Resistance::upper),
    ];
    filled(columns, rows)
}
