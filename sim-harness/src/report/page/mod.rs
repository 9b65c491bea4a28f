//! The page around the figures: words and tables.

mod features;
mod run;
mod runs;
#[cfg(test)]
mod tests;

use super::resistance::Resistance;
use super::{Report, RunView, Vehicle, figures};
use crate::alike::few;
use crate::output::json::mode_word;
use maud::{Markup, html};
use run::{lead, learning_words, run_sections};
use rundown::estimator::config::Mode;
use rundown::{Real, filter::gaussian::Gaussian, model::train::Train, model::units::KmPerHour};
use rundown_pages::numbers::{counted, duration, number, percent};
use rundown_pages::run_pages::{self, Neighbours};
use rundown_pages::shell::{self, Section, column, figure, prose, signed_percent, sortable, table};
use runs::run_table;

const SPEEDS_KMH: [Real; 3] = [60.0, 100.0, 140.0];

/// Units whose curves are drawn; all are in the table.
const PICTURED: usize = 12;

const KMH: Real = 3.6;

pub fn html(report: &Report) -> String {
    let sections = [
        Section::new("resistance", "Running resistance of the vehicle", resistance(report)),
        Section::new("runs", "Runs", run_table(report)),
        Section::new("reading-aids", "How to read this", reading_aids()),
    ];
    shell::document(&report.title, &summary(report), &sections)
}

/// The page of the run at this place of the report; a page without content where there is no such run.
pub fn run_html(at: usize, report: &Report) -> String {
    let Some(run) = report.runs.get(at) else {
        return String::new();
    };
    let name = |at: usize| report.runs.get(at).map(|run| run.name.as_str());
    let neighbours = Neighbours {
        index: report.first + at,
        all: ("../report.html#runs", &format!("All runs of {}", report.title)),
        before: at.checked_sub(1).map_or(report.before.as_deref(), name),
        next: name(at + 1).or(report.after.as_deref()),
    };
    run_pages::page(&run.name, &neighbours, &lead(run, report), &run_sections(run, report))
}

fn summary(report: &Report) -> Markup {
    let duration_s: Real = report.runs.iter().map(RunView::duration_s).sum();
    let distance_m: Real = report.runs.iter().map(RunView::distance_m).sum();
    let learned = report.learned();
    let share = percent((duration_s > 0.0).then_some(learned.time_s / duration_s));
    html! {
        div id="summary" {
            p.lead {
                @if report.runs.is_empty() {
                    "No run was replayed: there is nothing to report. "
                } @else {
                    (counted(report.runs.len(), "run was", "runs were")) " replayed in the "
                    strong { (mode_word(report.mode)) } " mode: " (number(distance_m / 1000.0, 1)) " km in "
                    (duration(duration_s)) ". "
                }
                @if learned.samples > 0 {
                    (learning_words(report)) " over " strong { (number(learned.distance_m / 1000.0, 1)) " km" }
                    ", " (share) " of the time"
                    @if let Some(speeds) = &learned.speeds_mps {
                        ", at " (number(KMH * speeds.start, 0)) " to " (number(KMH * speeds.end, 0)) " km/h"
                    }
                    ". "
                } @else if !report.runs.is_empty() {
                    "Nothing was learned about the running resistance: no stretch taught it. "
                }
            }
            p.lead { (verdict(report)) }
            @if report.mode == Mode::Paper {
                p.note {
                    "This is the reference mode. The effort it calculates contains the resistance it looks for, so the estimate does not follow "
                    "the true resistance, however well the speed is tracked; its intervals are those of the filter and no measure of accuracy. "
                    "To measure the resistance, replay in the " strong { "gated" } " mode."
                }
            }
            @if report.mode == Mode::Gated && learned.samples > 0 {
                p.note {
                    "Learned only while coasting was established, when the applied effort is known to be zero; "
                    "everywhere else the resistance stays as it was."
                }
            }
            (notes(report))
        }
    }
}

