//! The verdict in sentences: what, where, how large, how sure, and what it cannot be told from.

use super::Page;
use super::values::{confidence, short, told, unit};
use crate::named::Named;
use crate::notes::{SIGNIFICANT, worse};
use rundown::model::effects::{Coordinate, Effect};
use rundown_pages::numbers::{counted, number};

/// A name as it is read.
pub(super) fn plain(name: &str) -> String {
    name.replace('_', " ")
}

/// `a`, `a or b`.
fn any(names: &[&'static str]) -> String {
    names.iter().map(|n| plain(n)).collect::<Vec<_>>().join(" or ")
}

/// The sentences at the top of the page.
pub(super) fn verdict(page: &Page<'_>) -> Vec<String> {
    let found = page.found;
    let all = counted(page.runs.len(), "run", "runs");
    let mut notes = page.answer.notes();
    // What could not be judged at all comes before what was found.
    let (mut sentences, judged) = match found.findings.rows.is_empty() {
        true => (vec![notes.remove(0)], false),
        false => (Vec::new(), true),
    };
    let chance = match found.p_value {
        p if p <= 0.0011 => "at most one time in a thousand".to_owned(),
        p => format!("with probability {}", number(p, 3)),
    };
    let significant = judged && found.p_value < SIGNIFICANT;
    if found.named.is_empty() {
        sentences.push(match (judged, significant) {
            (false, _) => format!("In what could be looked at, nothing was found in {all}."),
            (true, true) => format!("No effect of the catalogue was found in {all}."),
            (true, false) => format!(
                "No gap: what the model does not explain in {all} is what these sensors leave (such residuals, or larger ones, come about by chance {chance})."
            ),
        });
    } else {
        sentences.extend(found.named.iter().map(|one| of(page, one)));
        sentences.extend(held_out(page));
        if significant {
            let left = match found.p_value_after {
                p if p >= SIGNIFICANT => format!(
                    "; what is left with the effects in the model is such as chance leaves (p = {})",
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

/// What the effects bring on runs that took no part; where they bring harm, a note tells.
fn held_out(page: &Page<'_>) -> Option<String> {
    let (found, gap) = (page.found, &page.found.gap);
    if found.compared.is_empty() {
        return Some("No held-out run could be compared.".to_owned());
    }
    if worse(gap) {
        return None;
    }
    let runs = counted(found.held_out.len(), "held-out run", "held-out runs");
    let mps = |value| number(value, 2);
    if !gap.is_removable() {
        return Some(format!(
            "On {runs} there was no gap to remove: the simulated speed is off by {} m/s, and a perfect model would leave {}.",
            mps(gap.before_mps),
            mps(gap.floor_mps)
        ));
    }
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
        whole(gap.removed_share),
        mps(gap.after_mps),
        mps(gap.before_mps),
        mps(gap.floor_mps)
    ))
}

/// One effect in a sentence or two.
fn of(page: &Page<'_>, named: &Named) -> String {
    let mut text = what(page, named);
    if !named.runs.is_empty() {
        text.push_str(&format!(", in {} of {} runs", named.runs.len(), page.runs.len()));
    }
    text.push_str(&format!(". Confidence in the name: {}", confidence(named)));
    if !named.ambiguous_with.is_empty() {
        text.push_str(&format!("; these data cannot tell it from {}", any(&named.ambiguous_with)));
        if !named.would_separate.is_empty() {
            text.push_str(&format!(", {} would", named.would_separate.join(" or ")));
        }
    }
    text.push('.');
    text
}

/// `km 18.2 to 21.0`.
pub(super) fn place(from_m: f64, to_m: f64) -> String {
    let km = |m: f64| number(m / 1000.0, 1);
    format!("km {} to {}", km(from_m), km(to_m))
}

fn side(more: bool) -> &'static str {
    if more { "more" } else { "less" }
}

fn what(page: &Page<'_>, named: &Named) -> String {
    let value = |parameter: &str, value: f64, factor: f64, unit: &str| told(named, parameter, value, factor, unit);
    let davis = page.believed.train().davis();
    let at_100 = davis.resistance_n_per_kg(100.0 / 3.6);
    match &named.effect {
        Effect::TunnelDrag(e) => format!(
            "Tunnel drag from {}: there the air resistance grows by k v\u{b2}, k = {}, which is {}\u{a0}% of the believed r2",
            place(e.from_m, e.to_m),
            value("k", e.k, 1.0, "N/(kg (m/s)\u{b2})"),
            number(100.0 * e.k / davis.r2, 0)
        ),
        Effect::CurveResistance(e) => format!(
            "The curves of the track add resistance: R\u{f6}ckl's formula times {}",
            value("coefficient_roeckl", e.coefficient_roeckl, 1.0, "")
        ),
        Effect::GradientError(e) => format!(
            "The gradient is described wrongly from {}: going up the line it climbs {} by {}",
            place(e.from_m, e.to_m),
            side(e.delta_permille > 0.0),
            value("delta_permille", e.delta_permille, e.delta_permille.signum(), "\u{2030}")
        ),
        Effect::SteadyWind(e) => format!(
            "A steady wind blows {} the line, in every run: {}",
            if e.wind_mps > 0.0 { "down" } else { "up" },
            value("wind_mps", e.wind_mps, e.wind_mps.signum(), "m/s")
        ),
        Effect::RunWind(e) => format!(
            "A wind that differs from run to run, with a standard deviation of {}",
            value("sd_mps", e.sd_mps, 1.0, "m/s")
        ),
        Effect::MassError(e) => format!(
            "The train is {} than described, by {}",
            if e.relative > 0.0 { "heavier" } else { "lighter" },
            value("relative", e.relative, 100.0 * e.relative.signum(), "%")
        ),
        Effect::DraggingBrake(e) => format!(
            "A brake drags after an application: {} of extra resistance",
            value("drag_n_per_kg", e.drag_n_per_kg, 1.0, "N/kg")
        ),
        Effect::PowerLimitSection(e) => format!(
            "Traction power is capped from {}, at {} of what is described",
            place(e.from_m, e.to_m),
            value("factor", e.factor, 100.0, "%")
        ),
        Effect::TractionScale(e) => format!(
            "Largest effort and power are everywhere {} of what is described",
            value("factor", e.factor, 100.0, "%")
        ),
        Effect::LowAdhesion(e) => format!(
            "Low adhesion: below {} the effort reaches {} of the described one",
            value("below_kmh", e.below_kmh, 1.0, "km/h"),
            value("factor", e.factor, 100.0, "%")
        ),
        Effect::SpeedScale(e) => format!(
            "The speed is read on a wrong scale: measured over true speed is {}",
            value("measured_over_true", e.measured_over_true, 1.0, "")
        ),
        Effect::LocationLag(e) => format!(
            "The location comes {}, by {}",
            if e.lag_s > 0.0 { "late" } else { "early" },
            value("lag_s", e.lag_s, e.lag_s.signum(), "s")
        ),
        Effect::TemperatureResistance(e) => format!(
            "The constant resistance r0 depends on the temperature: {} for each degree, as described at {} \u{b0}C",
            value("dr0_per_degC", e.dr0_per_deg_c, 1.0, "N/kg"),
            number(e.ref_c, 0)
        ),
        Effect::SeasonalDrift(e) => format!(
            "The constant resistance r0 drifts over the dates of the runs, by {} from the first to the last",
            value("dr0_over_period", e.dr0_over_period, 1.0, "N/kg")
        ),
        Effect::BrakeFade(e) => format!(
            "The brake weakens above {} km/h: at 140 km/h it lacks {} of its effort",
            number(e.from_kmh, 0),
            value("fade_at_140", e.fade_at_140, 100.0, "%")
        ),
        Effect::TrainLengthError(e) => format!(
            "The train is not as long as described: {} instead of {} m",
            value("true_length_m", e.true_length_m, 1.0, "m"),
            number(page.found.findings.length_m, 0)
        ),
        Effect::WarmUp(e) => format!(
            "A cold train runs heavier: {} more at the departure, 37\u{a0}% of it left after {} min",
            value("amplitude", e.amplitude, 1.0, "N/kg"),
            number(e.tau_s / 60.0, 1)
        ),
        Effect::StartingResistance(e) => format!(
            "After standing the train is hard to start: {} more, 37\u{a0}% of it left at {}",
            value("amplitude", e.amplitude, 1.0, "N/kg"),
            value("decay_kmh", e.decay_kmh, 1.0, "km/h")
        ),
        Effect::DavisError(e) => {
            let extra = e.dr0 + e.dr1 * 100.0 / 3.6 + e.dr2 * (100.0_f64 / 3.6).powi(2);
            let coefficients = [("dr0", "r0", e.dr0), ("dr1", "r1", e.dr1), ("dr2", "r2", e.dr2)];
            let wrong = coefficients.iter().filter(|(.., v)| *v != 0.0);
            let parts = wrong.map(|(name, letter, v)| format!("{letter} by {}", value(name, *v, 1.0, unit(name))));
            format!(
                "The described Davis coefficients are wrong: at 100 km/h the train meets {}\u{a0}% {} running resistance than described ({})",
                number(100.0 * extra.abs() / at_100, 1),
                side(extra > 0.0),
                parts.collect::<Vec<_>>().join(", ")
            )
        }
        Effect::Unknown(e) => unknown(e, page.found.findings.first_day),
    }
}

fn unknown(effect: &rundown::model::effects::Unknown, first_day: f64) -> String {
    let origin = match effect.coordinate {
        Coordinate::Day => first_day,
        _ => 0.0,
    };
    let (along, unit, factor) = match effect.coordinate {
        Coordinate::Location => ("location", "km", 1e-3),
        Coordinate::Speed => ("speed", "km/h", 3.6),
        Coordinate::Time => ("time since departure", "min", 1.0 / 60.0),
        Coordinate::Temperature => ("temperature", "\u{b0}C", 1.0),
        Coordinate::Day => ("date", "days after the first run", 1.0),
    };
    let points = || effect.table.iter().map(|(at, n)| (f64::from(*at), f64::from(*n)));
    let largest = points().max_by(|a, b| a.1.abs().total_cmp(&b.1.abs()));
    let (at, extra) = largest.unwrap_or((f64::NAN, f64::NAN));
    // A constant within a section is a table that is zero at both ends.
    let acting: Vec<f64> = points().filter(|(_, n)| *n != 0.0).map(|(at, _)| at).collect();
    let place = match (acting.as_slice(), effect.coordinate) {
        ([from, .., to], Coordinate::Location) if acting.len() == 2 => {
            format!("from {}", place(*from, *to))
        }
        _ => format!("most at {} {unit}", number((at - origin) * factor, 1)),
    };
    format!(
        "Something that no named effect explains adds resistance that depends on the {}: {} N/kg {place}",
        along,
        short(extra)
    )
}
