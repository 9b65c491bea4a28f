//! `truth.json`: what was true, for evaluation.
//!
//! Sums up what no log says: the effects with the files of the runs they acted in, the true train, and for each run its wind, load, temperature,
//! Davis parameters in still air, and the marks of its phases. Locations are those of the line, N/kg are per true rotating mass of the run.

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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_of_files_sort_as_the_runs_do() {
        assert_eq!(file_name(7, 67), "run007.csv");
        assert_eq!(file_name(7, 1200), "run0007.csv");
    }
}