/// What the screen says, too.
fn notes(report: &Report) -> Markup {
    html! {
        @if !report.failed.is_empty() {
            div id="failed" {
                p.note { (counted(report.failed.len(), "log", "logs")) " could not be used:" }
                ul {
                    @for error in few(report.failed.iter().map(|failed| &failed.error)) {
                        li { @for line in error.lines() { div { (prose(line)) } } }
                    }
                }
            }
        }
        @if !report.notes.is_empty() {
            div id="notes" {
                p.note { "What is to be known of these runs:" }
                ul { @for note in report.notes { li { (prose(note)) } } }
            }
        }
    }
}

fn verdict(report: &Report) -> Markup {
    let vehicle = match &report.vehicles[..] {
        [] => {
            return html! { "There is " strong { "no estimate" } " of the vehicle: no run has ended." };
        }
        [one] => one,
        several => {
            return html! {
                "The runs are of " (several.len()) " units: each has a running resistance of its own, in "
                a href="#resistance" { "the table below" } "."
            };
        }
    };
    let Some((name, belief)) = vehicle.after.last() else {
        return html! { "There is " strong { "no estimate" } " of the vehicle: no run has ended." };
    };
    let at = |speed_kmh: Real| {
        let speed_mps = KmPerHour(speed_kmh).to_mps();
        let r = Resistance::at(belief, speed_mps)?;
        Some((speed_kmh, r, r.against(&report.train.davis(), speed_mps)))
    };
    let Some(found) = SPEEDS_KMH.map(at).into_iter().collect::<Option<Vec<_>>>() else {
        return html! {
            "There is " strong { "no estimate" } " of the vehicle: what " (name) " left behind is not finite."
        };
    };
    let words = found.iter().map(|(speed_kmh, r, against)| {
        let side = if against.deviation < 0.0 { "below" } else { "above" };
        // In the paper's mode the interval is the filter's: so narrow that it prints as nothing, and no measure of the
        // vehicle.
        let interval = match report.mode {
            Mode::Paper => String::new(),
            Mode::Gated | Mode::Measured => {
                format!(" (95\u{a0}% between {} and {})", number(r.lower(), 5), number(r.upper(), 5))
            }
        };
        format!(
            "at {speed_kmh}\u{a0}km/h {}\u{a0}N/kg{interval}, {} {side} the manufacturer's {}",
            number(r.mean_n_per_kg, 5),
            percent(against.deviation.abs()),
            number(against.stated_n_per_kg, 5),
        )
    });
    let words: Vec<String> = words.collect();
    let outside = found.iter().filter(|(.., against)| !against.within);
    let outside: Vec<String> = outside.map(|(speed_kmh, ..)| speed_kmh.to_string()).collect();
    let significance = match outside.len() {
        0 => "The manufacturer's values lie inside these intervals: no difference is proven.".to_owned(),
        n if n == found.len() => "The manufacturer's values lie outside these intervals.".to_owned(),
        _ => format!("The manufacturer's value lies outside the interval at {} km/h only.", outside.join(" and ")),
    };
    html! {
        "After " @if vehicle.after.len() > 1 { "the last run, " } (name)
        @if report.mode == Mode::Paper { ", the resistance of the filter is " } @else { ", the running resistance of the vehicle is " }
        (words.join("; ")) ". "
        // In the paper's mode the interval says nothing of the truth.
        @if report.mode != Mode::Paper { (significance) }
    }
}

fn resistance(report: &Report) -> Markup {
    match &report.vehicles[..] {
        [] => html! { (curve(report, None)) },
        [one] => of_vehicle(report, one),
        several => html! {
            (table_of_units(several, report.train))
            @if several.len() > PICTURED {
                p.note {
                    "Pictures of the first " (PICTURED) " units; those of another: replay its runs alone."
                }
            }
            @for vehicle in several.iter().take(PICTURED) {
                h3 { (vehicle.name()) }
                (of_vehicle(report, vehicle))
            }
        },
    }
}

fn curve(report: &Report, vehicle: Option<&Vehicle>) -> Markup {
    figure(
        &report.resistance_curve(vehicle),
        "Running resistance per rotating mass over speed, after the last run. Beyond the speeds at which it was learned the curve is the Davis equation's.",
    )
}

