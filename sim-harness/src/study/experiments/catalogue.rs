//! The experiments, in the order in which the page "after the paper" has them.

use super::swept::{recording, resistance, traction, trains};
use super::{By, Experiment, feedback, metrics, styles, units};

pub const ALL: [Experiment; 16] = [
    Experiment {
        name: "measured-effort",
        place: "5",
        question: "Does a measured effort give the resistance that a calculated one cannot?",
        by: By::Sweep(recording::measured_effort),
    },
    Experiment {
        name: "regime-feedback",
        place: "5",
        question: "Does the recognised regime, fed back to the paper's filter, let it follow the true resistance?",
        by: By::Own(feedback::answer),
    },
    Experiment {
        name: "sampling",
        place: "4.2, 5",
        question: "Does a shorter sampling time give more accurate estimates?",
        by: By::Sweep(recording::sampling),
    },
    Experiment {
        name: "process-noise",
        place: "4.2",
        question: "Which process noise Q does the paper's filter bear, and does it help?",
        by: By::Sweep(recording::process_noise),
    },
    Experiment {
        name: "units",
        place: "5",
        question: "Are units of one type distinguishable by their resistance?",
        by: By::Own(units::answer),
    },
    Experiment {
        name: "trains",
        place: "5",
        question: "Does the method carry over to other trains?",
        by: By::Sweep(trains::other_trains),
    },
    Experiment {
        name: "diesel",
        place: "3.3",
        question: "What do the notches of a diesel do to the power that is found?",
        by: By::Sweep(trains::diesel),
    },
    Experiment {
        name: "seasons",
        place: "5",
        question: "Is a resistance that changes with wear or temperature followed?",
        by: By::Sweep(resistance::seasons),
    },
    Experiment {
        name: "wind",
        place: "2",
        question: "What does wind do to the estimated resistance?",
        by: By::Sweep(resistance::wind),
    },
    Experiment {
        name: "gradient",
        place: "2",
        question: "Does the resistance absorb gradients that are described wrongly?",
        by: By::Sweep(resistance::gradient),
    },
    Experiment {
        name: "load",
        place: "2",
        question: "What do load and fuel do to mass-specific coefficients and power?",
        by: By::Sweep(resistance::load),
    },
    Experiment {
        name: "ato",
        place: "4.4",
        question: "How much of the variation of power is the driver's, how much is left with automatic operation?",
        by: By::Sweep(traction::automatic_operation),
    },
    Experiment {
        name: "supply",
        place: "4.4",
        question: "Is a weak feeding section seen in the power of the first acceleration?",
        by: By::Sweep(traction::supply),
    },
    Experiment {
        name: "adhesion",
        place: "3.3",
        question: "Is low adhesion seen in the largest effort?",
        by: By::Sweep(traction::adhesion),
    },
    Experiment {
        name: "capability",
        place: "3.3",
        question: "Can a limit of the train be distinguished from the habit of its drivers?",
        by: By::Sweep(traction::capability),
    },
    Experiment {
        name: "drivers",
        place: "5",
        question: "Do drivers differ in style, and in what?",
        by: By::Own(styles::answer),
    },
];

/// What any of them measures: name, and label with unit.
pub fn measured() -> Vec<(&'static str, &'static str)> {
    let metrics = metrics::ALL.iter().map(|metric| (metric.name, metric.label));
    metrics.chain(units::MEASURED).chain(styles::measured()).collect()
}

pub fn find(name: &str) -> Option<&'static Experiment> {
    ALL.iter().find(|experiment| experiment.name == name)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_experiment_is_found_by_its_own_name() {
        for (index, experiment) in ALL.iter().enumerate() {
            assert!(experiment.question.ends_with('?'), "{}", experiment.name);
            assert!(ALL[..index].iter().all(|before| before.name != experiment.name), "{}", experiment.name);
            assert_eq!(find(experiment.name).map(|found| found.question), Some(experiment.question));
        }
        assert!(find("none").is_none());
    }
}
