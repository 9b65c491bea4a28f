//! OSRD's rolling stock, JSON.
//!
//! | field | unit | from |
//! |---|---|---|
//! | `mass`, `inertia_coefficient` | kg, - | m, γ |
//! | `rolling_resistance` of type `davis`: `A`, `B`, `C` | N, N/(m/s), N/(m/s)² | γ m r0, γ m r1, γ m r2 |
//! | `effort_curves` | m/s, N | min(F, P/v) |
//! | `const_gamma` | m/s² | largest brake |
//! | `startup_acceleration`, `comfort_acceleration` | m/s² | F / (γ m): they bind nowhere |
//! | `length`, `max_speed` | m, m/s | length, as given |
//!
//! Fields and units are those of RailJSON 3.4, which `editoast` reads. Signalling systems and category are not known
//! here: none, and `REGIONAL_TRAIN`.

use super::{draft::Draft, effort_curve};
use rundown::model::units::KmPerHour;
use rundown_files::refusal::{Place, ReadError};
use rundown_files::train_file::TrainFile;
use serde::Deserialize;
use serde_json::{Value, json};
use std::{collections::BTreeMap, path::Path};

/// The version of the rolling stock's form.
const VERSION: &str = "3.4";

/// The file; `voltage_v` of an electric train.
pub(super) fn write(train: &TrainFile, max_speed_kmh: f64, voltage_v: Option<u32>, said: &[String]) -> String {
    let rotating_mass_kg = train.rotating_mass_factor * train.mass_kg;
    let [a, b, c] = [train.davis.r0, train.davis.r1, train.davis.r2].map(|r| rotating_mass_kg * r);
    let curve = effort_curve::points(train.max_tractive_effort_n, train.max_power_w, max_speed_kmh);
    let (speeds, efforts): (Vec<f64>, Vec<f64>) =
        curve.into_iter().map(|(kmh, n)| (KmPerHour(kmh).to_mps(), n)).unzip();
    let mode = voltage_v.map_or_else(|| "thermal".to_owned(), |volts| format!("{volts}V"));
    let acceleration_mps2 = train.max_tractive_effort_n / rotating_mass_kg;
    // An electric train must have both; what they are is not known here.
    let electric_s = voltage_v.map(|_| 0.0);
    let curves = json!({
        "curves": [],
        "default_curve": { "speeds": speeds, "max_efforts": efforts },
        "is_electric": voltage_v.is_some(),
    });
    let stock = json!({
        "railjson_version": VERSION,
        "name": train.name,
        "locked": false,
        "metadata": {
            "detail": said.join(" "),
            "family": "", "type": "", "grouping": "", "series": "", "subseries": "", "unit": "", "number": "",
            "reference": train.name,
        },
        "length": train.length_m,
        "mass": train.mass_kg,
        "inertia_coefficient": train.rotating_mass_factor,
        "rolling_resistance": { "type": "davis", "A": a, "B": b, "C": c },
        "effort_curves": { "default_mode": mode, "modes": { mode.as_str(): curves } },
        "max_speed": KmPerHour(max_speed_kmh).to_mps(),
        "const_gamma": train.max_brake_mps2,
        "startup_time": 0.0,
        "startup_acceleration": acceleration_mps2,
        "comfort_acceleration": acceleration_mps2,
        "base_power_class": null,
        "power_restrictions": {},
        "energy_sources": [],
        "electrical_power_startup_time": electric_s,
        "raise_pantograph_time": electric_s,
        "loading_gauge": "G1",
        "supported_signaling_systems": [],
        "primary_category": "REGIONAL_TRAIN",
        "other_categories": [],
    });
    format!("{stock:#}\n")
}

/// What is read; of every version since 3.0.
#[derive(Deserialize)]
struct Stock {
    name: String,
    mass: f64,
    inertia_coefficient: f64,
    length: f64,
    rolling_resistance: RollingResistance,
    effort_curves: Curves,
    /// Since 3.3.
    const_gamma: Option<f64>,
    /// Before.
    gamma: Option<Gamma>,
    comfort_acceleration: Option<f64>,
    #[serde(flatten)]
    lost: BTreeMap<String, Value>,
}

#[derive(Deserialize)]
struct Gamma {
    value: f64,
}

#[derive(Deserialize)]
struct RollingResistance {
    #[serde(rename = "type")]
    law: String,
    #[serde(rename = "A")]
    a: f64,
    #[serde(rename = "B")]
    b: f64,
    #[serde(rename = "C")]
    c: f64,
}

