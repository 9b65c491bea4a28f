//! SUMO's rail model in table form: traction and resistance at speeds, with straight lines between them.
//!
//! | attribute | unit | from |
//! |---|---|---|
//! | `speedTable` | m/s | 0 to the largest speed, no more than 5 km/h apart, and the speed from which the power bounds the effort |
//! | `tractionTable` | kN | min(F, P/v) there |
//! | `resistanceTable` | kN | A + B v + C v² there |
//!
//! Read back, A, B and C are the least squares of the resistances, F and P what bounds the tractions.

use super::{effort_curve, number::decimal, xml::Element};
use nalgebra::{Matrix3, Vector3};
use rundown::model::units::KmPerHour;
use rundown_files::refusal::ReadError;
use rundown_files::train_file::TrainFile;

pub(super) const COLUMNS: [&str; 3] = ["speedTable", "tractionTable", "resistanceTable"];

/// Resistances that differ by more from the parabola are no Davis formula.
const MOST_OFF: f64 = 0.05;
/// A difference that is worth a note.
const ALIKE: f64 = 0.005;

/// The three attributes.
pub(super) fn attributes(train: &TrainFile, max_speed_kmh: f64) -> [(&'static str, String); 3] {
    let rotating_mass_kg = train.rotating_mass_factor * train.mass_kg;
    let mut points = effort_curve::points(train.max_tractive_effort_n, train.max_power_w, max_speed_kmh);
    // Below the knee the effort is constant, the resistance is not.
    let knee_kmh = points.get(1).map_or(max_speed_kmh, |point| point.0);
    let below = (1..).map(|step| 5.0 * f64::from(step)).take_while(|kmh| *kmh < knee_kmh - 0.1);
    points.extend(below.map(|kmh| (kmh, train.max_tractive_effort_n)).collect::<Vec<_>>());
    points.sort_by(|a, b| a.0.total_cmp(&b.0));
    let column = |value: &dyn Fn(f64, f64) -> f64| {
        let values = points.iter().map(|(kmh, force_n)| decimal(value(KmPerHour(*kmh).to_mps(), *force_n)));
        values.collect::<Vec<String>>().join(" ")
    };
    let resistance_kn = |mps: f64, _| rotating_mass_kg * train.davis.resistance_n_per_kg(mps) / 1000.0;
    let [speed, traction, resistance] = COLUMNS;
    [
        (speed, column(&|mps, _| mps)),
        (traction, column(&|_, force_n| force_n / 1000.0)),
        (resistance, column(&resistance_kn)),
    ]
}

/// What the tables of a vehicle type hold.
pub(super) struct Tables {
    /// A, B, C: N, N/(m/s), N/(m/s)².
    pub resistance_n: [f64; 3],
    pub limits: effort_curve::Limits,
    pub notes: Vec<String>,
}

/// None where the vehicle type has no tables.
///
/// # Errors
/// They are incomplete, or hold no parabola of the speed.
pub(super) fn read(vtype: &Element) -> Result<Option<Tables>, ReadError> {
    if COLUMNS.iter().all(|name| vtype.attribute(name).is_none()) {
        return Ok(None);
    }
    let [speeds_mps, tractions_kn, resistances_kn] =
        [column(vtype, COLUMNS[0])?, column(vtype, COLUMNS[1])?, column(vtype, COLUMNS[2])?];
    for (name, values) in COLUMNS[1..].iter().zip([&tractions_kn, &resistances_kn]) {
        if values.len() != speeds_mps.len() {
            let message = format!("expected {} numbers, as in speedTable, found {}", speeds_mps.len(), values.len());
            return Err(vtype.refuse(name, message));
        }
    }
    let forces = |values_kn: &[f64]| -> Vec<(f64, f64)> {
        speeds_mps.iter().copied().zip(values_kn.iter().map(|kn| 1000.0 * kn)).collect()
    };
    let Some(limits) = effort_curve::limits(&forces(&tractions_kn)) else {
        return Err(vtype.refuse(COLUMNS[1], "expected a force above 0 kN at a speed above 0, found none".to_owned()));
    };
    let resistances_n = forces(&resistances_kn);
    let Some(resistance_n) = parabola(&resistances_n) else {
        return Err(vtype.refuse(COLUMNS[0], "expected 3 speeds or more, which rise, found fewer".to_owned()));
    };
    let [a, b, c] = resistance_n;
    let off = |(mps, force_n): &(f64, f64)| ((a + b * mps + c * mps * mps) / force_n - 1.0).abs();
    let most = resistances_n.iter().map(off).fold(0.0, f64::max);
    let percent = 100.0 * most;
    if most.is_nan() || most > MOST_OFF {
        let message = format!(
            "expected A + B v + C v² within {:.0} %, found resistances that differ from the nearest one by {percent:.0} %",
            100.0 * MOST_OFF
        );
        return Err(vtype.refuse(COLUMNS[2], message));
    }
    let mut notes: Vec<String> = limits.note.clone().into_iter().collect();
    if most > ALIKE {
        notes.push(format!("the resistance table is kept as A + B v + C v², which differs by up to {percent:.1} %"));
    }
    Ok(Some(Tables { resistance_n, limits, notes }))
}

/// Numbers between spaces.
fn column(vtype: &Element, name: &str) -> Result<Vec<f64>, ReadError> {
    let Some(text) = vtype.attribute(name) else {
        return Err(vtype.refuse(name, format!("expected beside {}, found none", COLUMNS.join(" and "))));
    };
    let number = |word: &str| word.parse::<f64>().ok().filter(|number| number.is_finite());
    let numbers = text.split_whitespace().map(|word| {
        number(word).ok_or_else(|| vtype.refuse(name, format!("expected numbers between spaces, found `{word}`")))
    });
    numbers.collect()
}

/// Least squares of A + B v + C v², each point by its share. None where the speeds do not tell the three apart.
fn parabola(points: &[(f64, f64)]) -> Option<[f64; 3]> {
    let (mut normal, mut right) = (Matrix3::zeros(), Vector3::zeros());
    for (mps, force_n) in points {
        let row = Vector3::new(1.0, *mps, mps * mps) / *force_n;
        normal += row * row.transpose();
        right += row;
    }
    let found = normal.try_inverse()? * right;
    let [a, b, c]: [f64; 3] = found.into();
    // What written digits leave of a coefficient that is 0.
    let (fastest_mps, largest_n) =
        points.iter().fold((0.0_f64, 0.0_f64), |most, at| (most.0.max(at.0), most.1.max(at.1)));
    let is_nothing = |n: f64| n.abs() < 1e-6 * largest_n;
    let scaled = [a, b * fastest_mps, c * fastest_mps * fastest_mps];
    let kept = [a, b, c].into_iter().zip(scaled).map(|(value, n)| if is_nothing(n) { 0.0 } else { value });
    let kept: Vec<f64> = kept.collect();
    (points.len() > 2).then(|| [kept[0], kept[1], kept[2]]).filter(|kept| kept.iter().all(|value| value.is_finite()))
}