fn of_vehicle(report: &Report, vehicle: &Vehicle) -> Markup {
    html! {
        @if let Some(belief) = vehicle.last() {
            (resistance_table(belief, report.train))
        }
        (curve(report, Some(vehicle)))
        @if vehicle.after.len() > 1 {
            (figure(
                &figures::vehicle_history(&vehicle.after, report.train, report.shown_kmh()),
                &format!("Running resistance of the vehicle at {} km/h as it stood after each run.", report.shown_kmh())
            ))
        }
    }
}

/// A line for each unit.
fn table_of_units(vehicles: &[Vehicle], train: &Train) -> Markup {
    let speeds = SPEEDS_KMH.map(|speed_kmh| format!("r({speed_kmh}\u{a0}km/h), 95\u{a0}% interval"));
    let mut head = vec![column("unit", ""), column("runs", "")];
    for speed in &speeds {
        head.push(column(speed, "N/kg"));
        head.push(column("difference", "of the manufacturer's"));
    }
    let rows = html! { @for vehicle in vehicles {
        tr {
            th scope="row" { @if vehicle.unit.is_empty() { "no name" } @else { (run_pages::one_line(&vehicle.unit)) } }
            td { (vehicle.after.len()) }
            @for speed_kmh in SPEEDS_KMH {
                @let speed_mps = KmPerHour(speed_kmh).to_mps();
                @if let Some(r) = vehicle.last().and_then(|belief| Resistance::at(belief, speed_mps)) {
                    td { (number(r.mean_n_per_kg, 5)) " (" (number(r.lower(), 5)) " to " (number(r.upper(), 5)) ")" }
                    td { (signed_percent(r.against(&train.davis(), speed_mps).deviation)) }
                } @else {
                    td colspan="2" { "no estimate: not finite" }
                }
            }
        }
    } };
    sortable(head, rows)
}

fn resistance_table(vehicle: &Gaussian<3>, train: &Train) -> Markup {
    let force_kn = train.rotating_mass_kg() / 1000.0;
    let head = [
        column("speed", "km/h"),
        column("estimated", "N/kg"),
        column("95 % interval", "N/kg"),
        column("estimated", "kN, whole train"),
        column("manufacturer", "N/kg"),
        column("difference", "of the manufacturer's"),
    ];
    let rows = html! { @for speed_kmh in SPEEDS_KMH {
        @let speed_mps = KmPerHour(speed_kmh).to_mps();
        tr {
            th scope="row" { (speed_kmh) }
            @if let Some(r) = Resistance::at(vehicle, speed_mps) {
                @let against = r.against(&train.davis(), speed_mps);
                td { (number(r.mean_n_per_kg, 5)) }
                td { (number(r.lower(), 5)) " to " (number(r.upper(), 5)) }
                td { (number(r.mean_n_per_kg * force_kn, 2)) }
                td { (number(against.stated_n_per_kg, 5)) }
                td { (signed_percent(against.deviation)) }
            } @else {
                td colspan="5" { "no estimate: not finite" }
            }
        }
    } };
    table(head, rows)
}

fn reading_aids() -> Markup {
    html! {
            dl {
                dt { "Resistance, effort" }
                dd { "In N per kg of rotating mass (mass times rotating mass factor). Traction is positive, brake negative, uphill positive, resistance positive against travel." }
                dt { "95 % interval, 95 % band" }
                dd { "Mean \u{b1} 1.96 standard deviations of the estimate itself, with the correlation of r0, r1 and r2. It assumes that the model holds." }
                dt { "Vehicle, this run's train" }
                dd { "The vehicle is what is carried from run to run. This run's train also has the wind and load of the day; its parameters are those of the figures of a run." }
                dt { "Gaps" }
                dd { "A line is broken where a reading is missing, an estimate is invalid, or the recorder paused. Nothing is drawn in its place." }
                dt { "valid, held, invalid" }
                dd { "Held: a reading is missing or was not believed, its value is carried on from before. Invalid: too long without a believable reading." }
                dt { "Pictures" }
                dd { "Drag to zoom, double-click to see all again; values under the cursor stand above each plot; a click on a name there switches it off. Plots with the same axis share cursor and zoom." }
            }
    }
}
