//! One run in full.

use super::super::{Report, RunView, figures};
use super::features::feature_table;
use super::runs::{gated, no_samples};
use maud::{Markup, html};
use rundown::{estimator::config::Mode, filter::ukf::Reading, tick::estimate::Cause};
use rundown_pages::numbers::{counted, duration, meaning, number, percent};
use rundown_pages::shell::{Section, column, figure, prose, table, text_column};

/// What a run's page begins with.
pub(super) fn lead(run: &RunView, report: &Report) -> Markup {
    html! {
        p.lead { (run_words(run, report)) }
        @if !run.warnings.is_empty() {
            details open[run.warnings.len() <= 5] {
                summary { (counted(run.warnings.len(), "warning", "warnings")) " about the log" }
                ul { @for warning in &run.warnings { li { (prose(warning)) } } }
            }
        }
    }
}

/// The parts of a run's page.
pub(super) fn run_sections(run: &RunView, report: &Report) -> Vec<Section> {
    let mut sections = Vec::new();
    if !run.estimates.is_empty() {
        let mut add = |id: &str, heading: &str, body: Markup| sections.push(Section::new(id, heading, body));
        let regimes = "Speed profile in the colours of the confirmed regimes, with their share of the time (Fig. 6 of the paper).";
        add("regimes", "Driving regimes", figure(&figures::regimes(run), regimes));
        let motion = "Speed, acceleration, applied effort and the resistance parameters of this run's train (Fig. 3 of the paper). \
            Effort and acceleration are means since the sample before.";
        add("motion", "Motion and resistance parameters", figure(&figures::motion(run, report.train), motion));
        let terms = "The three terms of the running resistance, stacked, and the resistance of the track's gradient in the same scale (Fig. 5 of the paper).";
        add("terms", "Terms of the running resistance", figure(&figures::resistance_terms(run), terms));
        if let Some(ahead) = figures::coast_ahead(run) {
            let words = "Speed and time at the next stop or lower limit if the train coasts from each place on. While it does coast, both should stay within their earlier bands. \
                The crosses are how fast and when the train was there, mostly by its brake.";
            add("coast-ahead", "Coasting ahead", figure(&ahead, words));
        }
        let words = "Measured less expected. A consistent filter has about 95 % of them inside the band.";
        let innovations = html! { (figure(&figures::innovations(run), words)) (missing_innovations(run)) };
        add("innovations", "Innovations", innovations);
        add("readings", "Use of the readings", readings(run));
    }
    let features = feature_table(&run.summary.features, report.train, &report.features);
    sections.push(Section::new("features", "Features", features));
    sections
}

/// What happened to the resistance where `learning` is set. The paper's filter corrects it all along and learns nothing
/// of the truth.
pub(super) fn learning_words(report: &Report) -> &'static str {
    match report.mode {
        Mode::Paper => "The filter corrected r0, r1 and r2",
        Mode::Gated | Mode::Measured => "The running resistance was learned",
    }
}

fn run_words(run: &RunView, report: &Report) -> String {
    if run.estimates.is_empty() {
        return format!("There is {}.", no_samples(run));
    }
    let learned = run.learned();
    let duration_s = run.duration_s();
    let mut words = format!(
        "{} over {} km in {}.",
        counted(run.estimates.len(), "sample", "samples"),
        number(run.distance_m() / 1000.0, 2),
        duration(duration_s),
    );
    if learned.samples > 0 {
        words += &format!(
            " {} over {} km, {} of the time.",
            learning_words(report),
            number(learned.distance_m / 1000.0, 1),
            percent((duration_s > 0.0).then_some(learned.time_s / duration_s)),
        );
    } else {
        words += " Nothing was learned about the resistance in this run.";
    }
    if super::super::axis::Axis::of_motion(run).runs_backward() {
        words += " The train ran towards smaller locations: figures over location read from right to left.";
    }
    words
}

fn missing_innovations(run: &RunView) -> Markup {
    let mut first = 0;
    let mut unread = 0;
    let mut restarted = 0;
    for (index, estimate) in run.estimates.iter().enumerate() {
        let readings = estimate.innovation.map(|innovation| innovation.readings);
        match readings {
            None if index == 0 => first += 1,
            None if estimate.validity.cause().is_some() => unread += 1,
            None => restarted += 1,
            Some(readings) if readings.contains(&Reading::Missing) => unread += 1,
            Some(_) => (),
        }
    }
    let reasons = [
        (first, "is the first, of which nothing was expected", "are the first"),
        (unread, "lacks a reading that could be used", "lack a reading that could be used"),
        (
            restarted,
            "restarts from the measurement, so nothing was expected of it",
            "restart from the measurement, so nothing was expected of them",
        ),
    ];
    let mut counts = reasons
        .into_iter()
        .filter(|(count, ..)| *count > 0)
        .map(|(count, one, many)| format!("{count} {}", if count == 1 { one } else { many }));
    let Some(start) = counts.next() else {
        return html! {};
    };
    let counts = counts.fold(start, |all, next| format!("{all}; {next}"));
    html! { p.small { "Gaps, of " (counted(run.estimates.len(), "sample", "samples")) ": " (counts) "." } }
}

fn readings(run: &RunView) -> Markup {
    let causes: Vec<(Cause, u32)> = run.summary.counters.iter().filter(|(_, count)| *count > 0).collect();
    let dropped = run.summary.counters.time_not_increasing;
    let gated = gated(run);
    let has_doubts = run.estimates.iter().any(|estimate| estimate.validity.cause().is_some());
    let rows = html! {
        @for (cause, count) in &causes {
            tr { th scope="row" { (cause.as_str()) } td { (count) } td.text { (meaning(*cause)) } }
        }
        @if dropped > 0 {
            tr { th scope="row" { "time_not_increasing" } td { (dropped) } td.text { "the time did not increase: the sample was dropped" } }
        }
        @if gated > 0 {
            tr { th scope="row" { "gated" } td { (gated) } td.text { "the reading lay too far from what was expected to move the estimate" } }
        }
    };
    html! {
        @if causes.is_empty() && dropped == 0 && gated == 0 && !has_doubts {
            p { "Every reading was there and was used." }
        }
        (figure(&figures::readings(run), "Validity of the estimate, where the resistance was learned, the regime, and each cause for which a reading was not used."))
        @if !causes.is_empty() || dropped > 0 || gated > 0 {
            (table([column("cause", ""), column("samples", ""), text_column("meaning")], rows))
        }
    }
}
