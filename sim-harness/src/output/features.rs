//! `features.csv` and `switching_points.csv`: what section 3.3 asks of each run.
//!
//! Every feature has its count, mean and standard deviation, with the unit in the name; what was not seen has count 0 and empty fields.
//! Per mass means per rotating mass γ m. Names of brake steps hold the configured speeds.

use crate::output::parameters::direction_word;
use rundown::features::{EffortLine, Energy, FeatureConfig, Features, Phase, Statistic};
use rundown::tick::regime::Regime;
use rundown_files::replay::ReplayedRun;
use rundown_files::table::{Cell, Record};

pub const SWITCHING_POINT_COLUMNS: [&str; 6] = ["run", "time_s", "location_m", "speed_mps", "from", "to"];

pub fn record(run: &ReplayedRun, config: &FeatureConfig) -> Record {
    let times_s = || run.estimates.iter().map(|estimate| estimate.time_s);
    let duration_s = times_s().next_back().zip(times_s().next()).map(|(last, first)| last - first);
    let cells = [
        ("run", Cell::from(run.name.as_str())),
        ("unit", Cell::from(run.unit.as_str())),
        ("direction", Cell::from(direction_word(run.direction))),
        ("duration_s", Cell::from(duration_s)),
    ];
    let mut record = Record::from(cells.map(|(name, cell)| (name.to_owned(), cell)));
    record.extend(of_run(&run.summary.features, config));
    record
}

/// The features of a run, without its name.
pub fn of_run(features: &Features, config: &FeatureConfig) -> Record {
    let mut record = Record::new();
    let mut push = |name: &str, cell: Cell| record.push((name.to_owned(), cell));
    for (name, cell) in effort_line(features.max_effort.as_ref()) {
        push(name, cell);
    }
    statistic(&mut push, "power", "w_per_kg", &features.power_w_per_kg);
    push("power_max_w_per_kg", Cell::from(features.max_power_w_per_kg));
    for (name, rate) in brake_steps(config).iter().zip(&features.brake_rate_mps2) {
        statistic(&mut push, &format!("brake_rate_{name}_kmh"), "mps2", rate);
    }
    statistic(&mut push, "cruise_speed", "mps", &features.cruise_speed_mps);
    push("cruise_speed_median_mps", Cell::from(features.cruise_speed_median_mps));
    phase(&mut push, "final_coast", features.final_coast.as_ref());
    phase(&mut push, "final_brake", features.final_brake.as_ref());
    let kept = features.switching_points.len() as u64;
    push("switching_points_count", Cell::Count(kept + u64::from(features.switching_points_lost)));
    let total_s: f64 = features.regime_time_s.iter().sum();
    for regime in Regime::ALL {
        let time_s = features.regime_time_s[regime as usize];
        push(&format!("{regime}_time_s"), Cell::from(time_s));
        let share = (total_s > 0.0).then_some(time_s / total_s);
        push(&format!("{regime}_share"), Cell::from(share));
    }
    for (name, energy) in energies(&features.energy) {
        push(name, Cell::from(energy));
    }
    record
}

pub fn switching_points(run: &ReplayedRun) -> Vec<Record> {
    let one = |point: &rundown::features::SwitchingPoint| {
        let cells = [
            Cell::from(run.name.as_str()),
            Cell::from(point.time_s),
            Cell::from(point.location_m),
            Cell::from(point.speed_mps),
            Cell::from(point.from.as_str()),
            Cell::from(point.to.as_str()),
        ];
        SWITCHING_POINT_COLUMNS.map(str::to_owned).into_iter().zip(cells).collect()
    };
    run.summary.features.switching_points.iter().map(one).collect()
}

