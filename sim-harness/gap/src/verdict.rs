//! What an investigation comes to, in one word.

use crate::config::{GapConfig, HoldoutConfig};
use crate::holdout::{forward::Touched, share::Share};
use crate::named::Named;
use rundown::model::effects::Effect;

/// What an investigation comes to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// What the model does not explain is what sensors leave.
    NoGap,
    /// Something is there that these runs cannot name: residuals that are not quite noise, or a term that fits and does
    /// not repeat.
    Candidate,
    /// There is a gap, and no name for it.
    Unknown,
    /// Named effects remove a part of the gap.
    PartlyExplained,
    /// Named effects remove the gap.
    Explained,
}

impl Verdict {
    /// One word.
    pub fn name(self) -> &'static str {
        match self {
            Self::NoGap => "no_gap",
            Self::Candidate => "candidate",
            Self::Unknown => "unknown",
            Self::PartlyExplained => "partly_explained",
            Self::Explained => "explained",
        }
    }
}

/// What a verdict rests on.
pub(crate) struct Grounds<'a> {
    pub named: &'a [Named],
    pub candidates: &'a [Named],
    /// Of the residuals of the believed model.
    pub p_value: f64,
    /// The same with the effects in the model.
    pub p_value_after: f64,
    /// Described gradients are off at most places.
    pub gradients_are_off: bool,
    /// On the hold-out runs; none where nothing could be compared.
    pub gap: Option<(&'a Share, Option<&'a Touched>)>,
}

impl Grounds<'_> {
    pub fn verdict(&self, config: &GapConfig) -> Verdict {
        // The wheel of one run is put right before the gap is measured.
        let of_one_run = |n: &Named| matches!(n.effect, Effect::SpeedScale(_)) && !n.runs.is_empty();
        let unknown = |n: &Named| matches!(n.effect, Effect::Unknown(_));
        let something =
            self.p_value < config.evidence.significant || !self.candidates.is_empty() || self.gradients_are_off;
        let beyond_doubt = self.p_value < config.evidence.sure;
        // Errors of the gradients that may make a candidate may make the gap, too.
        let may_be_gradients =
            self.candidates.iter().any(|one| one.trial.as_ref().is_some_and(|trial| trial.is_of_errors(config)));
        match self.named {
            [] if beyond_doubt && !may_be_gradients => Verdict::Unknown,
            [] if something => Verdict::Candidate,
            [] => Verdict::NoGap,
            named if named.iter().all(of_one_run) && !something && !self.is_left(config) => Verdict::Explained,
            named if named.iter().all(of_one_run) => Verdict::PartlyExplained,
            named if named.iter().all(unknown) => Verdict::Unknown,
            named if self.is_removed(config) && !named.iter().any(unknown) => Verdict::Explained,
            _ => Verdict::PartlyExplained,
        }
    }

    /// The hold-out runs have a gap that is still there.
    fn is_left(&self, config: &GapConfig) -> bool {
        let HoldoutConfig { explained, still_there, .. } = config.holdout;
        self.gap.is_some_and(|(gap, _)| {
            gap.removed.is_some_and(|removed| removed < explained) && gap.after > still_there * gap.floor
        })
    }

    /// The effects remove the gap on the hold-out runs.
    fn is_removed(&self, config: &GapConfig) -> bool {
        let Some((gap, touched)) = self.gap else {
            return false;
        };
        let holdout = &config.holdout;
        let share = touched.map_or(gap, |touched| &touched.share);
        let most = share.removed.is_some_and(|share| share >= holdout.explained);
        // The noise floor may be too low; where nothing is left in the residuals and the hold-out runs have what was
        // foreseen, that is all.
        let foreseen =
            |multiple: f64, low: f64| low > 0.0 && multiple < holdout.foreseen && multiple * holdout.foreseen > 1.0;
        let nothing_left = self.p_value_after >= config.evidence.significant;
        let all = touched.and_then(|touched| touched.multiple).is_some_and(|(one, (low, _))| foreseen(one, low));
        // What is surely no noise is not explained.
        let something_left = self.p_value_after < config.evidence.sure;
        (most || nothing_left && all) && !something_left && !gap.is_worse(holdout)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::trial::Trial;
    use rundown::model::effects::{MassError, SpeedScale};

    fn verdict(named: &[Named], candidates: &[Named], p_value: f64) -> Verdict {
        let gradients_are_off = false;
        Grounds { named, candidates, p_value, p_value_after: 1.0, gradients_are_off, gap: None }
            .verdict(&GapConfig::default())
    }

    fn mass() -> Named {
        Named::plain(MassError { relative: 0.1 }.into(), Vec::new(), 20.0, 30.0)
    }

    #[test]
    fn no_gap_stands_beside_neither_a_candidate_nor_a_low_p_value() {
        assert_eq!(verdict(&[], &[], 0.3), Verdict::NoGap);
        assert_eq!(verdict(&[], &[], 0.049), Verdict::Candidate);
        assert_eq!(verdict(&[], &[mass()], 0.3), Verdict::Candidate);
        assert_eq!(verdict(&[], &[mass()], 0.001), Verdict::Unknown);
        assert_eq!(verdict(&[], &[], 0.001), Verdict::Unknown);
        assert_eq!(verdict(&[mass()], &[], 0.001), Verdict::PartlyExplained, "nothing was compared");
    }

    #[test]
    fn gradients_that_are_off_are_something_without_a_name() {
        let verdict = |gradients_are_off: bool, p_value: f64| {
            let gap = None;
            let grounds = Grounds { named: &[], candidates: &[], p_value, p_value_after: 1.0, gradients_are_off, gap };
            grounds.verdict(&GapConfig::default())
        };
        assert_eq!([false, true].map(|off| verdict(off, 0.3)), [Verdict::NoGap, Verdict::Candidate]);
        assert_eq!(verdict(true, 0.001), Verdict::Unknown, "what exceeds them is another gap");
    }

    #[test]
    fn what_may_be_errors_of_the_gradients_is_no_gap_without_a_name() {
        let of = |beside: f64| {
            let mut trial = Trial::of(0.001, Vec::new());
            trial.beside_errors(0.5, &Trial::of(beside, Vec::new()));
            verdict(&[], &[Named { trial: Some(trial), ..mass() }], 0.001)
        };
        assert_eq!([0.002, 0.5].map(of), [Verdict::Unknown, Verdict::Candidate]);
    }

    #[test]
    fn the_wheel_of_a_run_explains_no_low_p_value_of_all() {
        let scale = SpeedScale { measured_over_true: 1.01 };
        let wheel = Named { runs: vec!["a".to_owned()], ..Named::plain(scale.into(), Vec::new(), 20.0, 30.0) };
        assert_eq!(verdict(std::slice::from_ref(&wheel), &[], 0.3), Verdict::Explained);
        assert_eq!(verdict(std::slice::from_ref(&wheel), &[], 0.01), Verdict::PartlyExplained);
        // Nor a gap that the hold-out runs have with and without it.
        let gap = Share { runs: 8, before: 1.03, after: 1.03, floor: 0.14, removed: Some(0.0), removed_95: None };
        let beside = |gap: &Share| {
            let (named, gap) = (std::slice::from_ref(&wheel), Some((gap, None)));
            let grounds =
                Grounds { named, candidates: &[], p_value: 0.3, p_value_after: 1.0, gradients_are_off: false, gap };
            grounds.verdict(&GapConfig::default())
        };
        assert_eq!(beside(&gap), Verdict::PartlyExplained);
        assert_eq!(beside(&Share { before: 0.15, after: 0.15, ..gap }), Verdict::Explained);
    }
}
