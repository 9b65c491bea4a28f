//! `truth.json`: what was true, for evaluation.
//!
//! Sums up what no log says: the effects with the files of the runs they acted in, the true train, and for each run its
//! wind, load, temperature, Davis parameters in still air, and the marks of its phases. Locations are those of the
//! line, N/kg are per true rotating mass of the run.

use super::scenario_file::Simulation;
use jiff::Timestamp;
use rundown_truth::{facts::Facts, plan::RunPlan};
use serde_json::{Value, json};

/// Name of a run's files.
pub fn file_name(number: usize, runs: usize) -> String {
    let width = runs.to_string().len().max(3);
    format!("run{number:0width$}.csv")
}

/// Start of the log as in the index.
pub fn departure_utc(plan: &RunPlan) -> String {
    Timestamp::from_second(plan.departure_s).map_or(String::new(), |at| at.to_string())
}

pub fn value(simulation: &Simulation, facts: &[Facts]) -> Value {
    let scenario = &simulation.scenario;
    let effects: Vec<Value> = scenario
        .effects
        .iter()
        .enumerate()
        .map(|(index, effect)| {
            let files = facts.iter().filter(|f| f.plan.acting[index]);
            let files: Vec<String> = files.map(|f| file_name(f.plan.number, facts.len())).collect();
            json!({
                "name": effect.name(),
                "parameters": parameters(effect),
                "unknown_coordinate": effect.unknown_coordinate(),
                "runs": files,
            })
        })
        .collect();
    json!({
        "dataset": simulation.name,
        "seed": simulation.seed,
        "effects": effects,
        "described": {
            "train": scenario.train,
            "davis": scenario.train.davis,
        },
        "true_davis_over_described": scenario.davis_scale,
        "runs": facts.iter().map(|f| run(f, facts.len())).collect::<Vec<Value>>(),
    })
}

fn parameters(effect: &impl serde::Serialize) -> Value {
    let mut value = serde_json::to_value(effect).unwrap_or(Value::Null);
    if let Some(map) = value.as_object_mut() {
        map.remove("name");
    }
    value
}

fn run(facts: &Facts, runs: usize) -> Value {
    let plan = &facts.plan;
    let habits = &facts.habits;
    json!({
        "file": file_name(plan.number, runs),
        // A number of 64 bits does not fit into every reader's numbers.
        "seed": plan.seed.to_string(),
        "departure_utc": departure_utc(plan),
        "direction": plan.heading.as_str(),
        "season": plan.season,
        "headwind_mps": facts.headwind_mps,
        "load": facts.load,
        "temperature_c": {
            "start": facts.weather.start_c,
            "drift_per_h": facts.weather.drift_c_per_h,
        },
        "train": facts.train,
        "davis": facts.train.davis,
        "davis_with_wind": facts.davis,
        "cruise_mps": facts.cruise_mps,
        "final_coast": facts.final_coast,
        "final_brake": facts.final_brake,
        "stop_brake": facts.stop_brake,
        "stops": facts.stops,
        "mean_power_50_130_w_per_kg": facts.mean_power_50_130_w_per_kg,
        "max_power_50_90_w_per_kg": facts.max_power_50_90_w_per_kg,
        "max_power_w_per_kg": facts.max_power_w_per_kg,
        "effort_share": habits.effort_share,
        "power_share": habits.power_share,
        "brake_rates_mps2": habits.brake.rates_mps2,
    })
}

