//! Tables for other tools: the residuals of the believed model, and simulated beside measured speed.

use crate::data::rows::Row;
use crate::investigation::Investigation;
use crate::traction::powering::SteadyPower;
use serde::Serialize;

#[derive(Serialize)]
struct Residual {
    run: usize,
    time_s: f64,
    duration_s: f64,
    since_departure_s: f64,
    /// 1 with rising location, -1 against it.
    direction: f64,
    location_m: f64,
    speed_kmh: f64,
    effort_n_per_kg: f64,
    temperature_c: Option<f64>,
    day: Option<f64>,
    residual_n_per_kg: f64,
}

#[derive(Serialize)]
struct PoweredAt {
    run: usize,
    #[serde(rename = "pull")]
    phase: usize,
    location_m: f64,
    speed_kmh: f64,
    /// Effort over the believed limit.
    ratio: f64,
    sd: f64,
    /// The power is what limits, not the effort.
    by_power: bool,
}

#[derive(Serialize)]
struct Compared {
    run: usize,
    time_s: f64,
    location_m: f64,
    measured_kmh: f64,
    before_kmh: f64,
    after_kmh: f64,
}

/// Each interval's residual; location, speed and time since departure are those of its middle.
///
/// # Errors
/// [`csv::Error`] when a row cannot be written as text.
pub fn residuals(rows: &[Row]) -> Result<Vec<u8>, csv::Error> {
    let residual = |row: &Row| {
        let middle = row.interval.middle();
        Residual {
            run: row.interval.run + 1,
            time_s: row.interval.begin_s,
            duration_s: row.interval.dt_s,
            since_departure_s: middle.since_departure_s,
            direction: row.direction.sign(),
            location_m: middle.location_m,
            speed_kmh: 3.6 * row.interval.mean_speed_mps(),
            effort_n_per_kg: row.effort_n_per_kg,
            temperature_c: row.interval.temperature_c,
            day: row.interval.day,
            residual_n_per_kg: row.residual_n_per_kg,
        }
    };
    table(rows.iter().map(residual))
}

/// The intervals of steady power while trains gain speed, beside the believed limit.
///
/// # Errors
/// [`csv::Error`] when a row cannot be written as text.
pub fn powering(powering: &[Vec<SteadyPower>]) -> Result<Vec<u8>, csv::Error> {
    let rows = powering.iter().flatten().map(|power| PoweredAt {
        run: power.run + 1,
        phase: power.number + 1,
        location_m: power.location_m,
        speed_kmh: 3.6 * power.speed_mps,
        ratio: power.ratio,
        sd: power.sd,
        by_power: power.by_power,
    });
    table(rows)
}

/// Measured and simulated speed of the held-out runs, before and after.
///
/// # Errors
/// [`csv::Error`] when a row cannot be written as text.
pub fn before_after(found: &Investigation) -> Result<Vec<u8>, csv::Error> {
    let rows = found.compared.iter().map(|c| Compared {
        run: found.held_out[c.run] + 1,
        time_s: c.time_s,
        location_m: c.location_m,
        measured_kmh: 3.6 * c.measured_mps,
        before_kmh: 3.6 * (c.measured_mps + c.before_mps),
        after_kmh: 3.6 * (c.measured_mps + c.after_mps),
    });
    table(rows)
}

fn table(rows: impl Iterator<Item = impl Serialize>) -> Result<Vec<u8>, csv::Error> {
    let mut csv = csv::Writer::from_writer(Vec::new());
    for row in rows {
        csv.serialize(row)?;
    }
    csv.into_inner().map_err(|error| std::io::Error::other(error.to_string()).into())
}
