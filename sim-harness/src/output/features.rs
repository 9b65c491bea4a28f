//! `features.csv` and `switching_points.csv`: what section 3.3 asks of each run.
//!
//! Every feature has its count, mean and standard deviation, with the unit in the name; what was not seen has count 0
//! and empty fields. Per mass means per rotating mass γ m. Names of brake steps hold the configured speeds.

use crate::output::parameters;
use rundown::features::{EffortLine, Energy, FeatureConfig, Features, Phase, Statistic, SwitchingPoint};
use rundown::tick::regime::Regime;
use rundown_files::column::Column;
use rundown_files::replay::ReplayedRun;

const NOT_SEEN: &str = "it was not seen";
const NO_SPREAD: &str = "there are too few values for a deviation";
const NO_TIME: &str = "no time went by";

/// The columns of `features.csv`.
pub fn columns(config: &FeatureConfig) -> Vec<Column<ReplayedRun>> {
    let duration_s = |run: &ReplayedRun| {
        let mut times_s = run.estimates.iter().map(|estimate| estimate.time_s);
        let first = times_s.next()?;
        Some(times_s.next_back().unwrap_or(first) - first)
    };
    let mut columns = vec![
        parameters::run_name(),
        parameters::unit(),
        parameters::direction(),
        Column::number("duration_s", "s", "from the first to the last estimate", duration_s)
            .empty_when("there is no estimate"),
        Column::text("perturbed", "what outside the train held the run up", |run: &ReplayedRun| {
            run.perturbed.clone().unwrap_or_default()
        })
        .empty_when("nothing did, or nobody looked"),
    ];
    let of_run = of_run(config).into_iter();
    columns.extend(of_run.map(|column| column.of_part(|run: &ReplayedRun| &run.summary.features)));
    columns
}

/// The features of a run, without its name.
pub(super) fn of_run(config: &FeatureConfig) -> Vec<Column<Features>> {
    let mut columns = effort_line(config);
    let [least, most] = config.power_window_kmh;
    let power = format!("tractive power between {least} and {most} km/h");
    columns.extend(statistic("power", ["w_per_kg", "W/kg"], &power, |f| f.power_w_per_kg));
    let [least, most] = config.max_power_window_kmh;
    let power = format!("largest tractive power between {least} and {most} km/h");
    columns.push(
        Column::number("power_max_w_per_kg", "W/kg", &power, |f: &Features| f.max_power_w_per_kg).empty_when(NOT_SEEN),
    );
    for (index, name) in brake_steps(config).iter().enumerate() {
        let (name, meaning) = (format!("brake_rate_{name}_kmh"), format!("brake rate {} km/h", name.replace('_', " ")));
        columns.extend(statistic(&name, ["mps2", "m/s²"], &meaning, move |f| f.brake_rate_mps2[index]));
    }
    columns.extend(statistic("cruise_speed", ["mps", "m/s"], "cruise speed, its count in s", |f| f.cruise_speed_mps));
    columns.push(
        Column::number("cruise_speed_median_mps", "m/s", "median of the cruise speed", |f: &Features| {
            f.cruise_speed_median_mps
        })
        .empty_when(NOT_SEEN),
    );
    columns.extend(phase("final_coast", "the final coast", |f| f.final_coast));
    columns.extend(phase("final_brake", "the final brake", |f| f.final_brake));
    columns.push(Column::count("switching_points_count", "changes of regime", |f: &Features| {
        f.switching_points.len() + f.switching_points_lost as usize
    }));
    columns.extend(Regime::ALL.into_iter().flat_map(time_in));
    columns.extend(energies());
    columns
}

/// A change of regime in a run.
#[derive(Clone, Debug)]
pub struct Switch {
    run: String,
    point: SwitchingPoint,
}

/// The columns of `switching_points.csv`; all but the first stand in `replay.json` too.
pub fn switch_columns() -> Vec<Column<Switch>> {
    vec![
        Column::text("run", "name of the run", |s: &Switch| s.run.clone()),
        Column::number("time_s", "s", "when the regime changed", |s: &Switch| s.point.time_s),
        Column::number("location_m", "m", "where it changed", |s: &Switch| s.point.location_m),
        Column::number("speed_mps", "m/s", "speed there", |s: &Switch| s.point.speed_mps),
        Column::text("from", "regime before", |s: &Switch| s.point.from.as_str()),
        Column::text("to", "regime after", |s: &Switch| s.point.to.as_str()),
    ]
}

/// The changes of regime of a run.
pub fn switches(run: &ReplayedRun) -> impl Iterator<Item = Switch> + '_ {
    let points = run.summary.features.switching_points.iter();
    points.map(|point| Switch { run: run.name.clone(), point: *point })
}

