//! The table of all runs.

use super::super::resistance::{Resistance, doubt};
use super::super::{Report, RunView, regime_shares};
use super::KMH;
use maud::{Markup, html};
use rundown::estimator::config::Mode;
use rundown::{Real, filter::ukf::Reading, model::units::KmPerHour, tick::regime::Regime};
use rundown_pages::numbers::{NOTHING, number};
use rundown_pages::run_pages;
use rundown_pages::shell::swatch;

/// `0.03125 ± 0.00042`; in the paper's mode the interval says nothing of the vehicle.
fn resistance(run: &RunView, report: &Report, speed_kmh: Real) -> String {
    let Some(r) = Resistance::at(&run.vehicle_after, KmPerHour(speed_kmh).to_mps()) else { return NOTHING.to_owned() };
    let mean = number(r.mean_n_per_kg, 5);
    match report.mode {
        Mode::Paper => mean,
        Mode::Gated | Mode::Measured => {
            format!("{mean} \u{b1} {}{}", number(r.upper() - r.mean_n_per_kg, 5), doubt(run.learned))
        }
    }
}

pub(super) fn run_table(report: &Report) -> Markup {
    let speed_kmh = report.shown_kmh();
    let interval = if report.mode == Mode::Paper { "N/kg" } else { "N/kg, 95 % interval" };
    html! {
            @if report.runs.is_empty() {
                p { "No run." }
            } @else {
                div.wide { table.runs.sortable {
                    thead {
                        tr {
                            th rowspan="2" scope="col" { "run" }
                            th rowspan="2" scope="col" { "time" br; span.unit { "min" } }
                            th rowspan="2" scope="col" { "distance" br; span.unit { "km" } }
                            th rowspan="2" scope="col" { "cruise speed" br; span.unit { "km/h" } }
                            th colspan="2" scope="colgroup" { "final coast" }
                            th colspan="2" scope="colgroup" { "final brake" }
                            th rowspan="2" scope="col" { "power" br; span.unit { "kW" } }
                            th colspan="5" scope="colgroup" { "share of the time, %" }
                            th.text rowspan="2" scope="col" data-choices="resistance" { "resistance" }
                            th rowspan="2" scope="col" { "r(" (speed_kmh) "\u{a0}km/h)" br; span.unit { (interval) } }
                            th rowspan="2" scope="col" { "learned" br; span.unit { "km" } }
                            th rowspan="2" scope="col" { "not used" br; span.unit { "readings" } }
                        }
                        tr {
                            @for _ in 0..2 {
                                th scope="col" { "from" br; span.unit { "km" } }
                                th scope="col" { "for" br; span.unit { "s" } }
                            }
                            @for regime in Regime::ALL {
                                th scope="col" { (swatch(regime)) (regime.as_str()) }
                            }
                        }
                    }
                    tbody {
                        @for (index, run) in report.runs.iter().enumerate() {
                            (run_row(index, run, report, speed_kmh))
                        }
                    }
                } }
                p.small {
                    "Power is the mean while accelerating, at the wheel, with the rotating mass of the train file. "
                    "r(" (speed_kmh) "\u{a0}km/h) is the vehicle's after the run. "
                    "A dash stands where a run did not show the feature."
                    @if report.has_run_pages { " Each run has a page in the folder " code { (run_pages::FOLDER) } "." }
                }
            }
    }
}

fn run_row(index: usize, run: &RunView, report: &Report, speed_kmh: Real) -> Markup {
    let force_kn = report.train.rotating_mass_kg() / 1000.0;
    let features = &run.summary.features;
    let coast = features.final_coast.as_ref();
    let brake = features.final_brake.as_ref();
    let power = &features.power_w_per_kg;
    let shares = regime_shares(run);
    html! {
        tr {
            th scope="row" { (run_pages::linked(&run.name, index, report.has_run_pages)) }
            @if run.estimates.is_empty() {
                td colspan="17" { (no_samples(run)) }
            } @else {
                td { (number(run.duration_s() / 60.0, 1)) }
                td { (number(run.distance_m() / 1000.0, 2)) }
                td { (number(features.cruise_speed_median_mps.map(|v| KMH * v), 1)) }
                @for phase in [coast, brake] {
                    td { (number(phase.map(|p| p.start_location_m / 1000.0), 2)) }
                    td { (number(phase.map(|p| p.duration_s), 0)) }
                }
                td { (number((power.count > 0).then_some(power.mean * force_kn), 0)) }
                @for regime in Regime::ALL {
                    td { (number(shares.map(|shares| 100.0 * shares[regime as usize]), 1)) }
                }
                @let learned = run.learned();
                td.word { (if learned.samples > 0 { "learned" } else { "not learned" }) }
                td { (resistance(run, report, speed_kmh)) }
                td { (number(learned.distance_m / 1000.0, 1)) }
                td { (not_used(run)) }
            }
        }
    }
}

pub(super) fn no_samples(run: &RunView) -> String {
    let dropped = run.summary.counters.time_not_increasing;
    match dropped {
        0 => "no estimate: the run has no usable sample".to_owned(),
        _ => format!("no estimate: all {dropped} samples were dropped because their time does not increase"),
    }
}

/// Readings that were missing, not believed or outside the gate, and samples that were dropped.
fn not_used(run: &RunView) -> u64 {
    let of_causes: u64 = run.summary.counters.iter().map(|(_, count)| u64::from(count)).sum();
    of_causes + u64::from(run.summary.counters.time_not_increasing) + gated(run) as u64
}

/// Readings that the filter left out because they lay outside the gate.
pub(super) fn gated(run: &RunView) -> usize {
    let innovations = run.estimates.iter().filter_map(|estimate| estimate.innovation);
    let gated = innovations.map(|innovation| {
        let is_gated = |reading: &&Reading| **reading == Reading::Gated;
        innovation.readings.iter().filter(is_gated).count()
    });
    gated.sum()
}
