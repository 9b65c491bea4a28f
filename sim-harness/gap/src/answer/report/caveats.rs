//! What the numbers rest on, and how a name can be wrong.

use crate::answer::whole::Answer;
use crate::data::runs::EffortReading;
use maud::{Markup, html};
use rundown_files::refusal::MAX_LISTED;
use rundown_pages::numbers::{counted, number, percent};
use rundown_pages::shell::prose;

pub(super) fn caveats(answer: &Answer) -> Markup {
    let items = [data(answer), noise(answer), readings(answer)];
    html! {
        ul {
            @for item in &items { li { p { (prose(item)) } } }
            @for item in names(answer) { li { p { (prose(item)) } } }
            @for item in of_reading(answer) { li { p { (prose(&item)) } } }
        }
    }
}

/// What was said as the logs were read: which were left out, and why.
fn of_reading(answer: &Answer) -> Vec<String> {
    let elsewhere = answer.input.check.as_ref().map(|check| check.notes()).unwrap_or_default();
    let mut notes: Vec<String> = answer.input.notes.iter().filter(|note| !elsewhere.contains(note)).cloned().collect();
    let more = notes.len().saturating_sub(MAX_LISTED);
    notes.truncate(MAX_LISTED);
    notes.extend((more > 0).then(|| format!("{} on the logs", counted(more, "more note", "more notes"))));
    notes
}

fn data(answer: &Answer) -> String {
    let findings = &answer.found.findings;
    let rows = findings.rows.len();
    let mut runs: Vec<usize> = findings.rows.iter().map(|r| r.interval.run).collect();
    runs.dedup();
    let mut text = format!("{rows} intervals of {} counted. ", counted(runs.len(), "run", "runs"));
    text.push_str(if findings.measured {
        "The logs have an effort column; intervals in which the effort changes much are left out."
    } else {
        "The logs have no effort column, so only coasting counts, where the effort is known to be zero. What acts while the train powers or brakes shows only in the limits, if at all, and mass, traction and resistance are hard to separate."
    });
    text
}

fn noise(answer: &Answer) -> String {
    let calibrated = &answer.found.findings.calibrated;
    let (noise, own) = (&calibrated.noise, &calibrated.own);
    let mut text = format!(
        "Noise, found from these data (standard deviations): {} m/s of a speed reading, {} m/s\u{b2} of the acceleration over an interval",
        number(noise.reading_mps, 3),
        number(noise.acceleration_mps2, 4)
    );
    if noise.change_share > 0.0 {
        text.push_str(&format!(", {} of a change of the effort", percent(noise.change_share)));
    }
    text.push_str(". Random effects per run, which no model of other runs can know: ");
    text.push_str(&format!(
        "{} N/kg of resistance, {} m/s of wind, {} of mass or effort.",
        number(own.constant_n_per_kg, 4),
        number(own.wind_mps, 1),
        percent(own.mass)
    ));
    text
}

fn readings(answer: &Answer) -> String {
    let findings = &answer.found.findings;
    let mut corrected = match &answer.input.check {
        Some(check) => check.notes(),
        None => vec!["the logs were taken as recorded, nothing was diagnosed".to_owned()],
    };
    let located = answer.input.runs.iter().filter(|run| run.recorded.location_lag_s != 0.0).count();
    if located > 0 {
        corrected.push(format!("locations were shifted by their lag in {}", counted(located, "run", "runs")));
    }
    if findings.measured && findings.effort == EffortReading::MeanSinceLast {
        corrected.push("the effort was read as the mean since the sample before".to_owned());
    }
    if corrected.is_empty() {
        return "Speed, location and clock agree; no reading was corrected.".to_owned();
    }
    format!("Of the readings: {}.", corrected.join("; "))
}

fn names(answer: &Answer) -> Vec<&'static str> {
    let findings = &answer.found.findings;
    let mut all = vec![
        "A name is the best of a catalogue, chosen for fitting these runs. Something outside the catalogue that acts alike gets the name of what it resembles; a confidence counts rivals within the catalogue, chance, and halves of the runs that differ, nothing else.",
        "Two small effects can look like one larger effect, and the intervals hold only if the name is right.",
    ];
    let up = |row: &crate::data::rows::Row| row.direction == rundown::model::direction::Direction::Up;
    if findings.rows.iter().all(up) || !findings.rows.iter().any(up) {
        all.push("All runs went in one direction. A steady wind then looks like other Davis coefficients, and a wrong gradient like any other resistance at that place.");
    }
    if findings.rows.iter().all(|r| r.interval.temperature_c.is_none()) {
        all.push("No temperature was recorded: what depends on it may show as a drift over the dates, or as differences between runs.");
    }
    if findings.conditions.period_days < 30.0 {
        all.push("The runs span less than a month, or have no dates: a drift over the seasons cannot be seen.");
    }
    all
}