#[derive(Deserialize)]
struct Curves {
    default_mode: String,
    modes: BTreeMap<String, Mode>,
}

#[derive(Deserialize)]
struct Mode {
    default_curve: EffortCurve,
    #[serde(default)]
    curves: Vec<Value>,
}

#[derive(Deserialize)]
struct EffortCurve {
    speeds: Vec<f64>,
    max_efforts: Vec<f64>,
}

pub(super) fn read(path: &Path, text: &str) -> Result<Draft, ReadError> {
    let stock: Stock = serde_json::from_str(text).map_err(|error| {
        let place = Place { file: path.to_owned(), line: Some(error.line()), column: Some(error.column()) };
        place.refuse("", format!("expected a rolling stock of OSRD, found {error}"))
    })?;
    let refuse = |field: &str, message: String| ReadError::from(Place::of_file(path).refuse(field, message));
    let RollingResistance { law, a, b, c } = &stock.rolling_resistance;
    if law != "davis" {
        return Err(refuse("rolling_resistance.type", format!("expected `davis`, found `{law}`")));
    }
    let chosen = &stock.effort_curves.default_mode;
    let mode = stock.effort_curves.modes.get(chosen);
    let mode = mode.ok_or_else(|| refuse("effort_curves.modes", format!("expected `{chosen}`, found no such mode")))?;
    let EffortCurve { speeds, max_efforts } = &mode.default_curve;
    if speeds.len() != max_efforts.len() {
        let message = format!("expected {} efforts, one for each speed, found {}", speeds.len(), max_efforts.len());
        return Err(refuse("effort_curves", message));
    }
    let points: Vec<(f64, f64)> = speeds.iter().copied().zip(max_efforts.iter().copied()).collect();
    let limits = effort_curve::limits(&points)
        .ok_or_else(|| refuse("effort_curves", "expected effort at a speed above 0, found none".to_owned()))?;
    let mut draft = Draft { name: stock.name.clone(), resistance_n: [*a, *b, *c], ..Draft::default() };
    draft.put("mass_kg", Some(stock.mass));
    draft.put("rotating_mass_factor", Some(stock.inertia_coefficient));
    draft.put("length_m", Some(stock.length));
    draft.put("max_tractive_effort_n", Some(limits.effort_n));
    draft.put("max_power_w", Some(limits.power_w));
    draft.put("max_brake_mps2", stock.const_gamma.or(stock.gamma.as_ref().map(|gamma| gamma.value.abs())));
    draft.notes = notes(&stock, chosen, mode);
    draft.notes.extend(limits.note);
    Ok(draft)
}

fn notes(stock: &Stock, chosen: &str, mode: &Mode) -> Vec<String> {
    let mut notes = Vec::new();
    let others: Vec<&str> =
        stock.effort_curves.modes.keys().map(String::as_str).filter(|name| *name != chosen).collect();
    if !others.is_empty() || !mode.curves.is_empty() {
        let count = mode.curves.len();
        notes.push(format!(
            "kept is the default effort curve of mode {chosen}; not kept: modes [{}], {count} curves with conditions",
            others.join(", ")
        ));
    }
    if !stock.lost.is_empty() {
        notes.push(format!("not kept: {}", stock.lost.keys().map(String::as_str).collect::<Vec<_>>().join(", ")));
    }
    if let Some(comfort) = stock.comfort_acceleration {
        notes
            .push(format!("comfort_acceleration {comfort} m/s2 is not kept: the effort alone bounds the acceleration"));
    }
    notes
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_not_kept_is_named_and_nothing_else() {
        let stock = |more: &str| {
            format!(
                "{{\"name\":\"t\",\"mass\":364000,\"inertia_coefficient\":1.06,\"length\":162,\"const_gamma\":0.66,\
                 \"rolling_resistance\":{{\"type\":\"davis\",\"A\":2800,\"B\":60,\"C\":10}},\
                 \"effort_curves\":{{\"default_mode\":\"thermal\",\"modes\":{{\"thermal\":\
                 {{\"default_curve\":{{\"speeds\":[0,10,40],\"max_efforts\":[200000,200000,50000]}}}}}}}}{more}}}"
            )
        };
        let lost = |more: &str| -> Vec<String> {
            let draft = read("s.json".as_ref(), &stock(more)).unwrap();
            draft.notes.into_iter().filter(|note| note.starts_with("not kept")).collect()
        };
        assert_eq!(lost(""), Vec::<String>::new());
        assert_eq!(lost(",\"loading_gauge\":\"G1\""), ["not kept: loading_gauge"]);
    }
}
