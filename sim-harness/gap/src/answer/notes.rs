//! What a reader must know beside the verdict: for the screen, `gap.json` and the page alike.

use crate::admission::off_track;
use crate::answer::unseen::unseen;
use crate::answer::whole::Answer;
use crate::candidate::ShowsIn;
use crate::candidates;
use crate::config::{EffortConfig, GapConfig};
use crate::data::load::about_gradients;
use crate::data::runs::{EffortReading, usual_step_s};
use crate::findings::Findings;
use crate::holdout::share::{Multiple, is_denied};
use crate::investigation::Investigation;
use crate::levels::{NotCompared, Standout};
use crate::named::Named;
use crate::naming::names::may_be_none;
use crate::readings::nuisances::Nuisance;
use crate::search::headwind::Headwind;
use crate::traction::less_power::less_power;
use crate::wording::{listed, section};
use rundown::model::effects::Effect;
use rundown_check::gradients::{Follows, SeenBy, SmallErrors};
use rundown_files::statistics::{median, sorted};
use rundown_pages::numbers::counted;

/// Sentences, the weightiest first.
pub fn notes(answer: &Answer) -> Vec<String> {
    let (found, input, config) = (&answer.found, &answer.input, answer.holdout());
    let (runs, least) = (input.runs.len(), config.least_training);
    let mut notes = Vec::new();
    notes.extend(off_track(input, &answer.config).map(|off| format!("{off}.")));
    if found.findings.rows.is_empty() {
        notes.push(no_rows(&found.findings).to_owned());
    }
    notes.extend(seen(&found.findings, answer.config.search.few_rows));
    if !found.findings.rows.is_empty() {
        notes.extend(unseen(&found.findings.rows, input.surroundings.length_m));
    }
    let told = found.nuisances.iter().filter(|nuisance| nuisance.told);
    notes.extend(told.map(Nuisance::sentence));
    notes.extend(found.findings.headwind.as_ref().map(measured_wind));
    let is_limited = found.findings.limit(&answer.config.search).is_some();
    let less = less_power(&found.findings.powering, &answer.config.traction).filter(|_| !is_limited);
    notes.extend(less.map(|less| less.sentence()));
    if found.gap.is_worse(config) {
        notes.push(worse(answer));
    }
    let touched = found.touched.filter(|_| !found.named.is_empty());
    notes.extend(touched.and_then(|touched| touched.denying(config)).map(denied));
    if runs <= least {
        notes.push(format!(
            "{} at hand, none held out: an analysis needs {least}, so nothing here was tried out of sample.",
            counted(runs, "run", "runs")
        ));
    } else if found.held_out.is_empty() {
        notes.push("No run was held out: nothing here was tried out of sample.".to_owned());
    }
    if runs < config.few_runs {
        notes.push(format!(
            "Few runs ({runs}): what one driver or one day does can pass for an effect, and a small effect is not found."
        ));
    }
    notes.extend(other_names(found));
    notes.extend(found.named.iter().filter_map(|one| at_once(answer, one)));
    notes.extend(found.candidates.iter().map(|one| candidate(answer, one)));
    let off = found.whiteness.as_ref().filter(|white| white.is_off(&answer.config));
    notes.extend(off.map(|white| {
        format!(
            "The noise does not fit, so p-values, confidences and intervals are less sure than they look: {}.",
            white.sentence()
        )
    }));
    notes.extend(found.findings.differing.standouts.iter().map(Standout::sentence));
    notes.extend(found.findings.differing.not_compared.iter().map(NotCompared::sentence));
    notes.extend(contradiction(found, answer.config.evidence.significant));
    notes.extend(about_gradients(&input.track_file).map(str::to_owned));
    notes.extend(match found.findings.gradient_errors_permille() {
        Some(permille) => Some(at_most_places(permille)),
        None => input.small_errors.as_ref().map(agreeing),
    });
    notes.extend(unseen_speeds(&found.findings, &answer.config.effort));
    if input.left_out > 0 {
        notes.push(format!(
            "{} of {} logs could not be used; why stands on the screen.",
            input.left_out,
            input.left_out + runs
        ));
    }
    let described = input.train_file.effect.len() + input.track_file.effect.len();
    if described > 0 {
        notes.push(format!(
            "The described train and track had effects already ({described}). They were set aside: the analysis began without them, and what was found stands in their place."
        ));
    }
    notes
}

