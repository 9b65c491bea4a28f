//! Claims as tables for documents: `claims.md` of a study, and of several readings beside each other.

use super::summary::{self, counts};
use super::{Claim, Sets};
use crate::output::markdown::{cells, table};
use rundown_pages::numbers::NOTHING;

/// The three under which the claims are compared.
pub const READINGS: [&str; 3] = ["backward", "forward", "skewed"];

/// All claims of a study.
pub fn one(claims: &[Claim]) -> String {
    let head = cells(["place", "claim", "kind", "verdict", "sets", "paper's mode", "gated mode", "truth", "error"]);
    let row = |claim: &Claim| {
        let Claim { place, statement, kind, verdict, paper, gated, truth, error, sets, .. } = claim;
        let mut row = cells([place, statement, kind.as_str(), verdict.as_str()]);
        row.extend([sets.words(), paper.clone(), gated.clone(), truth.clone(), error.clone()]);
        row
    };
    let rows: Vec<_> = claims.iter().map(row).collect();
    format!("{}\n\n{}", summary::basis(claims), table(&head, &rows))
}

/// The claims under several readings or recorders, each with its name: how many hold by kind, and in how many sets each does.
pub fn compared(all: &[(&str, Vec<Claim>)]) -> String {
    let Some((_, first)) = all.first() else {
        return String::new();
    };
    let basis = summary::basis(first);
    format!("{basis}\n\n{}\n{}", by_kind(all, first), by_claim(all, first))
}

fn by_kind(all: &[(&str, Vec<Claim>)], first: &[Claim]) -> String {
    let of_kind = counts(first).map(|count| format!("{}, of {}", count.kind, count.claims));
    let mut head = cells(["effort, recorder"]);
    head.extend(of_kind);
    head.extend([format!("all, of {}", first.len()), "not visible".to_owned()]);
    let row = |(name, claims): &(&str, Vec<Claim>)| {
        let counts = counts(claims);
        let sum = |of: fn(&summary::Count) -> usize| counts.iter().map(of).sum::<usize>().to_string();
        let mut row = cells([name]);
        row.extend(counts.map(|count| count.reproduced.to_string()));
        row.extend([sum(|count| count.reproduced), sum(|count| count.not_visible)]);
        row
    };
    table(&head, &all.iter().map(row).collect::<Vec<_>>())
}

fn by_claim(all: &[(&str, Vec<Claim>)], first: &[Claim]) -> String {
    let mut head = cells(["claim", "kind"]);
    head.extend(all.iter().map(|(name, _)| (*name).to_owned()));
    let row = |(index, claim): (usize, &Claim)| {
        let mut row = vec![format!("{}: {}", claim.place, claim.statement), claim.kind.as_str().to_owned()];
        row.extend(all.iter().map(|(_, claims)| claims.get(index).map_or(String::new(), |claim| held(&claim.sets))));
        row
    };
    table(&head, &first.iter().enumerate().map(row).collect::<Vec<_>>())
}

/// In how many sets it holds; in how many of how many where some have no data on it.
fn held(sets: &Sets) -> String {
    let of = match sets.judged {
        0 => return NOTHING.to_owned(),
        judged if judged == sets.all => sets.held.to_string(),
        judged => format!("{} of {judged}", sets.held),
    };
    match sets.not_visible {
        0 => of,
        tiny => format!("{of} ({tiny} not visible)"),
    }
}

#[cfg(test)]
mod tests {
    use super::super::claims;
    use super::*;
    use crate::output::markdown::{found, page};
    use crate::study::{case::case_study, description, gather::Gathered, trials::Trials};

    /// The rows of the document are rows of ours by their first cells, under the same heading.
    fn is_quoted(ours: &str, begins: &str, labels: usize) {
        let (ours, theirs) = (found(ours, begins), found(&page("paper.md"), begins));
        assert!(theirs.len() > 2, "docs/paper.md has no table {begins}");
        assert!(theirs[0].starts_with(&ours[0]), "docs/paper.md: {:?} for {:?}", theirs[0], ours[0]);
        for row in &theirs[1..] {
            let is_ours = ours[1..].iter().any(|of_ours| of_ours[..labels] == row[..labels]);
            assert!(is_ours, "docs/paper.md: no row of claims.md is {:?}", &row[..labels]);
        }
    }

    #[test]
    fn the_tables_of_the_document_have_the_rows_that_are_written() {
        let train = description::of(&case_study().unwrap()).unwrap().train;
        let none = || claims(&Gathered::default(), &train, &Trials::default());
        let ours = compared(&READINGS.map(|name| (name, none())));
        is_quoted(&ours, "| effort, recorder |", 1);
        is_quoted(&ours, "| claim |", 2);
    }
}