/// What stands in `truth.json`.
pub const FIELDS: &[[&str; 4]] = &[
    ["dataset", "", "name of the scenario", ""],
    ["seed", "", "seed of all draws", ""],
    ["effects[].name", "", "an effect that acted, by its name in the catalogue", ""],
    ["effects[].parameters.*", "", "its parameters, with the units of the catalogue", "the effect has none"],
    [
        "effects[].unknown_coordinate",
        "",
        "what it depends on: `speed`, `day` or `temperature`",
        "the effect is in the catalogue",
    ],
    ["effects[].runs[]", "", "files of the runs in which it acted", ""],
    ["described.train.mass_kg", "kg", "the train as described", ""],
    ["described.train.rotating_mass_factor", "1", "the same", ""],
    ["described.train.length_m", "m", "the same", ""],
    ["described.train.max_tractive_effort_n", "N", "the same", ""],
    ["described.train.max_power_w", "W", "the same", ""],
    ["described.train.max_brake_mps2", "m/s\u{b2}", "the same", ""],
    ["described.davis.r0", "N/kg", "Davis coefficient as described", ""],
    ["described.davis.r1", "N/kg per m/s", "the same", ""],
    ["described.davis.r2", "N/kg per (m/s)\u{b2}", "the same", ""],
    ["true_davis_over_described[]", "1", "true over described r0, r1, r2", ""],
    ["runs[].file", "", "name of the log", ""],
    ["runs[].seed", "", "seed of the run, 64 bits as text", ""],
    ["runs[].departure_utc", "", "departure, ISO 8601", ""],
    ["runs[].direction", "", "`up` or `down`", ""],
    ["runs[].season", "1", "where the run lies between the first and the last departure, 0 to 1", ""],
    ["runs[].headwind_mps", "m/s", "wind against the direction of travel", ""],
    ["runs[].load", "1", "mass by passengers over the described one", ""],
    ["runs[].temperature_c.start", "\u{b0}C", "ambient temperature at the departure", ""],
    ["runs[].temperature_c.drift_per_h", "\u{b0}C/h", "how it changes", ""],
    ["runs[].train.mass_kg", "kg", "the train as it was in this run", ""],
    ["runs[].train.rotating_mass_factor", "1", "the same", ""],
    ["runs[].train.length_m", "m", "the same", ""],
    ["runs[].train.max_tractive_effort_n", "N", "the same", ""],
    ["runs[].train.max_power_w", "W", "the same", ""],
    ["runs[].train.max_brake_mps2", "m/s\u{b2}", "the same", ""],
    ["runs[].davis.r0", "N/kg", "Davis coefficient of the loaded train in still air", ""],
    ["runs[].davis.r1", "N/kg per m/s", "the same", ""],
    ["runs[].davis.r2", "N/kg per (m/s)\u{b2}", "the same", ""],
    ["runs[].davis_with_wind.r0", "N/kg", "the same with the wind of the run", ""],
    ["runs[].davis_with_wind.r1", "N/kg per m/s", "the same", ""],
    ["runs[].davis_with_wind.r2", "N/kg per (m/s)\u{b2}", "the same", ""],
    ["runs[].cruise_mps", "m/s", "speed that the driver wanted to keep", ""],
    [
        "runs[].final_coast.time_s",
        "s",
        "start of the final coast",
        "the driver braked from power; the whole object is null",
    ],
    ["runs[].final_coast.location_m", "m", "the same", "as above"],
    ["runs[].final_coast.speed_mps", "m/s", "the same", "as above"],
    ["runs[].final_brake.time_s", "s", "start of the brake towards the last stop, from the speed of the line", ""],
    ["runs[].final_brake.location_m", "m", "the same", ""],
    ["runs[].final_brake.speed_mps", "m/s", "the same", ""],
    ["runs[].stop_brake.time_s", "s", "start of the last unbroken brake to standstill", ""],
    ["runs[].stop_brake.location_m", "m", "the same", ""],
    ["runs[].stop_brake.speed_mps", "m/s", "the same", ""],
    ["runs[].stops[].time_s", "s", "standstills in their order, unscheduled ones, too", ""],
    ["runs[].stops[].location_m", "m", "the same", ""],
    ["runs[].stops[].speed_mps", "m/s", "the same, 0", ""],
    [
        "runs[].mean_power_50_130_w_per_kg",
        "W/kg",
        "tractive power at the wheel per rotating mass, mean over time while accelerating after a stop, 50 to 130 km/h",
        "the train never did",
    ],
    ["runs[].max_power_50_90_w_per_kg", "W/kg", "the largest there, 50 to 90 km/h", "the train never did"],
    ["runs[].max_power_w_per_kg", "W/kg", "the largest of the whole run", ""],
    ["runs[].effort_share", "1", "share of the largest effort that the driver takes", ""],
    ["runs[].power_share", "1", "share of the largest power that the driver takes", ""],
    ["runs[].brake_rates_mps2[]", "m/s\u{b2}", "brake rates of the driver by ATB-EG step, from high speeds to low", ""],
];

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_of_files_sort_as_the_runs_do() {
        assert_eq!(file_name(7, 67), "run007.csv");
        assert_eq!(file_name(7, 1200), "run0007.csv");
    }
}