fn effort_line(config: &FeatureConfig) -> Vec<Column<Features>> {
    let [least, most] = config.effort_window_kmh;
    let mean = format!("largest tractive effort between {least} and {most} km/h");
    let lower = format!("the same at {least} km/h, of a straight line over speed");
    let line = |value: fn(&EffortLine) -> Option<f64>| move |f: &Features| f.max_effort.as_ref().and_then(value);
    let count = |f: &Features| f.max_effort.map_or(0, |line| line.effort.count);
    let known = |line: &EffortLine| (line.effort.count > 0).then_some(line.effort.mean);
    vec![
        Column::count("max_effort_count", "values of the largest tractive effort", count),
        Column::number("max_effort_mean_n_per_kg", "N/kg", &mean, line(known)).empty_when(NOT_SEEN),
        Column::number("max_effort_sd_n_per_kg", "N/kg", "deviation from that line", line(EffortLine::known_sd))
            .empty_when("it has fewer than three values"),
        Column::number("max_effort_at_lower_speed_n_per_kg", "N/kg", &lower, line(|l| Some(l.at_lower_n_per_kg)))
            .empty_when(NOT_SEEN),
        Column::number(
            "max_effort_slope_n_per_kg_per_mps",
            "N/kg per m/s",
            "slope of that line",
            line(EffortLine::known_slope),
        )
        .empty_when("it has fewer than two values"),
    ]
}

/// Count, mean and standard deviation. `[suffix, unit]`: of the names, and as it is written.
fn statistic(
    name: &str,
    [suffix, unit]: [&'static str; 2],
    meaning: &str,
    of: impl Fn(&Features) -> Statistic + Copy + Send + Sync + 'static,
) -> [Column<Features>; 3] {
    let mean = move |f: &Features| Some(of(f)).filter(|s| s.count > 0).map(|s| s.mean);
    // One value has no standard deviation.
    let sd = move |f: &Features| Some(of(f)).filter(|s| s.count > 1).map(|s| s.sd);
    [
        Column::count(&format!("{name}_count"), &format!("values: {meaning}"), move |f: &Features| of(f).count),
        Column::number(&format!("{name}_mean_{suffix}"), unit, &format!("mean: {meaning}"), mean).empty_when(NOT_SEEN),
        Column::number(&format!("{name}_sd_{suffix}"), unit, &format!("standard deviation: {meaning}"), sd)
            .empty_when(NO_SPREAD),
    ]
}

fn phase(name: &str, what: &str, of: fn(&Features) -> Option<Phase>) -> [Column<Features>; 5] {
    let one = |part: &str, unit: &'static str, meaning: &str, value: fn(&Phase) -> f64| {
        let meaning = format!("{meaning} of {what}");
        Column::number(&format!("{name}_{part}"), unit, &meaning, move |f: &Features| of(f).as_ref().map(value))
            .empty_when(NOT_SEEN)
    };
    [
        one("start_time_s", "s", "time of the start", |p| p.start_time_s),
        one("start_location_m", "m", "location of the start", |p| p.start_location_m),
        one("start_speed_mps", "m/s", "speed at the start", |p| p.start_speed_mps),
        one("duration_s", "s", "duration", |p| p.duration_s),
        one("length_m", "m", "length", |p| p.length_m),
    ]
}

fn time_in(regime: Regime) -> [Column<Features>; 2] {
    let time_s = move |f: &Features| f.regime_time_s[regime as usize];
    let share = move |f: &Features| {
        let total_s: f64 = f.regime_time_s.iter().sum();
        (total_s > 0.0).then_some(time_s(f) / total_s)
    };
    [
        Column::number(&format!("{regime}_time_s"), "s", &format!("time in the regime `{regime}`"), time_s),
        Column::number(&format!("{regime}_share"), "1", &format!("share of the time in `{regime}`"), share)
            .empty_when(NO_TIME),
    ]
}

fn energies() -> [Column<Features>; 6] {
    let one = |part: &str, meaning: &str, value: fn(&Energy) -> f64| {
        let name = format!("energy_{part}_j_per_kg");
        Column::number(&name, "J/kg", meaning, move |f: &Features| value(&f.energy))
    };
    [
        one("traction", "work of the traction", |e| e.traction_j_per_kg),
        one("brake", "work taken out by the brake, positive", |e| e.brake_j_per_kg),
        one("r0", "work against r0", |e| e.r0_j_per_kg),
        one("r1", "work against r1 v", |e| e.r1_j_per_kg),
        one("r2", "work against r2 v²", |e| e.r2_j_per_kg),
        one("gradient", "work against the gradient, negative where the train came down", |e| e.gradient_j_per_kg),
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
    use rundown_files::column;
    use rundown_files::table::{Cell, Record};

    fn of_run(features: &Features) -> Record {
        column::record(&super::of_run(&FeatureConfig::default()), features)
    }

    fn cell<'a>(record: &'a Record, name: &str) -> &'a Cell {
        let found = record.iter().find(|(column, _)| column == name);
        &found.unwrap_or_else(|| panic!("no column {name}")).1
    }

    #[test]
    fn what_was_not_seen_is_missing_and_not_zero() {
        let record = of_run(&Features::default());
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
        let record = of_run(&features);
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
            let record = of_run(&features);
            ["slope_n_per_kg_per_mps", "sd_n_per_kg"].map(|name| cell(&record, &format!("max_effort_{name}")).clone())
        };
        assert_eq!(cells(1), [Cell::Missing, Cell::Missing]);
        assert_eq!(cells(2), [Cell::Number(-0.02), Cell::Missing]);
        assert_eq!(cells(3), [Cell::Number(-0.02), Cell::Number(0.01)]);
    }

    #[test]
    fn names_are_unique() {
        let record = of_run(&Features::default());
        let mut names: Vec<&String> = record.iter().map(|(name, _)| name).collect();
        let count = names.len();
        names.sort();
        names.dedup();
        assert_eq!(names.len(), count);
    }
}
