//! Tables as Markdown: what documents quote.

/// A table with these headings; a row has as many cells.
pub fn table(head: &[String], rows: &[Vec<String>]) -> String {
    let line = |cells: &[String]| {
        let cells: Vec<String> = cells.iter().map(|cell| cell.replace('|', "\\|")).collect();
        format!("| {} |\n", cells.join(" | "))
    };
    let rule = format!("|{}\n", "---|".repeat(head.len()));
    line(head) + &rule + &rows.iter().map(|row| line(row)).collect::<String>()
}

/// Words as the cells of a table.
pub fn cells<const N: usize>(words: [&str; N]) -> Vec<String> {
    words.map(str::to_owned).to_vec()
}

/// A page of `docs/`. Read when the test runs, so that a document can be corrected without a build.
#[cfg(test)]
pub fn page(name: &str) -> String {
    read(&format!("docs/{name}"))
}

/// A file of `data/golden/paper`, as `rundown study --all --seeds 20` wrote it.
#[cfg(test)]
pub fn measured(name: &str) -> String {
    read(&format!("data/golden/paper/{name}"))
}

#[cfg(test)]
fn read(path: &str) -> String {
    let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("..").join(path);
    std::fs::read_to_string(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

/// A table of a document, whose heading row begins so: its rows as cells, the heading first. Empty where there is none.
#[cfg(test)]
pub fn found(document: &str, begins: &str) -> Vec<Vec<String>> {
    let lines = document.lines().skip_while(|line| !line.starts_with(begins)).take_while(|line| line.starts_with('|'));
    let of_line = |line: &str| line.trim_matches('|').split('|').map(|cell| cell.trim().to_owned()).collect();
    lines.filter(|line| !line.starts_with("|---")).map(of_line).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_table_is_found_again_in_a_document() {
        let text = table(&cells(["a", "b"]), &[cells(["1", "x"]), cells(["2", "y"])]);
        let document = format!("# T\n\nwords\n\n{text}\nmore words\n");
        assert_eq!(found(&document, "| a |"), [["a", "b"], ["1", "x"], ["2", "y"]]);
        assert!(found(&document, "| c |").is_empty());
    }
}
