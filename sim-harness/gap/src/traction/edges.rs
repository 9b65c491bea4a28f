//! Where the edges of a section may lie.

use crate::config::TractionConfig;
use crate::fit::LOSS_AT_LIMIT;

/// Where the edges of a section may lie.
pub struct Edges {
    pub likely_m: [f64; 2],
    pub limits_m: [(f64, f64); 2],
}

/// Moves each edge from phase to phase until the log-likelihood has lost what a 95 % limit allows. `powered_m`:
/// locations of the phases, rising.
///
/// Where trains power on both sides the edge lies half-way between the last phase that is limited and the first that is
/// not. Where they do not, the section is taken to end soon after the last one that is.
pub fn edges(
    powered_m: &[f64],
    best_m: [f64; 2],
    most: f64,
    gain: impl Fn([f64; 2]) -> f64,
    config: &TractionConfig,
) -> Edges {
    let TractionConfig { same_loss, step_m, soon_m, .. } = *config;
    let reach = |edge: usize, outwards: bool, loss: f64| {
        let up = (edge == 1) == outwards;
        let mut reached = best_m[edge];
        let beyond = |at: f64, last: f64| if up { at > last } else { at < last };
        let mut tried = reached;
        let ahead: Vec<f64> = if up { powered_m.to_vec() } else { powered_m.iter().rev().copied().collect() };
        for at in ahead.into_iter().filter(|at| beyond(*at, best_m[edge])) {
            if (at - tried).abs() < step_m {
                continue;
            }
            // Just past the phase: it has changed sides.
            tried = if up { at + 1.0 } else { at - 1.0 };
            let mut moved = best_m;
            moved[edge] = tried;
            if moved[0] >= moved[1] || gain(moved) < most - loss {
                // Up to this phase nothing was lost.
                return at;
            }
            reached = tried;
        }
        match (outwards, up) {
            (true, true) => f64::INFINITY,
            (true, false) => f64::NEG_INFINITY,
            (false, _) => reached,
        }
    };
    let edge = |edge: usize| {
        let [inner, outer] = [false, true].map(|outwards| reach(edge, outwards, same_loss));
        let half = (0.5 * (outer - inner)).clamp(-soon_m, soon_m);
        let limits = [false, true].map(|outwards| reach(edge, outwards, LOSS_AT_LIMIT));
        (inner + half, (limits[0].min(limits[1]) - step_m, limits[0].max(limits[1]) + step_m))
    };
    let (from, to) = (edge(0), edge(1));
    Edges { likely_m: [from.0, to.0], limits_m: [from.1, to.1] }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Trains power every 100 m from 1 to 4 km; the section begins at 2 km, and at `to_m` it ends.
    fn found(to_m: f64) -> Edges {
        let powered_m: Vec<f64> = (10..=40).map(|i| 100.0 * f64::from(i)).collect();
        let wrong = |[from, end]: [f64; 2]| {
            let at = |section: (f64, f64), at: f64| section.0 <= at && at < section.1;
            let differs = |p: &&f64| at((from, end), **p) != at((2_000.0, to_m), **p);
            powered_m.iter().filter(differs).count() as f64
        };
        edges(
            &powered_m,
            [1_990.0, to_m.min(4_050.0)],
            0.0,
            |section| -10.0 * wrong(section),
            &TractionConfig::default(),
        )
    }

    #[test]
    fn an_edge_lies_between_the_phases_that_tell() {
        let found = found(3_000.0);
        assert!((found.likely_m[0] - 1_950.0).abs() < 60.0);
        assert!((found.likely_m[1] - 2_950.0).abs() < 60.0);
        assert!(found.limits_m[0].0 <= 2_000.0 && found.limits_m[0].1 >= 1_900.0);
        assert!(found.limits_m[1].1 - found.limits_m[1].0 < 400.0);
    }

    #[test]
    fn where_no_train_phases_a_section_ends_soon_after_the_last_phase() {
        let found = found(9_000.0);
        assert!((4_000.0..=4_600.0).contains(&found.likely_m[1]));
        assert_eq!(found.limits_m[1].1, f64::INFINITY);
    }
}
