//! A study in words, and as JSON.

use super::Study;
use crate::study::claims::{self, Verdict, summary};
use crate::study::page::known;
use crate::study::slope as self_test;
use rundown_pages::numbers::counted;
use serde_json::json;

/// What `--json` prints.
pub(super) fn json_of(study: &Study) -> String {
    let claims: Vec<_> = claims::records(&study.claims).iter().map(rundown_files::table::to_json).collect();
    let json = json!({
        "runs": study.gathered.paper.runs,
        "runs_with_truth": study.gathered.truth.runs,
        "failed": study.gathered.failed.len(),
        "set_aside": study.gathered.set_aside,
        "diagnosis": study.gathered.checks,
        "gradient_sd_permille": study.gradient_sd_permille,
        "sets": summary::sets(&study.claims),
        "sets_needed": claims::Sets::needed(summary::sets(&study.claims)),
        "claims_by_kind": summary::counts(&study.claims),
        "claims": claims,
        "truth_slope": study.answers,
    });
    format!("{json:#}\n")
}

pub(super) fn table(study: &Study) -> String {
    let (runs, known) = (study.gathered.paper.runs, known(&study.gathered));
    let runs = counted(runs as usize, "run", "runs");
    let (kinds, basis) = (summary::by_kind(&study.claims), summary::basis(&study.claims));
    let elsewhere = summary::elsewhere(&study.claims);
    let mut text = format!("{runs}; {known}\nclaims that hold: {kinds}\n{elsewhere}{basis}\n\n");
    for claim in &study.claims {
        let mark = match claim.verdict {
            Verdict::Reproduced => "yes",
            Verdict::Not => "NO",
            Verdict::NotVisible => "tiny",
            Verdict::NoData => "-",
            Verdict::Elsewhere => "else",
        };
        let sets = match claim.sets.all {
            0 | 1 => String::new(),
            _ => format!(" ({} sets)", claim.sets.words()),
        };
        text += &format!("{:4} {:4} {:9} {}{sets}\n", claim.place, mark, claim.kind.as_str(), claim.statement);
        text += &format!(
            "          paper's mode: {}; gated: {}; truth: {}; error: {}\n",
            claim.paper, claim.gated, claim.truth, claim.error
        );
        if let (Verdict::NotVisible, Some(least)) = (claim.verdict, claim.least) {
            text += &format!("          not visible: below {}\n", least.reason);
        }
    }
    text += "\nDoes the estimate follow the truth? Simulated vehicles with 0.7 to 1.3 of the described resistance:\n";
    text += &self_test::table(&study.answers);
    text
}
