//! Every kind of effect has all that belongs to it: its files and what its numbers mean.

use rundown_wire::EffectKind;
use std::path::Path;

/// Beside the line of the catalogue, what a kind needs: what it is, the folder, and whether the kind of the table has it too.
const FILES: [(&str, &str, bool); 2] =
    [("the estimator's law", "src/model/effects", true), ("the truth's law", "sim-harness/truth/src/effects", false)];

#[test]
fn every_kind_has_its_files_and_its_meaning() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let mut missing = Vec::new();
    for kind in EffectKind::ALL {
        for (what, folder, of_table) in FILES {
            let file = format!("{folder}/{kind}.rs");
            if (of_table || kind != EffectKind::Unknown) && !root.join(&file).is_file() {
                missing.push(format!("{kind}: expected {what} in {file}, found no file"));
            }
        }
        if kind.parameters().is_empty() || kind.parameters().iter().any(|parameter| parameter.meaning.is_empty()) {
            missing.push(format!(
                "{kind}: expected what each of its parameters means, found none in wire/src/catalogue.rs"
            ));
        }
        if !kind.summary().ends_with('.') {
            missing.push(format!("{kind}: expected a sentence as its summary, found {:?}", kind.summary()));
        }
    }
    assert!(missing.is_empty(), "{}", missing.join("\n"));
}
