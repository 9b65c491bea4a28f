//! Claims as tables for documents: `claims.md` of a study, and of several readings beside each other.

use super::summary::{self, counts};
use super::{Claim, Sets};
use crate::output::markdown::{cells, table};
use rundown_pages::numbers::NOTHING;

/// Those under which the claims are compared. The last: regimes and features are of readings that were put right, the
/// paper's loop has those of the skewed recorder.
pub const READINGS: [&str; 4] = ["backward", "forward", "skewed", "skewed, put right"];

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

/// The claims under several readings or recorders, each with its name: how many hold by kind, and in how many sets each
/// does.
pub fn compared(all: &[(&str, Vec<Claim>)]) -> String {
    let Some((_, first)) = all.first() else {
        return String::new();
    };
    let basis = summary::basis(first);
    format!("{basis}\n\n{}\n{}", by_kind(all, first), by_claim(all, first))
}

fn by_kind(all: &[(&str, Vec<Claim>)], first: &[Claim]) -> String {
    let of_kind = counts(first).into_iter().map(|count| format!("{}, of {}", count.kind, count.claims));
    let mut head = cells(["effort, recorder"]);
    head.extend(of_kind);
    head.extend([format!("all, of {}", first.len()), "not visible".to_owned()]);
    let row = |(name, claims): &(&str, Vec<Claim>)| {
        let counts = counts(claims);
        let sum = |of: fn(&summary::ClaimCount) -> usize| counts.iter().map(of).sum::<usize>().to_string();
        let mut row = cells([name]);
        row.extend(counts.iter().map(|count| count.reproduced.to_string()));
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
    use crate::output::markdown::{found, measured, page};
    use crate::study::{case::case_study, description, gather::Gathered, trials::Trials};

    /// Both tables of the document have the values that were measured; of the claims those that hold in fewer than 18
    /// of 20 sets with one of the readings, each of them, and why.
    #[test]
    fn the_tables_of_the_document_are_those_that_were_measured() {
        let (document, measured) = (page("paper.md"), measured("claims.md"));
        let by_kind = |text: &str| found(text, "| effort, recorder |");
        assert_eq!(by_kind(&document), by_kind(&measured));
        let (theirs, ours) = (found(&document, "| claim |"), found(&measured, "| claim |"));
        let sets = |cell: &str| cell.split(' ').next().and_then(|held| held.parse::<usize>().ok()).unwrap_or(0);
        let fails = |row: &&Vec<String>| row[2..].iter().any(|cell| sets(cell) < Sets::needed(20));
        let quoted: Vec<&[String]> = theirs[1..].iter().map(|row| &row[..row.len() - 1]).collect();
        assert_eq!(quoted, ours[1..].iter().filter(fails).map(Vec::as_slice).collect::<Vec<_>>());
        assert!(theirs[1..].iter().all(|row| row.last().is_some_and(|why| why.len() > 2)), "each says why");
    }

    /// What the document says in words of the same counts.
    #[test]
    fn the_words_of_the_document_are_those_of_its_tables() {
        let (document, table) = (page("paper.md"), found(&measured("claims.md"), "| effort, recorder |"));
        let words = document.split_whitespace().collect::<Vec<_>>().join(" ");
        let of = |name: &str| table.iter().find(|row| row[0] == name).unwrap_or_else(|| panic!("{name}"));
        let (default, best) = (of("forward"), of("skewed, put right"));
        for sentence in [
            format!(
                "By the default {} of the 50 hold, and of the 18 that could have failed {}.",
                default[4], default[3]
            ),
            format!("With the skewed recorder and its readings put right for the features {} of the 50 hold", best[4]),
        ] {
            assert!(words.contains(&sentence), "{sentence}");
        }
    }

    /// The measured tables are of the claims and readings that there are now.
    #[test]
    fn what_was_measured_has_the_claims_that_are_judged() {
        let train = description::of(&case_study().unwrap()).unwrap().train;
        let none = || claims(&Gathered::default(), &train, &Trials::default());
        let ours = compared(&READINGS.map(|name| (name, none())));
        let measured = measured("claims.md");
        for (begins, labels) in [("| effort, recorder |", 1), ("| claim |", 2)] {
            let [now, then] = [ours.as_str(), measured.as_str()].map(|text| found(text, begins));
            assert_eq!(now[0], then[0]);
            let labels = |rows: &[Vec<String>]| rows.iter().map(|row| row[..labels].to_vec()).collect::<Vec<_>>();
            assert_eq!(labels(&now), labels(&then));
        }
    }
}
