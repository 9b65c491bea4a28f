//! `experiments.md`: the table of each experiment, from which docs/after-the-paper.md has its figures.

use super::answer::Answer;
use crate::output::markdown::table;

/// A heading, a table and what is said besides, for each.
pub fn markdown(answers: &[Answer]) -> String {
    let section = |answer: &Answer| {
        let names = answer.columns.iter().map(|(name, _)| (*name).to_owned());
        let head: Vec<String> = ["variant".to_owned(), "mode".to_owned()].into_iter().chain(names).collect();
        let row =
            |row: super::answer::TableRow<'_>| [vec![row.variant.to_owned(), row.arm.to_owned()], row.cells].concat();
        let rows: Vec<Vec<String>> = answer.table().into_iter().map(row).collect();
        let notes: String = answer.notes.iter().map(|note| format!("\n{note}\n")).collect();
        format!("## {}\n\n{}\n\n{}{notes}", answer.name, answer.question, table(&head, &rows))
    };
    answers.iter().map(section).collect::<Vec<_>>().join("\n")
}

#[cfg(test)]
mod tests {
    use crate::output::markdown::{measured, page};
    use crate::study::experiments::catalogue;

    /// Figures of the document that no table has: bounds, lengths of hops, and differences of two cells.
    const NOT_MEASURED: [(&str, &str); 4] =
        [("regime-feedback", "0.025"), ("trains", "1200"), ("diesel", "0.6"), ("drivers", "0.03")];

    /// A figure with as many decimals as are printed.
    struct Figure {
        value: f64,
        half: f64,
    }

    impl Figure {
        fn of(text: &str) -> Option<Self> {
            let value = text.parse().ok()?;
            let decimals = text.split_once('.').map_or(0, |(_, decimals)| decimals.len());
            Some(Self { value, half: 0.5 * 0.1_f64.powi(decimals as i32) })
        }

        /// Whether both may be one value, each rounded.
        fn is(&self, other: &Self) -> bool {
            (self.value - other.value).abs() <= self.half.max(other.half) * (1.0 + 1e-9)
        }
    }

    /// Words as they stand, without the marks around them.
    fn words(text: &str) -> Vec<&str> {
        let mark = |c: char| "|(),;:`%‰".contains(c);
        text.split_whitespace().map(|word| word.trim_matches(mark).trim_end_matches('.')).collect()
    }

    /// `a ± b`, and figures with decimals or from 1000 on that stand alone; the first of each is what it looks like.
    fn figures(text: &str) -> Vec<(String, Figure, Option<Figure>)> {
        let words = words(text);
        let mut found = Vec::new();
        for (index, word) in words.iter().enumerate() {
            let after = |sign: &str| index > 0 && words[index - 1] == sign;
            let Some(figure) = Figure::of(word).filter(|_| !after("±") && !after("section") && !after("sections"))
            else {
                continue;
            };
            let is_spread = words.get(index + 1) == Some(&"±");
            let spread = words.get(index + 2).filter(|_| is_spread).and_then(|sd| Figure::of(sd));
            // A whole number may be a count, but for kW.
            if is_spread || word.contains('.') || figure.value >= 1000.0 {
                found.push(((*word).to_owned(), figure, spread));
            }
        }
        found
    }

    fn section<'a>(text: &'a str, marks: &str) -> &'a str {
        let begin = text.find(marks).unwrap_or_else(|| panic!("no section {marks}"));
        let rest = &text[begin..];
        rest.find("\n## ").map_or(rest, |end| &rest[..end])
    }

    /// Each figure of the document is among those of its experiment's table, variants included; in which row is not
    /// asked.
    #[test]
    fn the_figures_of_the_document_are_those_that_were_measured() {
        let (document, measured) = (page("after-the-paper.md"), measured("experiments.md"));
        let mut wrong = Vec::new();
        for experiment in &catalogue::ALL {
            let name = experiment.name;
            let theirs = figures(section(&document, &format!("\n`{name}`.")));
            let ours = figures(section(&measured, &format!("## {name}\n")));
            assert!(!theirs.is_empty(), "{name}");
            for (word, figure, spread) in &theirs {
                let is_known = ours.iter().any(|(_, value, sd)| {
                    figure.is(value) && spread.as_ref().is_none_or(|spread| sd.as_ref().is_some_and(|sd| spread.is(sd)))
                });
                if is_known == NOT_MEASURED.contains(&(name, word.as_str())) {
                    wrong.push(format!("{name}: {word}"));
                }
            }
        }
        assert!(wrong.is_empty(), "not as measured: {wrong:?}");
    }
}
