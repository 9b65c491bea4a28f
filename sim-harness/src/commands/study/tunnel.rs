//! `rundown study --tunnel`: what the paper's mode and the gap workflow make of the tunnel at Best.

use super::Arguments;
use crate::commands::{Failure, screen};
use crate::study::figures::Picture;
use crate::study::tunnel::{Drag, TunnelAnswer, answer};
use crate::study::write;
use rundown_files::folder::{self, Provenance};
use serde_json::json;
use std::path::Path;

pub(super) fn run(arguments: &Arguments, out: &Path) -> Result<Picture, Failure> {
    let (answer, json) = folder::write("study", out, &Provenance::begin(&[]), |folder| {
        let answer = answer(folder, arguments.seed, arguments.count, screen::note)?;
        let json = tunnel_json(&answer);
        write::pictures(folder, &[answer.picture()])?;
        write::text(&folder.join("tunnel.json"), &json)?;
        Ok::<_, Failure>((answer, json))
    })?;
    screen::results(arguments.json, &json, &answer.words(), out);
    Ok(answer.picture())
}

fn tunnel_json(answer: &TunnelAnswer) -> String {
    let [backward, forward] = answer.largest();
    let drag = |d: &Drag| json!({ "from_m": d.from_m, "to_m": d.to_m, "k": d.k });
    let json = json!({
        "runs": answer.runs,
        "truth": drag(&answer.truth),
        "r0_differs_by": { "backward": backward, "forward": forward },
        "found": answer.found.iter().map(|(d, _)| drag(d)).collect::<Vec<_>>(),
        "named": answer.named,
    });
    format!("{json:#}\n")
}
