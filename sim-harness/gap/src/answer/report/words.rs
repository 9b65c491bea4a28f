//! The verdict in sentences: what, where, how large, how sure, and what it is not distinguishable from.

use crate::answer::{acting::acting, notes::notes, whole::Answer};
use crate::candidates;
use crate::named::Named;
use crate::verdict::Verdict;
use crate::wording::{confidence, plain};
use rundown_pages::numbers::{counted, number};

/// `a`, `a or b`.
pub(super) fn verdict(answer: &Answer) -> Vec<String> {
    let found = &answer.found;
    let all = counted(answer.input.runs.len(), "run", "runs");
    let mut notes = notes(answer);
    // What could not be evaluated at all comes before what was found.
    let (mut sentences, has_rows) = match found.findings.rows.is_empty() {
        true => (vec![notes.remove(0)], false),
        false => (Vec::new(), true),
    };
    let chance = match found.p_value {
        p if p <= 0.0011 => "at most one time in a thousand".to_owned(),
        p => format!("with probability {}", number(p, 3)),
    };
    let least = answer.config.evidence.significant;
    let significant = has_rows && found.p_value < least;
    if found.named.is_empty() {
        sentences.push(match found.verdict {
            Verdict::Candidate => format!("Something may be missing in the model that these {all} cannot name."),
            _ if !has_rows => format!("In what could be looked at, nothing was found in {all}."),
            Verdict::Unknown => format!("There is a gap, and no effect of the catalogue was found for it in {all}."),
            Verdict::NoGap | Verdict::PartlyExplained | Verdict::Explained => format!(
                "No gap: what the model does not explain in {all} is what these sensors leave (such residuals, or larger ones, come about by chance {chance})."
            ),
        });
    } else {
        sentences.extend(found.named.iter().map(|one| of(answer, one)));
        sentences.extend(held_out(answer));
        if significant {
            let left = match found.p_value_after {
                p if p >= least => format!(
                    "; what is left with the effects in the model is consistent with noise (p = {})",
                    number(p, 2)
                ),
                _ => String::new(),
            };
            sentences.push(format!("Chance alone would leave such residuals {chance}{left}."));
        }
    }
    sentences.extend(notes);
    sentences
}

/// What the effects bring on hold-out runs; where they bring harm, a note says so.
fn held_out(answer: &Answer) -> Option<String> {
    let (found, gap) = (&answer.found, &answer.found.gap);
    if found.compared.is_empty() {
        return Some("No hold-out run could be compared.".to_owned());
    }
    if gap.is_worse(answer.holdout()) {
        return None;
    }
    let runs = counted(found.held_out.len(), "hold-out run", "hold-out runs");
    let mps = |value| number(value, 2);
    let Some(removed) = gap.removed else {
        return Some(format!(
            "On {runs} there was no gap to remove: the simulated speed is off by {} m/s, and a perfect model would leave {}.",
            mps(gap.before),
            mps(gap.floor)
        ));
    };
    let them = if found.trained.len() == 1 { "it" } else { "them" };
    let whole = |share: f64| number(100.0 * share, 0);
    let interval = match gap.removed_95 {
        Some((low, high)) => {
            format!(" (95\u{a0}% interval {} to {})", whole(low), whole(high))
        }
        None => String::new(),
    };
    Some(format!(
        "With {them} in the model {}\u{a0}% of the removable gap is gone on {runs}{interval}: the simulated speed is off by {} m/s instead of {}, and a perfect model would leave {}.",
        whole(removed),
        mps(gap.after),
        mps(gap.before),
        mps(gap.floor)
    ))
}

/// One effect in a sentence or two.
fn of(answer: &Answer, named: &Named) -> String {
    let mut text = candidates::of_effect(&named.effect).sentence(named, &answer.context());
    text.push_str(&acting(named, &answer.input.runs));
    text.push_str(&format!(". Confidence in the name: {}", confidence(named)));
    let rivals: Vec<String> = named.rivals().map(plain).collect();
    if !rivals.is_empty() {
        text.push_str(&format!("; not distinguishable from {} by these data", rivals.join(" or ")));
        if !named.would_separate.is_empty() {
            text.push_str(&format!("; what would separate them: {}", named.would_separate.join(" or ")));
        }
    }
    text.push('.');
    text
}
