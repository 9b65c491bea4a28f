//! What section 3.3 asks of a run, as a table.

use super::KMH;
use maud::{Markup, html};
use rundown::features::{EffortLine, Energy, FeatureConfig, Features, Phase};
use rundown::{Real, model::train::Train};
use rundown_pages::numbers::{NOTHING, counted, number, statistic};
use rundown_pages::shell::{column, swatch, table, text_column};

pub(super) fn feature_table(features: &Features, train: &Train, config: &FeatureConfig) -> Markup {
    let mass_kg = train.rotating_mass_kg();
    let row = |name: &str, unit: &str, [count, mean, sd]: [String; 3]| {
        html! { tr { th scope="row" { (name) } td { (count) } td { (mean) } td { (sd) } td.text { (unit) } } }
    };
    // No standard deviation: seen once in a run, or not at all.
    let once = |value: Option<Real>, decimals: usize| {
        let count = if value.is_some() { "1" } else { "0" };
        [count.to_owned(), number(value, decimals), NOTHING.to_owned()]
    };
    let phase = |name: &str, phase: Option<&Phase>| {
        let of = |field: fn(&Phase) -> Real| phase.map(field);
        html! {
            (row(&format!("{name}: start"), "km", once(of(|p| p.start_location_m / 1000.0), 2)))
            (row(&format!("{name}: speed at its start"), "km/h", once(of(|p| KMH * p.start_speed_mps), 1)))
            (row(&format!("{name}: duration"), "s", once(of(|p| p.duration_s), 0)))
            (row(&format!("{name}: length"), "m", once(of(|p| p.length_m), 0)))
        }
    };
    let line = features.max_effort.as_ref();
    let effort = line.map(|line| line.effort).unwrap_or_default();
    let [effort_count, effort_mean, _] = statistic(&effort, mass_kg / 1e3, 1);
    let effort_sd = number(line.and_then(EffortLine::known_sd).map(|sd| sd * mass_kg / 1e3), 1);
    let window = |[lower, upper]: [Real; 2]| format!("{lower} to {upper} km/h");
    let moved = features.regime_time_s.iter().sum::<Real>() > 0.0;
    html! {
        div.wide { table.features {
            thead { tr {
                th scope="col" { "feature" } th scope="col" { "count" } th scope="col" { "mean" }
                th scope="col" { "standard deviation" } th.text scope="col" { "unit" }
            } }
            tbody {
                (row(&format!("Largest tractive effort, {}", window(config.effort_window_kmh)), "kN", [effort_count, effort_mean, effort_sd]))
                (row("Tractive effort of the fitted line at its lower speed", "kN", once(line.map(|l| l.at_lower_n_per_kg * mass_kg / 1e3), 1)))
                (row("Slope of the fitted line", "kN per m/s", once(line.and_then(EffortLine::known_slope).map(|slope| slope * mass_kg / 1e3), 2)))
                (row(&format!("Tractive power, {}", window(config.power_window_kmh)), "kW", statistic(&features.power_w_per_kg, mass_kg / 1e3, 0)))
                (row(&format!("Largest tractive power, {}", window(config.max_power_window_kmh)), "kW", once(features.max_power_w_per_kg.map(|p| p * mass_kg / 1e3), 0)))
                @for (step, rate) in brake_steps(config).iter().zip(&features.brake_rate_mps2) {
                    (row(&format!("Brake rate, {step}"), "m/s\u{b2}", statistic(rate, 1.0, 3)))
                }
                (row("Cruise speed", "km/h", statistic(&features.cruise_speed_mps, KMH, 1)))
                (row("Cruise speed, median", "km/h", once(features.cruise_speed_median_mps.map(|v| KMH * v), 1)))
                (phase("Final coast", features.final_coast.as_ref()))
                (phase("Final brake", features.final_brake.as_ref()))
                @for (name, j_per_kg) in energies(&features.energy) {
                    (row(name, "kWh", once(moved.then_some(j_per_kg * mass_kg / 3.6e6), 1)))
                }
            }
        } }
        p.small {
            "Forces, powers and energies are those per mass times the rotating mass of the train file, "
            (number(mass_kg / 1000.0, 1)) " t."
        }
        (switching_points(features))
    }
}

fn energies(energy: &Energy) -> [(&'static str, Real); 6] {
    [
        ("Work of the traction", energy.traction_j_per_kg),
        ("Work of the brake", energy.brake_j_per_kg),
        ("Taken by r0", energy.r0_j_per_kg),
        ("Taken by r1 v", energy.r1_j_per_kg),
        ("Taken by r2 v\u{b2}", energy.r2_j_per_kg),
        ("Taken by the gradient", energy.gradient_j_per_kg),
    ]
}

fn brake_steps(config: &FeatureConfig) -> [String; 5] {
    let [a, b, c, d] = config.brake_steps_kmh;
    [
        format!("above {a} km/h"),
        format!("{a} to {b} km/h"),
        format!("{b} to {c} km/h"),
        format!("{c} to {d} km/h"),
        format!("below {d} km/h"),
    ]
}

fn switching_points(features: &Features) -> Markup {
    let points = &features.switching_points;
    let head = [column("location", "km"), column("speed", "km/h"), text_column("from"), text_column("to")];
    let rows = html! { @for point in points { tr {
        td { (number(point.location_m / 1000.0, 2)) }
        td { (number(KMH * point.speed_mps, 1)) }
        td.text { (swatch(point.from)) (point.from.as_str()) }
        td.text { (swatch(point.to)) (point.to.as_str()) }
    } } };
    html! {
        @if !points.is_empty() {
            details {
                summary { (counted(points.len(), "switching point", "switching points")) }
                (table(head, rows))
                @if features.switching_points_lost > 0 {
                    p.small { (features.switching_points_lost) " more were not kept." }
                }
            }
        }
    }
}