/// What different runs have in common at their places.
fn agreeing(small: &SmallErrors) -> String {
    let seen_by = match small.seen_by {
        SeenBy::Efforts => "The accelerations beside the efforts",
        SeenBy::Coasts => "Coasts",
    };
    match small.follows {
        Some(Follows::Steepness(times)) => format!(
            "{seen_by} say that all slopes act {} times as described, as beside a rotating mass or a wheel that is off. What is named besides may be due to that.",
            times.with_interval(3)
        ),
        Some(Follows::Length(times)) => format!(
            "{seen_by} say that slopes act as on a train {} times as long as described. What is named besides may be due to that.",
            times.with_interval(2)
        ),
        Some(Follows::Locations(metres)) => format!(
            "{seen_by} say that slopes come early or late from run to run, as if locations were off by {} m (standard deviation). What is named at a place may be due to that.",
            metres.with_interval(0)
        ),
        None => format!(
            "{seen_by} of different runs agree at their places on {:.2} permille (standard deviation) that the track does not describe: errors of its gradients, or an effect at places. Where it is errors, what is named beside them may be theirs.",
            small.sd_permille
        ),
    }
}

/// What the described gradients are off by, which the noise has.
fn at_most_places(permille: f64) -> String {
    format!(
        "The described gradients are off by {permille:.2} permille (standard deviation) at most places, alike in all runs. Names and p-values are beside that: what acts at a place must exceed it."
    )
}

/// What the headwind column explains, and whether the residuals fit just as much of it.
fn measured_wind(found: &Headwind) -> String {
    let (scale, [low, high]) = found.scale;
    let explained = 1.0 - (found.after_n_per_kg / found.before_n_per_kg).powi(2);
    format!(
        "The logs have a headwind column, so the air drag is taken at the air speed: in {} intervals that changes the residuals from {:.4} to {:.4} N/kg (root mean square), {:.0} % of their mean square. The residuals fit {scale:.2} times the measured wind (95 % interval {low:.2} to {high:.2}): {}.",
        found.rows,
        found.before_n_per_kg,
        found.after_n_per_kg,
        100.0 * explained,
        if found.agrees() {
            "they agree"
        } else {
            "they do not agree; look at the sensor, its sign and its unit, and at r2"
        },
    )
}

/// How much of the runs shows the resistance, where that is not nearly all.
fn seen(findings: &Findings, few_rows: usize) -> Option<String> {
    let rows = findings.rows.len();
    if rows == 0 {
        return None;
    }
    if rows < few_rows {
        return Some(format!(
            "Only {rows} intervals show the resistance, too few to look for an effect in: wheels, locations and limits of the traction alone were looked at."
        ));
    }
    if findings.measured {
        return None;
    }
    let speeds = speeds_kmh(findings);
    Some(format!(
        "Without an effort column the resistance shows in coasting alone: {:.0} % of the moving time, nine tenths of it between {:.0} and {:.0} km/h. What acts where nobody coasts is not seen.",
        100.0 * rows as f64 / findings.moving.max(rows) as f64,
        speeds[rows / 20],
        speeds[rows - 1 - rows / 20],
    ))
}

/// Mean speeds of the intervals that count, km/h, rising.
fn speeds_kmh(findings: &Findings) -> Vec<f64> {
    sorted(findings.rows.iter().map(|row| 3.6 * row.interval.mean_speed_mps()))
}

/// With an effort column: below which speed hardly an interval counts, where a resistance may act.
fn unseen_speeds(findings: &Findings, config: &EffortConfig) -> Option<String> {
    let least_kmh = *speeds_kmh(findings).get(config.few_slow)?;
    (findings.measured && least_kmh > config.slow_kmh).then(|| {
        format!(
            "Hardly an interval below {least_kmh:.0} km/h counts, for the effort changes within it: what acts there alone, such as a starting resistance, is not seen."
        )
    })
}

/// What is said where nothing could be evaluated by forces.
pub fn no_rows(findings: &Findings) -> &'static str {
    if findings.measured { TOO_FEW_ROWS } else { NO_ROWS }
}

