//! `report.html` of experiments: each question with its picture and its table.

use super::answer::Answer;
use super::catalogue;
use maud::html;
use rundown_pages::shell::{Section, column, document, figure, prose, sortable, text_column};

pub fn page(answers: &[Answer]) -> String {
    let title = match answers {
        [one] => format!("Experiment: {}", one.name),
        _ => "After the paper: experiments".to_owned(),
    };
    let lead = html! {
        p.lead {
            "Cunillera et al. (2022) leave questions to future work. Each is answered here on simulated runs, whose truth is known; "
            "every picture lies beside this page or in the folder of its experiment, as SVG with its numbers as CSV."
        }
    };
    document(&title, &lead, &answers.iter().map(section).collect::<Vec<_>>())
}

fn section(answer: &Answer) -> Section {
    let place = catalogue::ALL.iter().find(|experiment| experiment.name == answer.name);
    let picture = answer.picture();
    let head = [text_column("variant"), text_column("mode")];
    let quantities = answer.columns.iter().map(|(_, label)| {
        let (meaning, unit) = label.rsplit_once(", ").unwrap_or((label, ""));
        column(meaning, unit)
    });
    let rows = html! { @for row in answer.table() { tr {
        th scope="row" { (row.variant) }
        td.text { (row.arm) }
        @for cell in row.cells { td { (cell) } }
    } } };
    let body = html! {
        p { (answer.question) @if let Some(experiment) = place { " (section " (experiment.place) ")" } }
        (figure(&picture.drawing, &picture.caption))
        @let names = answer.names();
        @if !names.is_empty() {
            // A page that can be zoomed has numbers on its axes.
            p.small { @for (x, name) in names { (x) ": " (name) ". " } }
        }
        (sortable(head.into_iter().chain(quantities), rows))
        @for note in &answer.notes { p { (prose(note)) } }
    };
    Section::new(answer.name, answer.name, body)
}
