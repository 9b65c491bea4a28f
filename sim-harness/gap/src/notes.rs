//! What a reader must know beside the verdict: for the screen, `gap.json` and the page alike.

use super::analysis::{FEW_ROWS, Findings};
use super::forward::Gap;
use super::named::Named;
use super::terms::Term;
use super::workflow::{Investigation, LEAST_TRAINING};
use rundown::model::effects::Effect;
use rundown_pages::numbers::counted;

/// With fewer runs a name rests on little.
const FEW_RUNS: usize = 10;
/// A p-value below it is evidence of a gap.
pub const SIGNIFICANT: f64 = 0.05;

/// Sentences, the weightiest first; `runs`: how many there were.
pub fn notes(found: &Investigation, runs: usize) -> Vec<String> {
    let mut notes = Vec::new();
    if found.findings.rows.is_empty() {
        notes.push(NO_ROWS.to_owned());
    }
    notes.extend(seen(&found.findings));
    notes.extend(gauge(&found.findings));
    if worse(&found.gap) {
        notes.push(format!(
            "Worse than before: on the held-out runs the simulated speed is off by {:.3} m/s with the effects and by {:.3} without them. Do not use the repaired model before this is understood.",
            found.gap.after_mps, found.gap.before_mps
        ));
    }
    if runs <= LEAST_TRAINING {
        notes.push(format!(
            "{} at hand, none held out: an analysis needs {LEAST_TRAINING}, so nothing here was tried on runs that took no part.",
            counted(runs, "run", "runs")
        ));
    } else if found.held_out.is_empty() {
        notes.push("No run was held out: nothing here was tried on runs that took no part.".to_owned());
    }
    if runs < FEW_RUNS {
        notes.push(format!(
            "Few runs ({runs}): what one driver or one day does can pass for an effect, and a small effect is not found."
        ));
    }
    notes.extend(other_names(found));
    notes.extend(contradiction(found));
    notes
}

/// What the gauge of the effort reads too much or too little.
fn gauge(findings: &Findings) -> Option<String> {
    let gauge = findings.terms.iter().find(|fitted| fitted.term == Term::Gauge)?;
    let share = gauge.beta.first()?;
    Some(format!(
        "The effort column reads {:.1} % too {} for the motion, beside what is named: a matter of its gauge, which the model does not need to know.",
        100.0 * share.abs(),
        if *share > 0.0 { "much" } else { "little" },
    ))
}

/// How much of the runs tells of the resistance, where that is not nearly all.
fn seen(findings: &Findings) -> Option<String> {
    let rows = findings.rows.len();
    if rows == 0 {
        return None;
    }
    if rows < FEW_ROWS {
        return Some(format!(
            "Only {rows} intervals tell of the resistance, too few to look for an effect in: wheels, locations and limits of the traction alone were looked at."
        ));
    }
    if findings.measured {
        return None;
    }
    let mut speeds: Vec<f64> = findings.rows.iter().map(|row| 3.6 * row.interval.mean_speed_mps()).collect();
    speeds.sort_by(f64::total_cmp);
    Some(format!(
        "Without an effort column the resistance shows in coasting alone: {:.0} % of the moving time, nine tenths of it between {:.0} and {:.0} km/h. What acts where nobody coasts is not seen.",
        100.0 * rows as f64 / findings.moving.max(rows) as f64,
        speeds[rows / 20],
        speeds[rows - 1 - rows / 20],
    ))
}

/// What is said where nothing could be judged by forces.
pub const NO_ROWS: &str = "No resistance could be judged: the logs have no effort column, and no train coasts long enough in them. Only wheels, locations and limits of the traction were looked at.";

/// The repaired model is further off where there was something to remove, or by more than chance rounding.
pub fn worse(gap: &Gap) -> bool {
    gap.is_worse() && gap.after_mps > 1.001 * gap.before_mps
}

/// Before and after are measured with what the training runs tell, which may be something else than all runs do.
fn other_names(found: &Investigation) -> Option<String> {
    let names = |named: &[Named]| {
        // A wheel of one run is put right before.
        let of_all = named.iter().filter(|one| !matches!(one.effect, Effect::SpeedScale(_)));
        let mut names: Vec<&str> = of_all.map(|one| one.effect.name()).collect();
        names.sort_unstable();
        names
    };
    let (all, training) = (names(&found.named), names(&found.trained));
    let told = |names: &[&str]| match names {
        [] => "nothing".to_owned(),
        names => names.join(", "),
    };
    (!found.held_out.is_empty() && all != training).then(|| {
        format!(
            "All runs tell of {}, those that were not held out of {}: before and after on the held-out runs are measured with the second.",
            told(&all),
            told(&training)
        )
    })
}

/// Where p-value and verdict seem to say different things.
fn contradiction(found: &Investigation) -> Option<String> {
    if found.findings.rows.is_empty() {
        return None;
    }
    let (before, after) = (found.p_value, found.p_value_after);
    let p = |value: f64| format!("p = {value:.3}");
    if found.named.is_empty() {
        return (before < SIGNIFICANT).then(|| {
            format!(
                "The residuals are not quite what noise leaves ({}), yet no effect of the catalogue explains enough of them to be named.",
                p(before)
            )
        });
    }
    if before >= SIGNIFICANT {
        return Some(format!(
            "The mean residuals show no gap ({}), and that is no contradiction: what was found shows in {}.",
            p(before),
            shows_in(&found.named)
        ));
    }
    (after < SIGNIFICANT).then(|| {
        format!(
            "Something is left in the residuals with the effects in the model ({}): a further effect too small to be named, or a law that is not quite the true one.",
            p(after)
        )
    })
}

/// In what effects show that leave no mean residual.
fn shows_in(named: &[Named]) -> String {
    let of = |one: &Named| match one.effect {
        Effect::PowerLimitSection(_) | Effect::TractionScale(_) | Effect::LowAdhesion(_) => "the effort at full power",
        Effect::RunWind(_) | Effect::DraggingBrake(_) => "the differences between runs",
        Effect::SpeedScale(_) | Effect::LocationLag(_) => "the way by location against the way by speed",
        _ => "the fit of its own law",
    };
    let mut all: Vec<&str> = named.iter().map(of).collect();
    all.sort_unstable();
    all.dedup();
    all.join(" and ")
}