/// The repaired model is further off on the hold-out runs.
fn worse(answer: &Answer) -> String {
    let (found, config) = (&answer.found, &answer.config.effort);
    let step_s = median(answer.input.runs.iter().map(usual_step_s)).unwrap_or(0.0);
    let is_guessed =
        found.findings.measured && found.findings.effort == EffortReading::Momentary && step_s >= config.fast_s;
    let meaning = if found.named.is_empty() {
        "Those are of the training runs alone; all runs show none, and the repaired model is the described one"
            .to_owned()
    } else if is_guessed {
        format!(
            "Of momentary efforts {step_s:.0} s apart the simulation guesses what is between two of them, so that this says little: \
             the p-value with the effects in the model says more"
        )
    } else {
        "Do not use the repaired model before this is understood".to_owned()
    };
    format!(
        "Worse than before: on the hold-out runs the simulated speed is off by {:.3} m/s with the effects and by {:.3} without them. {meaning}.",
        found.gap.after, found.gap.before
    )
}

/// The hold-out runs have less of the effects than these foresee.
fn denied((multiple, (low, high)): (f64, (f64, f64))) -> String {
    format!(
        "The hold-out runs have {multiple:.2} times what the effects foresee (95\u{a0}% interval {low:.2} to {high:.2}), which is too little for all of them: at least one is another one or smaller, so all are less sure."
    )
}

/// Without an effort column and without coasting.
pub const NO_ROWS: &str = "No resistance could be evaluated: the logs have no effort column, and no train coasts long enough in them. Only wheels, locations and limits of the traction were looked at.";

/// With an effort column that says too little.
const TOO_FEW_ROWS: &str = "No resistance could be evaluated: the logs have an effort column, but hardly an interval in which the train moves and the effort is steady. Only wheels, locations and limits of the traction were looked at.";

/// Before and after are measured with what the training runs show, which may be something else than all runs do.
fn other_names(found: &Investigation) -> Option<String> {
    let names = |named: &[Named]| {
        // A wheel of one run is put right before.
        let of_all = named.iter().filter(|one| !matches!(one.effect, Effect::SpeedScale(_)));
        listed(of_all.map(|one| one.effect.name()))
    };
    let (all, training) = (names(&found.named), names(&found.trained));
    (!found.held_out.is_empty() && all != training).then(|| {
        format!(
            "All runs show {}, those that were not held out {}: before and after on the hold-out runs are measured with the second, and a name that these do not have is less sure.",
            all, training
        )
    })
}

/// A section that begins and ends sooner than its law has it.
fn at_once(answer: &Answer, one: &Named) -> Option<String> {
    let share = answer.found.findings.terms.get(one.term?)?.at_once?;
    let GapConfig { nuisance, certainty, .. } = &answer.config;
    let is_sure = share.away_from(0.0) > nuisance.sure && share.value > certainty.at_once;
    is_sure.then(|| {
        format!(
            "{} from {} begins and ends as the front passes, not over the length of the train as its law has it ({:.2} \u{b1} {:.2} of it): no effect of its own, and not in the repaired model.",
            one.effect.name(),
            section(one),
            share.value,
            share.sd
        )
    })
}

/// What fits, and why it has no name.
fn candidate(answer: &Answer, one: &Named) -> String {
    let context = answer.context();
    let what = candidates::of_effect(&one.effect).sentence(one, &context);
    let may_be_none = may_be_none(one, context.believed.train().length_m());
    let mut acts = answer.input.runs.iter().filter(|run| one.runs.is_empty() || one.runs.contains(&run.name));
    let is_right = acts.any(|run| run.recorded.scale.is_some());
    not_named(&what, one, may_be_none, is_right, &answer.config)
}

/// `may_be_none`: the interval of its size holds none at all; `is_right`: the speeds have been put right by it.
fn not_named(what: &str, one: &Named, may_be_none: bool, is_right: bool, config: &GapConfig) -> String {
    let is_wheel = matches!(one.effect, Effect::SpeedScale(_));
    let is_denied = |multiple: &Multiple| is_denied(multiple, &config.holdout);
    let (because, settles) = match (one.or_else.filter(|_| is_wheel || one.may_be_habit()), &one.trial) {
        _ if let Some((multiple, (low, high))) = one.held_out.filter(is_denied) => (
            format!(
                "the hold-out runs have {multiple:.2} times what it foresees (95\u{a0}% interval {low:.2} to {high:.2}), as the other runs show it"
            ),
            "more runs".to_owned(),
        ),
        (Some(or_else), trial) if one.may_be_habit() || trial.as_ref().is_none_or(|trial| trial.is_stood(config)) => {
            (format!("it may as well be {or_else}"), one.would_separate.join(", "))
        }
        _ if one.is_unshared => (
            "all runs together show it, those that were not held out do not, and as runs are driven alike here, they have errors in common".to_owned(),
            "more runs".to_owned(),
        ),
        _ if may_be_none => ("the 95\u{a0}% interval of its size holds none at all".to_owned(), "more runs".to_owned()),
        (_, Some(trial)) if trial.is_of_errors(config) => {
            (trial.sentence(config), "a survey of the gradients, or runs over more of the line,".to_owned())
        }
        (_, Some(trial)) => (trial.sentence(config), "more runs".to_owned()),
        (_, None) => ("it was not tried in halves of the runs".to_owned(), "more runs".to_owned()),
    };
    let nevertheless = if is_wheel && is_right {
        " The diagnosis of the logs has put the speeds right by it nevertheless."
    } else {
        ""
    };
    format!(
        "A candidate, not a name: {what}. It is not in the repaired model, because {because}; {settles} would settle it.{nevertheless}"
    )
}

