//! What a file for another tool says of its values: which are learned and how sure, what is capability and what habit.

use super::number::decimal;
use crate::learned_train::{LearnedTrain, Limit, Used};
use rundown_check::figure::HALF_95;
use rundown_pages::numbers::{counted, number};

/// One sentence a line, for comments and text fields. Forces are those of a train of `mass_kg`.
pub(crate) fn sentences(learned: &LearnedTrain, mass_kg: f64) -> Vec<String> {
    let LearnedTrain { train, runs, .. } = learned;
    let rotating_mass_kg = train.rotating_mass_factor * mass_kg;
    let davis = [train.davis.r0, train.davis.r1, train.davis.r2];
    let coefficients =
        ["A", "B", "C"].iter().zip(["N", "N/(m/s)", "N/(m/s)^2"]).zip(davis.iter().zip(learned.davis_sd));
    let coefficients: Vec<String> = coefficients
        .map(|((name, unit), (mean, sd))| {
            let [mean, half] = [*mean, HALF_95 * sd].map(|value| decimal(rotating_mass_kg * value));
            format!("{name} = {mean} +/- {half} {unit}")
        })
        .collect();
    let runs = counted(*runs, "run", "runs");
    let mut said = vec![
        format!("Running resistance: learned by Rundown from {runs}, with 95 % intervals."),
        format!("{}.", coefficients.join(", ")),
        learned.learned_kmh.map_or_else(
            || "The speeds at which it was learned are not recorded.".to_owned(),
            |[least, most]| format!("Learned at {} to {} km/h; beyond, it rests on the description, and the intervals may be too narrow.", number(least, 0), number(most, 0)),
        ),
        limit("tractive effort", "N", &learned.effort),
        limit("power", "W", &learned.power),
        "Mass, rotating mass factor, length, brake: as described. Largest speed: as given for the export.".to_owned(),
    ];
    if !train.effect.is_empty() {
        let names: Vec<&str> = train.effect.iter().map(|entry| entry.effect.name()).collect();
        said.push(format!("Not in this file: named effects of the train ({}).", names.join(", ")));
    }
    said
}

/// `Largest power: 2000000 W, capability as described; ...`
pub(crate) fn limit(name: &str, unit: &str, limit: &Limit) -> String {
    let capability = limit.capability();
    let of = |runs| counted(runs, "run", "runs");
    let habit = match limit.used {
        None => "too few runs show what drivers use".to_owned(),
        Some(Used { median, runs }) if median > limit.described => {
            format!("drivers used it (median of {}), {:.0} {unit} were described", of(runs), limit.described)
        }
        Some(Used { median, runs }) => {
            let percent = 100.0 * median / limit.described;
            format!("drivers used {percent:.0} % of it (habit, median of {})", of(runs))
        }
    };
    let origin = if capability > limit.described { "observed" } else { "as described" };
    format!("Largest {name}: {capability:.0} {unit}, capability {origin}; {habit}.")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn capability_and_habit_are_distinguished() {
        let said = |median: f64| limit("power", "W", &Limit { described: 1e6, used: Some(Used { median, runs: 5 }) });
        assert_eq!(
            said(8.7e5),
            "Largest power: 1000000 W, capability as described; drivers used 87 % of it (habit, median of 5 runs)."
        );
        assert_eq!(
            said(1.1e6),
            "Largest power: 1100000 W, capability observed; drivers used it (median of 5 runs), 1000000 W were described."
        );
        let unknown = limit("power", "W", &Limit { described: 1e6, used: None });
        assert!(unknown.ends_with("too few runs show what drivers use."), "{unknown}");
        let one = limit("power", "W", &Limit { described: 1e6, used: Some(Used { median: 9e5, runs: 1 }) });
        assert!(one.contains("(habit, median of 1 run)"), "{one}");
    }
}
