//! SUMO's rail model in table form: traction and resistance at speeds, with straight lines between them.
//!
//! | attribute | unit | from |
//! |---|---|---|
//! | `speedTable` | m/s | 0 to the largest speed, no more than 5 km/h apart, and the speed from which the power bounds the effort |
//! | `tractionTable` | kN | min(F, P/v) there |
//! | `resistanceTable` | kN | A + B v + C v² there |
//!
//! Read back, A, B and C are the least squares of the resistances, F and P what bounds the tractions.

use super::{effort_curve, number::significant, xml::Element};
use nalgebra::{Matrix3, Vector3};
use rundown::model::units::KmPerHour;
use rundown_files::refusal::ReadError;
use rundown_files::train_file::TrainFile;

const SPEED: &str = "speedTable";
const TRACTION: &str = "tractionTable";
const RESISTANCE: &str = "resistanceTable";

/// Significant digits of the tables: A, B and C are differences of their rows.
const DIGITS: i32 = 9;

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
        let values = points.iter().map(|(kmh, force_n)| significant(value(KmPerHour(*kmh).to_mps(), *force_n), DIGITS));
        values.collect::<Vec<String>>().join(" ")
    };
    let resistance_kn = |mps: f64, _| rotating_mass_kg * train.davis.resistance_n_per_kg(mps) / 1000.0;
    [
        (SPEED, column(&|mps, _| mps)),
        (TRACTION, column(&|_, force_n| force_n / 1000.0)),
        (RESISTANCE, column(&resistance_kn)),
    ]
}

/// Largest effort and power of the table of tractions; none without one.
///
/// # Errors
/// The tables are incomplete, or hold no traction.
pub(super) fn limits(vtype: &Element) -> Result<Option<effort_curve::Limits>, ReadError> {
    let Some(points) = forces(vtype, TRACTION)? else { return Ok(None) };
    let none = || vtype.refuse(TRACTION, "expected a force above 0 kN at a speed above 0, found none".to_owned());
    effort_curve::limits(&points).ok_or_else(none).map(Some)
}

/// A, B, C: N, N/(m/s), N/(m/s)²; and a note where they differ from the table.
type Parabola = ([f64; 3], Option<String>);

/// The parabola of the table of resistances; none without one.
///
/// # Errors
/// The tables are incomplete, or hold no parabola of the speed.
pub(super) fn resistance_n(vtype: &Element) -> Result<Option<Parabola>, ReadError> {
    let Some(points) = forces(vtype, RESISTANCE)? else { return Ok(None) };
    let refuse = |name, message: String| Err(vtype.refuse(name, message));
    if points.len() < 3 || points.windows(2).any(|pair| pair[1].0 <= pair[0].0) {
        let found = points.iter().map(|(mps, _)| mps.to_string()).collect::<Vec<_>>().join(" ");
        return refuse(SPEED, format!("expected 3 speeds or more, each above the one before, found `{found}`"));
    }
    if let Some((mps, force_n)) = points.iter().find(|(_, force_n)| *force_n <= 0.0) {
        return refuse(RESISTANCE, format!("expected resistances above 0 kN, found {} at {mps} m/s", force_n / 1e3));
    }
    let Some([a, b, c]) = parabola(&points) else {
        return refuse(SPEED, "expected speeds that tell A, B and C apart, found none".to_owned());
    };
    let off = |(mps, force_n): &(f64, f64)| ((a + b * mps + c * mps * mps) / force_n - 1.0).abs();
    let most = points.iter().map(off).fold(0.0, f64::max);
    let percent = 100.0 * most;
    if most > MOST_OFF {
        return refuse(
            RESISTANCE,
            format!(
                "expected A + B v + C v² within {:.0} %, found resistances that differ from the nearest one by {percent:.0} %",
                100.0 * MOST_OFF
            ),
        );
    }
    let note = format!("the resistance table is kept as A + B v + C v², which differs by up to {percent:.1} %");
    Ok(Some(([a, b, c], (most > ALIKE).then_some(note))))
}

/// Speeds, m/s, and forces, N, of a column; none without it.
fn forces(vtype: &Element, name: &str) -> Result<Option<Vec<(f64, f64)>>, ReadError> {
    let Some(values_kn) = column(vtype, name)? else { return Ok(None) };
    let Some(speeds_mps) = column(vtype, SPEED)? else {
        return Err(vtype.refuse(SPEED, format!("expected beside {name}, found none")));
    };
    if values_kn.len() != speeds_mps.len() {
        let message = format!("expected {} numbers, as in speedTable, found {}", speeds_mps.len(), values_kn.len());
        return Err(vtype.refuse(name, message));
    }
    Ok(Some(speeds_mps.into_iter().zip(values_kn.into_iter().map(|kn| 1000.0 * kn)).collect()))
}

/// Numbers between spaces; none without the attribute.
fn column(vtype: &Element, name: &str) -> Result<Option<Vec<f64>>, ReadError> {
    let Some(text) = vtype.attribute(name) else { return Ok(None) };
    let number = |word: &str| word.parse::<f64>().ok().filter(|number| number.is_finite());
    let numbers = text.split_whitespace().map(|word| {
        number(word).ok_or_else(|| vtype.refuse(name, format!("expected numbers between spaces, found `{word}`")))
    });
    numbers.collect::<Result<_, _>>().map(Some)
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
    let mut found = [0.0; 3];
    found.iter_mut().zip(kept).for_each(|(found, value)| *found = value);
    found.iter().all(|value| value.is_finite()).then_some(found)
}
