//! What hold-out runs have of each effect: a name that they deny is but a candidate.
//!
//! In: names of all runs, names of the training runs, and how many times as much as each of these foresees the hold-out
//! runs have. Out: which names of all runs they deny.

use crate::candidate::ShowsIn;
use crate::candidates;
use crate::config::HoldoutConfig;
use crate::holdout::share::{Multiple, is_denied};
use crate::named::Named;
use rundown::model::effects::Effect;

/// Whether the simulation of the hold-out runs shows it; readings are put right before.
pub fn is_simulated(effect: &Effect) -> bool {
    candidates::of_effect(effect).facts().nature.shows_in != ShowsIn::Readings
}

/// The effect of which the hold-out runs have the least, if they deny it; its index.
pub fn most_denied(multiples: &[Option<Multiple>], config: &HoldoutConfig) -> Option<usize> {
    let sure =
        multiples.iter().enumerate().filter_map(|(i, one)| one.filter(|one| is_denied(one, config)).map(|m| (i, m)));
    sure.min_by(|(_, (_, (_, a))), (_, (_, (_, b)))| a.total_cmp(b)).map(|(i, _)| i)
}

/// The same kind, and where it acts in a section, the sections overlap.
fn is_same(a: &Effect, b: &Effect) -> bool {
    let overlap = match (a.section_m(), b.section_m()) {
        (Some((from_a, to_a)), Some((from_b, to_b))) => from_a < to_b && from_b < to_a,
        (a, b) => a.is_none() && b.is_none(),
    };
    a.kind() == b.kind() && overlap
}

/// What the hold-out runs have of a name of all runs: of the one of the training runs that is the same. None where
/// there is none, or nothing was compared.
pub fn of(one: &Named, trained: &[(Effect, Option<Multiple>)]) -> Option<Multiple> {
    let same = trained.iter().find(|(effect, _)| one.runs.is_empty() && is_same(effect, &one.effect));
    same.and_then(|(_, multiple)| *multiple)
}

#[cfg(test)]
mod tests {
    use super::*;
    use rundown::model::effects::{GradientError, MassError};

    const LITTLE: Multiple = (0.2, (-0.1, 0.5));
    const ALL: Multiple = (0.9, (0.6, 1.2));

    fn gradient(from_m: f64) -> Effect {
        GradientError { from_m, to_m: from_m + 300.0, delta_permille: 2.0 }.into()
    }

    #[test]
    fn the_least_of_those_that_are_denied_goes_first() {
        let config = HoldoutConfig::default();
        assert_eq!(most_denied(&[None, Some(ALL)], &config), None);
        let less: Multiple = (0.0, (-0.4, 0.4));
        assert_eq!(most_denied(&[Some(LITTLE), Some(ALL), Some(less), None], &config), Some(2));
    }

    #[test]
    fn a_name_has_what_the_same_one_of_the_training_runs_has_at_its_place() {
        let trained = [
            (gradient(100.0), Some(LITTLE)),
            (gradient(5_000.0), Some(ALL)),
            (MassError { relative: 0.1 }.into(), None),
        ];
        let of = |effect: Effect| of(&Named::plain(effect, Vec::new(), 30.0, 30.0), &trained);
        assert_eq!(of(gradient(300.0)), Some(LITTLE), "they overlap");
        assert_eq!(of(gradient(4_800.0)), Some(ALL));
        assert_eq!(of(gradient(2_000.0)), None, "at another place");
        assert_eq!(of(MassError { relative: 0.05 }.into()), None, "nothing was compared");
    }
}
