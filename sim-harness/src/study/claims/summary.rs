//! How many claims hold, by kind: what the screen, the report and the JSON say first.

use super::{Claim, ClaimKind, Sets, Verdict};
use rundown_pages::numbers::counted;
use serde::Serialize;

/// Claims of a kind.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub struct ClaimCount {
    pub kind: &'static str,
    pub claims: usize,
    pub reproduced: usize,
    pub not_reproduced: usize,
    pub not_visible: usize,
    pub no_data: usize,
    pub not_judged: usize,
}

/// Over all sets of runs; of the kinds that there are.
pub fn counts(claims: &[Claim]) -> Vec<ClaimCount> {
    let count = |kind: ClaimKind| {
        let of = |verdict| claims.iter().filter(|c| c.kind == kind && c.verdict == verdict).count();
        ClaimCount {
            kind: kind.as_str(),
            claims: claims.iter().filter(|claim| claim.kind == kind).count(),
            reproduced: of(Verdict::Reproduced),
            not_reproduced: of(Verdict::Not),
            not_visible: of(Verdict::NotVisible),
            no_data: of(Verdict::NoData),
            not_judged: of(Verdict::Elsewhere),
        }
    };
    ClaimKind::ALL.into_iter().map(count).filter(|count| count.claims > 0).collect()
}

/// `input 7 of 9, recovered 9 of 16, predicted 10 of 18`: of those that are judged.
pub fn by_kind(claims: &[Claim]) -> String {
    let judged = |count: &ClaimCount| count.claims - count.not_judged;
    let some = counts(claims).into_iter().filter(|count| judged(count) > 0);
    let words: Vec<_> =
        some.map(|count| format!("{} {} of {}", count.kind, count.reproduced, judged(&count))).collect();
    words.join(", ")
}

/// How many claims are of the paper's own line, where these runs are of another; a sentence and a space, or nothing.
pub fn elsewhere(claims: &[Claim]) -> String {
    match claims.iter().filter(|claim| claim.verdict == Verdict::Elsewhere).count() {
        0 => String::new(),
        count => format!(
            "Of all {} claims {count} are not judged: they have numbers of the paper's own line, train or drivers, and these runs are others. ",
            claims.len()
        ),
    }
}

/// On how many sets the verdicts rest; a sentence.
pub fn basis(claims: &[Claim]) -> String {
    match sets(claims) {
        0 | 1 => "Judged on one set of runs alone: another set may say otherwise.".to_owned(),
        all => format!(
            "Judged on {}: a claim holds where it does in {} of them or more; values are those of the first set.",
            counted(all, "set of runs", "sets of runs"),
            Sets::needed(all)
        ),
    }
}

/// Sets of runs that were judged.
pub fn sets(claims: &[Claim]) -> usize {
    claims.first().map_or(0, |claim| claim.sets.all)
}