/// Where p-value and verdict seem to say different things.
fn contradiction(found: &Investigation, significant: f64) -> Option<String> {
    if found.findings.rows.is_empty() {
        return None;
    }
    let (before, after) = (found.p_value, found.p_value_after);
    let p = |value: f64| format!("p = {value:.3}");
    if found.named.is_empty() {
        return (before < significant).then(|| {
            format!(
                "The residuals are not quite what noise leaves ({}), yet no effect of the catalogue explains enough of them to be named.",
                p(before)
            )
        });
    }
    if before >= significant {
        return Some(format!(
            "The mean residuals as a whole show no gap ({}), what was found shows in {}. That is no contradiction.",
            p(before),
            shows_in(&found.named)
        ));
    }
    (after < significant).then(|| {
        format!(
            "Something is left in the residuals with the effects in the model ({}): a further effect too small to be named, or a law that is not quite the true one.",
            p(after)
        )
    })
}

/// In what effects show that leave no mean residual.
fn shows_in(named: &[Named]) -> String {
    let of = |one: &Named| match candidates::of_effect(&one.effect).facts().nature.shows_in {
        ShowsIn::FullPower => "the effort at full power",
        ShowsIn::Runs => "the differences between runs",
        ShowsIn::Readings => "the distance by location against the distance by speed",
        ShowsIn::Law => "the trial of its own law",
    };
    let mut all: Vec<&str> = named.iter().map(of).collect();
    all.sort_unstable();
    all.dedup();
    all.join(" and ")
}

#[cfg(test)]
mod tests {
    use super::*;
    use rundown::model::effects::MassError;
    use rundown_check::figure::Figure;

    #[test]
    fn a_candidate_says_why_it_has_no_name_and_what_would_settle_it() {
        let config = GapConfig::default();
        let mut wheel = Named::wheel(&Figure { value: 1.013, sd: 0.001 }, &config);
        let of = |wheel: &Named, may_be_none, is_right| not_named("a wheel", wheel, may_be_none, is_right, &config);
        let not_tried = of(&wheel, false, true);
        assert!(not_tried.contains("because it was not tried in halves of the runs; more runs would settle it."));
        assert!(not_tried.ends_with("put the speeds right by it nevertheless."), "{not_tried}");
        let none = of(&wheel, true, false);
        assert!(none.ends_with("holds none at all; more runs would settle it."), "{none}");
        wheel.or_else("stops elsewhere", 1.0, "runs with more stops");
        let or_stops = of(&wheel, true, false);
        let expected = "because it may as well be stops elsewhere; runs with more stops would settle it.";
        assert!(or_stops.ends_with(expected), "{or_stops}");
    }

    #[test]
    fn what_other_runs_deny_or_do_not_show_is_a_candidate_for_that_reason() {
        let config = GapConfig::default();
        let mass = || Named::plain(MassError { relative: 0.1 }.into(), Vec::new(), 30.0, 30.0);
        let because = |one: &Named| not_named("a mass", one, false, false, &config);
        let denied = because(&Named { held_out: Some((0.2, (-0.1, 0.5))), ..mass() });
        let expected = "because the hold-out runs have 0.20 times what it foresees (95\u{a0}% interval -0.10 to 0.50)";
        assert!(denied.contains(expected), "{denied}");
        let mut unshared = mass();
        unshared.unshared(&config);
        let not_shown = because(&unshared);
        assert!(not_shown.contains("all runs together show it, those that were not held out do not"), "{not_shown}");
        assert!(unshared.confidence < mass().confidence);
    }
}
