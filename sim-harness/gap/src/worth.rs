//! What a term must be worth: what its freedom costs, and how large it must be to matter to a train.

use super::rows::Row;
use super::terms::{Context, Coordinate, Term};
use rundown::model::resistance::Davis;

/// Cost of a free coefficient: half the logarithm of about 67 runs.
const COEFFICIENT: f64 = 2.1;
/// Cost of the freedom to choose a section, or a time constant.
const SECTION: f64 = 5.0;
const SHAPE: f64 = 1.5;
/// What another length must be better by: locations that are off by some metres look like it.
const SHIFT: f64 = 4.0;
/// What an unnamed smooth function must be better by than a named effect.
const UNNAMED: f64 = 4.0;
/// Largest extra resistance over the believed one.
const MOST_SHARE: f64 = 1.5;

/// Whether a term is large enough to matter to a train: what is smaller is left to the Davis coefficients' uncertainty and to sensors.
pub fn matters(term: &Term, beta: &[f64], context: &Context<'_>, rows: &[Row]) -> bool {
    /// A resistance below this is no finding, N/kg: 1 % of a train's at 100 km/h.
    const LEAST_N_PER_KG: f64 = 3e-4;
    /// A table without a name takes the faults of all that is named with it, so it must be more.
    const LEAST_UNNAMED_N_PER_KG: f64 = 6e-4;
    /// The same in a section of the line: 0.2 permille.
    const LEAST_IN_SECTION_N_PER_KG: f64 = 2e-3;
    /// A brake that drags by less is no finding: winds and loads of single runs do that.
    const LEAST_DRAG_N_PER_KG: f64 = 1.5e-3;
    /// A load of a few passengers is no finding.
    const LEAST_MASS: f64 = 0.008;
    /// No description is further off. Without an effort column it would be the air drag of another train.
    const MOST_MASS: f64 = 0.4;
    /// A gauge of the effort is off by about so much; what is more is another mass.
    const LEAST_GAUGE: f64 = 0.003;
    const MOST_GAUGE: f64 = 0.03;
    /// What stiff bearings add at most, N/kg. More is a law of something else, carried back to the departure.
    const MOST_WARM_UP_N_PER_KG: f64 = 0.03;
    // In rising order.
    let sizes = || {
        let extra = term.extra(beta, context, rows).into_iter();
        let mut sizes: Vec<f64> = extra.map(f64::abs).collect();
        sizes.sort_by(f64::total_cmp);
        sizes
    };
    let most = || sizes().last().copied().unwrap_or(0.0);
    // What acts always must be seen in more than the few slowest or fastest rows.
    let often = || sizes().get(rows.len() * 4 / 5).copied().unwrap_or(0.0);
    // More than the train's whole resistance is no finding either: too few rows for so many coefficients.
    let davis = context.believed.train().davis();
    let absurd = || {
        let extra = term.extra(beta, context, rows);
        rows.iter().zip(extra).any(|(row, extra)| {
            extra.abs() > MOST_SHARE * davis.resistance_n_per_kg(row.interval.mean_speed_mps()) + 0.01
        })
    };
    if !matches!(
        term,
        Term::Tunnel(_) | Term::Gradient(_) | Term::Bump(_) | Term::Mass | Term::Gauge | Term::BrakeFade(_)
    ) && absurd()
    {
        return false;
    }
    match term {
        Term::Mass => (LEAST_MASS..MOST_MASS).contains(&beta[0].abs()),
        Term::Gauge => (LEAST_GAUGE..MOST_GAUGE).contains(&beta[0].abs()),
        Term::BrakeFade(_) => beta[0] > 0.04,
        Term::Length(_) => true,
        Term::Tunnel(_) => beta[0] > 0.0 && most() > LEAST_IN_SECTION_N_PER_KG,
        Term::Gradient(_) | Term::Bump(_) => most() > LEAST_IN_SECTION_N_PER_KG,
        Term::Curve => beta[0] > 0.0 && most() > LEAST_N_PER_KG,
        Term::DraggingBrake(_) => beta[0] > LEAST_DRAG_N_PER_KG,
        // The largest value belongs to the first rows alone.
        Term::WarmUp(_) => (0.0..MOST_WARM_UP_N_PER_KG).contains(&beta[0]) && most() > 2.0 * LEAST_N_PER_KG,
        Term::Davis(wrong) => often() > LEAST_N_PER_KG && possible(*wrong, beta, &davis),
        Term::Cube | Term::Wind(_) => often() > LEAST_N_PER_KG,
        Term::Smooth(..) | Term::Step(..) => most() > LEAST_UNNAMED_N_PER_KG,
        _ => most() > LEAST_N_PER_KG,
    }
}

/// No coefficient of the train would be negative.
fn possible(wrong: [bool; 3], beta: &[f64], described: &Davis) -> bool {
    let mut beta = beta.iter();
    let described = [described.r0, described.r1, described.r2];
    described.into_iter().zip(wrong).all(|(described, wrong)| {
        let change = if wrong { beta.next() } else { None };
        described + change.copied().unwrap_or(0.0) >= 0.0
    })
}

/// What a section must be better by only because it has no name: it fits as well as one with a name that is better by no more.
pub fn unnamed(term: &Term) -> f64 {
    match term {
        Term::Bump(_) => UNNAMED,
        _ => 0.0,
    }
}

/// Cost of a term's freedom.
pub fn cost(term: &Term, rows: &[Row]) -> f64 {
    match term {
        Term::Davis(wrong) => wrong.iter().filter(|w| **w).count() as f64 * COEFFICIENT,
        Term::Tunnel(_) | Term::Gradient(_) => COEFFICIENT + SECTION,
        Term::Bump(_) => COEFFICIENT + SECTION + unnamed(term),
        // One law instead of three coefficients: a little dearer than one of them.
        Term::Cube => COEFFICIENT + 1.0,
        Term::Delay | Term::Late => 0.0,
        Term::Curve | Term::Wind(_) | Term::Mass | Term::Gauge | Term::Season => COEFFICIENT,
        Term::Length(_) => COEFFICIENT + SHAPE + SHIFT,
        Term::Temperature => 2.0 * COEFFICIENT,
        Term::WarmUp(_) | Term::BrakeFade(_) => COEFFICIENT + SHAPE,
        Term::DraggingBrake(runs) => {
            COEFFICIENT + choice_cost(runs.len(), rows.last().map_or(1, |r| r.interval.run + 1))
        }
        Term::Step(..) => COEFFICIENT + SECTION + UNNAMED,
        Term::Smooth(_, knots) => knots.len() as f64 * COEFFICIENT + UNNAMED,
    }
}

/// Log of the number of ways to choose `chosen` of `all` runs, about.
pub fn choice_cost(chosen: usize, all: usize) -> f64 {
    let p = (chosen as f64 / all as f64).clamp(1e-9, 1.0 - 1e-9);
    -(all as f64) * (p * p.ln() + (1.0 - p) * (1.0 - p).ln()) + 0.5 * (all as f64).ln()
}

/// The same all through a run, another in each.
pub fn between_runs(term: &Term) -> bool {
    matches!(
        term,
        Term::Season
            | Term::Temperature
            | Term::DraggingBrake(_)
            | Term::Step(..)
            | Term::Smooth(Coordinate::Day | Coordinate::Temperature, _)
    )
}

/// It acts in a section of the line.
pub fn is_section(term: &Term) -> bool {
    matches!(term, Term::Tunnel(_) | Term::Gradient(_) | Term::Bump(_))
}