fn effort_line(line: Option<&EffortLine>) -> [(&'static str, Cell); 5] {
    let statistic = line.map(|line| line.effort).unwrap_or_default();
    [
        ("max_effort_count", Cell::from(statistic.count)),
        ("max_effort_mean_n_per_kg", mean(&statistic)),
        ("max_effort_sd_n_per_kg", Cell::from(line.and_then(EffortLine::known_sd))),
        ("max_effort_at_lower_speed_n_per_kg", Cell::from(line.map(|line| line.at_lower_n_per_kg))),
        ("max_effort_slope_n_per_kg_per_mps", Cell::from(line.and_then(EffortLine::known_slope))),
    ]
}

fn statistic(push: &mut impl FnMut(&str, Cell), name: &str, unit: &str, statistic: &Statistic) {
    push(&format!("{name}_count"), Cell::from(statistic.count));
    push(&format!("{name}_mean_{unit}"), mean(statistic));
    push(&format!("{name}_sd_{unit}"), sd(statistic));
}

fn mean(statistic: &Statistic) -> Cell {
    if statistic.count > 0 { Cell::from(statistic.mean) } else { Cell::Missing }
}

/// One value has no standard deviation.
fn sd(statistic: &Statistic) -> Cell {
    if statistic.count > 1 { Cell::from(statistic.sd) } else { Cell::Missing }
}

fn phase(push: &mut impl FnMut(&str, Cell), name: &str, phase: Option<&Phase>) {
    let of = |field: fn(&Phase) -> f64| Cell::from(phase.map(field));
    push(&format!("{name}_start_time_s"), of(|p| p.start_time_s));
    push(&format!("{name}_start_location_m"), of(|p| p.start_location_m));
    push(&format!("{name}_start_speed_mps"), of(|p| p.start_speed_mps));
    push(&format!("{name}_duration_s"), of(|p| p.duration_s));
    push(&format!("{name}_length_m"), of(|p| p.length_m));
}

fn energies(energy: &Energy) -> [(&'static str, f64); 6] {
    [
        ("energy_traction_j_per_kg", energy.traction_j_per_kg),
        ("energy_brake_j_per_kg", energy.brake_j_per_kg),
        ("energy_r0_j_per_kg", energy.r0_j_per_kg),
        ("energy_r1_j_per_kg", energy.r1_j_per_kg),
        ("energy_r2_j_per_kg", energy.r2_j_per_kg),
        ("energy_gradient_j_per_kg", energy.gradient_j_per_kg),
    ]
}

/// `above_130`, `80_to_130`, `60_to_80`, `40_to_60`, `below_40`.
fn brake_steps(config: &FeatureConfig) -> [String; 5] {
    let [a, b, c, d] = config.brake_steps_kmh;
    [format!("above_{a}"), format!("{b}_to_{a}"), format!("{c}_to_{b}"), format!("{d}_to_{c}"), format!("below_{d}")]
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cell<'a>(record: &'a Record, name: &str) -> &'a Cell {
        let found = record.iter().find(|(column, _)| column == name);
        &found.unwrap_or_else(|| panic!("no column {name}")).1
    }

    #[test]
    fn what_was_not_seen_is_missing_and_not_zero() {
        let record = of_run(&Features::default(), &FeatureConfig::default());
        assert_eq!(cell(&record, "power_count"), &Cell::Count(0));
        for name in [
            "power_mean_w_per_kg",
            "brake_rate_80_to_130_kmh_sd_mps2",
            "cruise_speed_median_mps",
            "final_coast_length_m",
            "coast_share",
        ] {
            assert_eq!(cell(&record, name), &Cell::Missing, "{name}");
        }
    }

    #[test]
    fn one_value_has_a_mean_and_no_standard_deviation() {
        let mut features = Features::default();
        features.brake_rate_mps2[4] = Statistic { count: 1, mean: 0.5, sd: 0.0 };
        features.regime_time_s = [0.0, 10.0, 0.0, 30.0, 0.0];
        let record = of_run(&features, &FeatureConfig::default());
        assert_eq!(cell(&record, "brake_rate_below_40_kmh_mean_mps2"), &Cell::Number(0.5));
        assert_eq!(cell(&record, "brake_rate_below_40_kmh_sd_mps2"), &Cell::Missing);
        assert_eq!(cell(&record, "coast_share"), &Cell::Number(0.75));
    }

    #[test]
    fn a_line_through_too_few_points_has_no_slope_and_no_deviation() {
        let cells = |count| {
            let effort = Statistic { count, mean: 0.4, sd: 0.01 };
            let features = Features {
                max_effort: Some(EffortLine { effort, at_lower_n_per_kg: 0.45, slope: -0.02 }),
                ..Features::default()
            };
            let record = of_run(&features, &FeatureConfig::default());
            ["slope_n_per_kg_per_mps", "sd_n_per_kg"].map(|name| cell(&record, &format!("max_effort_{name}")).clone())
        };
        assert_eq!(cells(1), [Cell::Missing, Cell::Missing]);
        assert_eq!(cells(2), [Cell::Number(-0.02), Cell::Missing]);
        assert_eq!(cells(3), [Cell::Number(-0.02), Cell::Number(0.01)]);
    }

    #[test]
    fn names_are_unique() {
        let record = of_run(&Features::default(), &FeatureConfig::default());
        let mut names: Vec<&String> = record.iter().map(|(name, _)| name).collect();
        let count = names.len();
        names.sort();
        names.dedup();
        assert_eq!(names.len(), count);
    }
}
