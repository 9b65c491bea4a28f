//! What a person reads on the screen when `rundown gap` is through.

use crate::answer::{acting::acting, rivals::Rival};
use crate::answer::{json::NO_ENERGY, notes::notes, whole::Answer};
use crate::candidates;
use crate::data::{believed::Context, runs::Run};
use crate::holdout::{forward::Touched, journey::Summary, share::Share};
use crate::named::Named;
use rundown_pages::numbers::counted;

/// The story.
pub fn story(answer: &Answer) -> String {
    let found = &answer.found;
    let mut text = format!("verdict: {}", found.verdict.name());
    if !found.findings.rows.is_empty() {
        text.push_str(&format!(
            "   p-value of the residuals without a gap: {:.3}, with the effects in the model: {:.3}",
            found.p_value, found.p_value_after
        ));
    }
    text.push('\n');
    for (i, one) in found.named.iter().enumerate() {
        let nearest = answer.rivals.get(i).and_then(|rivals| rivals.first());
        text.push_str(&of_effect(one, &answer.context(), &answer.input.runs, nearest));
    }
    text.push_str(&held_out(answer));
    for note in notes(answer) {
        text.push_str(&format!("note: {note}\n"));
    }
    text
}

/// How sure the name is, and below it what it says.
fn of_effect(one: &Named, context: &Context<'_>, runs: &[Run], nearest: Option<&Rival>) -> String {
    let mut text = format!("  {}, confidence {:.2}", one.effect.name(), one.confidence);
    text.push_str(&acting(one, runs));
    let rivals: Vec<&str> = one.rivals().collect();
    if !rivals.is_empty() {
        text.push_str(&format!(", not distinguishable from {}", rivals.join(", ")));
        if !one.would_separate.is_empty() {
            text.push_str(&format!("; would separate them: {}", one.would_separate.join(", ")));
        }
    }
    if let Some(nearest) = nearest {
        text.push_str(&format!("; next best {} (log-likelihood {})", nearest.name, compared(nearest.worse, context)));
    }
    let sentence = candidates::of_effect(&one.effect).sentence(one, context);
    format!("{text}\n    {sentence}.\n")
}

/// How a rival fits beside what is named; where it fits better, why that does not make it the name.
fn compared(worse: f64, context: &Context<'_>) -> String {
    let size = worse.abs();
    match worse {
        w if w >= 0.0 => format!("{size:.1} less"),
        w if w > -context.config.certainty.rival_within => {
            format!("{size:.1} more, too little for these data to separate the two")
        }
        _ => format!("{size:.1} more: it fits better than what is named"),
    }
}

fn held_out(answer: &Answer) -> String {
    let (found, gap) = (&answer.found, &answer.found.gap);
    if found.compared.is_empty() {
        return "no hold-out run could be compared: too few runs, or too little to simulate in them\n".to_owned();
    }
    let all = if gap.is_worse(answer.holdout()) { "worse than before".to_owned() } else { gone(gap) };
    let mut text = format!(
        "simulated against measured speed, {}: {:.3} m/s before, {:.3} after, noise floor {:.3}: {all}\n",
        counted(found.held_out.len(), "hold-out run", "hold-out runs"),
        gap.before,
        gap.after,
        gap.floor,
    );
    if let Some(touched) = &found.touched {
        let Touched { count, share, multiple } = touched;
        let multiple = multiple.map_or_else(String::new, |(value, (low, high))| {
            format!("; {value:.2} times what the effects foresee is there (95 % interval {low:.2} to {high:.2})")
        });
        text.push_str(&format!(
            "where the effects act, {count} of {} speeds: {:.3} m/s before, {:.3} after, noise floor {:.3}: {}{multiple}\n",
            found.compared.len(),
            share.before,
            share.after,
            share.floor,
            gone(share),
        ));
    }
    if let Some(times) = answer.times() {
        text.push_str(&of_runs("running time", "s", 2, &times));
    }
    match answer.energies() {
        Some(energies) => text.push_str(&of_runs("energy at the wheel", "kWh", 2, &energies)),
        None => text.push_str(&format!("energy at the wheel: {NO_ENERGY}\n")),
    }
    text
}

fn gone(share: &Share) -> String {
    match share.removed {
        Some(removed) => format!("{:.0} % of the removable gap is gone{}", 100.0 * removed, interval(share.removed_95)),
        None => "there was nothing to remove".to_owned(),
    }
}

fn of_runs(what: &str, unit: &str, decimals: usize, summary: &Summary) -> String {
    let share = &summary.share;
    let gone = gone(share);
    format!(
        "{what} of a run, {}, root mean square error: {:.decimals$} {unit} before, {:.decimals$} after, noise floor {:.decimals$}; in sum {:+.1} % before, {:+.1} % after: {gone}\n",
        counted(share.runs, "run", "runs"),
        share.before,
        share.after,
        share.floor,
        100.0 * summary.before.relative,
        100.0 * summary.after.relative,
    )
}

fn interval(ends: Option<(f64, f64)>) -> String {
    ends.map_or_else(String::new, |(low, high)| format!(" (95 % interval {:.0} to {:.0})", 100.0 * low, 100.0 * high))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::data::believed::tests::on_a_level_line;
    use rundown::model::effects::{Coordinate, Effect, LocationLag, TunnelDrag, Unknown};

    #[test]
    fn each_effect_stands_in_a_sentence_with_units() {
        let text = |effect| {
            let named = Named::plain(effect, Vec::new(), 9.0, 30.0);
            on_a_level_line(2, |context| of_effect(&named, context, &[], Some(&Rival { name: "warm_up", worse: 4.25 })))
        };
        let early = text(Effect::LocationLag(LocationLag { lag_s: -2.1 }));
        assert!(early.contains("early") && early.contains("2.10 s"), "{early}");
        assert!(
            early.starts_with("  location_lag, confidence 0.99; next best warm_up (log-likelihood 4.2 less)\n    ")
        );
        let beside = |worse| on_a_level_line(2, |context| compared(worse, context));
        assert_eq!(beside(-1.0), "1.0 more, too little for these data to separate the two");
        assert_eq!(beside(-4.0), "4.0 more: it fits better than what is named");
        let table = [(10.0, 0.0), (40.0, 2e-3)].into_iter().collect();
        let unknown = text(Effect::Unknown(Unknown { coordinate: Coordinate::Speed, table }));
        assert!(unknown.contains("depends on the speed: 0.00200 N/kg most at 144.0 km/h"), "{unknown}");
        let tunnel = text(Effect::TunnelDrag(TunnelDrag { from_m: 8e3, to_m: 9e3, k: 1e-5 }));
        assert!(tunnel.contains("from km 8") && tunnel.contains("N/kg per (m/s)\u{b2}"), "{tunnel}");
        for text in [early, unknown, tunnel] {
            assert!(!text.contains('{') && text.ends_with(".\n"), "{text}");
        }
    }
}
