//! Over what the law of an effect is drawn.

use crate::data::rows::Row;

pub type Of<'a, T> = Box<dyn Fn(&Row) -> T + 'a>;

pub struct Axis<'a> {
    /// Name with the unit.
    pub x_label: &'static str,
    /// Where a row lies; none: it is not drawn.
    pub x: Of<'a, Option<f64>>,
    /// Each direction has its own law.
    pub by_direction: bool,
    /// A run has one value of it, about.
    pub of_run: bool,
    /// One dot a run, also of the runs in which it does not act.
    pub run_by_run: bool,
    /// Divisor of residual and law: 1, or the effort where a share of it is drawn.
    pub per: Option<fn(&Row) -> f64>,
    /// Points of a law that is a table, straight between them: drawn as they are, not as means of bins.
    pub table: Vec<(f64, f64)>,
}

impl<'a> Axis<'a> {
    pub fn over(x_label: &'static str, x: impl Fn(&Row) -> Option<f64> + 'a) -> Self {
        Self {
            x_label,
            x: Box::new(x),
            by_direction: false,
            of_run: false,
            run_by_run: false,
            per: None,
            table: Vec::new(),
        }
    }

    pub fn speed() -> Self {
        Self::over("speed, km/h", |row| Some(kmh(row)))
    }

    pub fn location() -> Self {
        Self::over("location of the train's front, km", |row| Some(km(row)))
    }

    pub fn time() -> Self {
        Self::over("time since departure, min", |row| Some(row.interval.middle().since_departure_s / 60.0))
    }

    pub fn temperature() -> Self {
        Self { of_run: true, ..Self::over("ambient temperature, \u{b0}C", |row| row.interval.temperature_c) }
    }

    pub fn day(first_day: f64) -> Self {
        let day = move |row: &Row| Some(row.interval.day? - first_day);
        Self { of_run: true, ..Self::over("days since the first run", day) }
    }
}

pub fn kmh(row: &Row) -> f64 {
    3.6 * row.interval.mean_speed_mps()
}

pub fn km(row: &Row) -> f64 {
    row.interval.middle().location_m / 1000.0
}
