//! The page around the figures: words and tables.

use super::numbers::{NOTHING, counted, duration, meaning, number, percent, statistic};
use super::resistance::Resistance;
use super::{Learned, RUNS_IN_FULL, Report, RunView, colours, figures, regime_shares};
use maud::{DOCTYPE, Markup, PreEscaped, html};
use rundown::Real;
use rundown::estimate::Cause;
use rundown::features::{EffortLine, FeatureConfig, Features, Phase};
use rundown::regime::Regime;
use rundown::state::Gaussian;
use rundown::train::Train;
use rundown::ukf::Reading;
use rundown::units::KmPerHour;

const STYLE: &str = include_str!("style.css");
/// Speeds at which the resistance is told, km/h.
const SPEEDS_KMH: [Real; 3] = [60.0, 100.0, 140.0];
/// Speed of the vehicle's history, km/h.
const HISTORY_KMH: Real = 100.0;
const KMH: Real = 3.6;

/// The whole page.
pub fn html(report: &Report) -> String {
    let page = html! {
        (DOCTYPE)
        html lang="en" {
            head {
                meta charset="utf-8";
                meta name="viewport" content="width=device-width, initial-scale=1";
                meta name="generator" content="rundown";
                title { (report.title) }
                style { (PreEscaped(STYLE)) }
            }
            body {
                main {
                    h1 { (report.title) }
                    (summary(report))
                    (resistance(report))
                    (run_table(report))
                    @for (index, run) in report.runs.iter().take(RUNS_IN_FULL).enumerate() {
                        (run_section(index, run, report))
                    }
                    (others(report))
                    (reading_aids())
                }
            }
        }
    };
    page.into_string()
}

fn learned(report: &Report) -> Learned {
    let runs = report.runs.iter().map(RunView::learned);
    runs.fold(Learned::default(), |all, run| all.and(&run))
}

/// The headline in words.
fn summary(report: &Report) -> Markup {
    let duration_s: Real = report.runs.iter().map(RunView::duration_s).sum();
    let distance_m: Real = report.runs.iter().map(RunView::distance_m).sum();
    let learned = learned(report);
    let share = percent((duration_s > 0.0).then_some(learned.time_s / duration_s));
    html! {
        section id="summary" aria-label="Summary" {
            p.lead {
                @if report.runs.is_empty() {
                    "No run was replayed: there is nothing to tell. "
                } @else {
                    (counted(report.runs.len(), "run was", "runs were")) " replayed in the "
                    strong { (report.mode) } " mode: " (number(distance_m / 1000.0, 1)) " km in "
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
            @if report.mode == "paper" {
                p.note {
                    "This is the reference mode. The effort it calculates contains the resistance it looks for, so the estimate does not follow "
                    "the true resistance, however well the speed is tracked; its intervals are those of the filter and no measure of accuracy. "
                    "To measure the resistance, replay in the " strong { "gated" } " mode."
                }
            }
            @if report.mode == "gated" && learned.samples > 0 {
                p.note {
                    "Learned only while coasting was established, when the applied effort is known to be zero; "
                    "everywhere else the resistance stays as it was."
                }
            }
        }
    }
}

/// What is known of the resistance, against what the manufacturer says.
fn verdict(report: &Report) -> Markup {
    let Some((name, vehicle)) = report.vehicle.last() else {
        return html! {
            "There is " strong { "no estimate" } " of the vehicle: no run has ended."
        };
    };
    let at = |speed_kmh: Real| {
        let speed_mps = KmPerHour(speed_kmh).to_mps();
        let r = Resistance::at(vehicle, speed_mps)?;
        Some((speed_kmh, r, r.against(&report.train.davis(), speed_mps)))
    };
    let Some(found) = SPEEDS_KMH.map(at).into_iter().collect::<Option<Vec<_>>>() else {
        return html! {
            "There is " strong { "no estimate" } " of the vehicle: what " (name) " left behind is not finite."
        };
    };
    let words = found.iter().map(|(speed_kmh, r, against)| {
        let side = if against.deviation < 0.0 { "below" } else { "above" };
        format!(
            "at {speed_kmh}\u{a0}km/h {}\u{a0}N/kg (95\u{a0}% between {} and {}), {} {side} the manufacturer's {}",
            number(r.mean_n_per_kg, 5),
            number(r.lower(), 5),
            number(r.upper(), 5),
            percent(against.deviation.abs()),
            number(against.stated_n_per_kg, 5),
        )
    });
    let words: Vec<String> = words.collect();
    let outside = found.iter().filter(|(.., against)| !against.within);
    let outside: Vec<String> = outside
        .map(|(speed_kmh, ..)| speed_kmh.to_string())
        .collect();
    let significance = match outside.len() {
        0 => "The manufacturer's values lie inside these intervals: no difference is proven."
            .to_owned(),
        n if n == found.len() => {
            "The manufacturer's values lie outside these intervals.".to_owned()
        }
        _ => format!(
            "The manufacturer's value lies outside the interval at {} km/h only.",
            outside.join(" and ")
        ),
    };
    html! {
        "After " @if report.vehicle.len() > 1 { "the last run, " } (name)
        ", the running resistance of the vehicle is " (words.join("; ")) ". "
        // In the paper's mode the interval says nothing of the truth.
        @if report.mode != "paper" { (significance) }
    }
}

fn resistance(report: &Report) -> Markup {
    let vehicle = report.vehicle.last().map(|(_, vehicle)| vehicle);
    let learned = learned(report);
    html! {
        section id="resistance" {
            h2 { "Running resistance of the vehicle" }
            @if let Some(vehicle) = vehicle {
                (resistance_table(vehicle, report.train))
            }
            (figure(
                figures::resistance_curve(vehicle, report.train, learned.speeds_mps),
                "Running resistance per rotating mass over speed, after the last run. Beyond the speeds at which it was learned the curve is the Davis equation's."
            ))
            @if report.vehicle.len() > 1 {
                (figure(
                    figures::vehicle_history(&report.vehicle, report.train, HISTORY_KMH),
                    "Running resistance of the vehicle at 100 km/h as it stood after each run."
                ))
            }
        }
    }
}

fn resistance_table(vehicle: &Gaussian<3>, train: &Train) -> Markup {
    let force_kn = train.rotating_mass_kg() / 1000.0;
    html! {
        div.wide { table {
            thead { tr {
                th scope="col" { "speed" br; span.unit { "km/h" } }
                th scope="col" { "estimated" br; span.unit { "N/kg" } }
                th scope="col" { "95 % interval" br; span.unit { "N/kg" } }
                th scope="col" { "estimated" br; span.unit { "kN, whole train" } }
                th scope="col" { "manufacturer" br; span.unit { "N/kg" } }
                th scope="col" { "difference" br; span.unit { "of the manufacturer's" } }
            } }
            tbody {
                @for speed_kmh in SPEEDS_KMH {
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
                }
            }
        } }
    }
}

fn signed_percent(share: Real) -> String {
    let sign = if share > 0.0 { "+" } else { "" };
    format!("{sign}{}", percent(share))
}

fn run_table(report: &Report) -> Markup {
    let force_kn = report.train.rotating_mass_kg() / 1000.0;
    html! {
        section id="runs" {
            h2 { "Runs" }
            @if report.runs.is_empty() {
                p { "No run." }
            } @else {
                div.wide { table.runs {
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
                            (run_row(index, run, force_kn))
                        }
                    }
                } }
                p.small {
                    "Power is the mean while accelerating, at the wheel, with the rotating mass of the train file. "
                    "A dash stands where a run did not show the feature."
                }
            }
        }
    }
}

fn run_row(index: usize, run: &RunView, force_kn: Real) -> Markup {
    let features = run.features;
    let coast = features.final_coast.as_ref();
    let brake = features.final_brake.as_ref();
    let power = &features.power_w_per_kg;
    let shares = regime_shares(run);
    html! {
        tr {
            th scope="row" {
                @if index < RUNS_IN_FULL { a href=(format!("#run-{}", index + 1)) { (run.name) } }
                @else { (run.name) }
            }
            @if run.estimates.is_empty() {
                td colspan="14" { (no_samples(run)) }
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
                td { (number(run.learned().distance_m / 1000.0, 1)) }
                td { (not_used(run)) }
            }
        }
    }
}

fn swatch(regime: Regime) -> Markup {
    let colour = colours::css(colours::of_regime(regime));
    html! { span.swatch style=(format!("background:{colour}")) {} }
}

fn no_samples(run: &RunView) -> String {
    let dropped = run.counters.time_not_increasing;
    match dropped {
        0 => "no estimate: the run has no usable sample".to_owned(),
        _ => format!(
            "no estimate: all {dropped} samples were dropped because their time does not increase"
        ),
    }
}

/// Readings that were missing, not believed or outside the gate, and samples that were dropped.
fn not_used(run: &RunView) -> u64 {
    let of_causes: u64 = run.counters.iter().map(|(_, count)| u64::from(count)).sum();
    of_causes + u64::from(run.counters.time_not_increasing) + gated(run) as u64
}

/// Readings that the filter left out because they lay outside the gate.
fn gated(run: &RunView) -> usize {
    let innovations = run
        .estimates
        .iter()
        .filter_map(|estimate| estimate.innovation);
    let gated = innovations.map(|innovation| {
        let is_gated = |reading: &&Reading| **reading == Reading::Gated;
        innovation.readings.iter().filter(is_gated).count()
    });
    gated.sum()
}

fn run_section(index: usize, run: &RunView, report: &Report) -> Markup {
    html! {
        section.run id=(format!("run-{}", index + 1)) {
            h2 { (run.name) }
            p { (run_words(run, report)) " " a href="#runs" { "Back to the table" } }
            @if !run.warnings.is_empty() {
                details open[run.warnings.len() <= 5] {
                    summary { (counted(run.warnings.len(), "warning", "warnings")) " about the log" }
                    ul { @for warning in run.warnings { li { (warning) } } }
                }
            }
            @if !run.estimates.is_empty() {
                h3 { "Driving regimes" }
                (figure(figures::regimes(run), "Speed profile in the colours of the confirmed regimes, with their share of the time (Fig. 6 of the paper)."))
                h3 { "Motion and resistance parameters" }
                (figure(figures::motion(run, report.train), "Speed, acceleration, applied effort and the resistance parameters of this run's train (Fig. 3 of the paper). \
                    Effort and acceleration are means since the sample before."))
                h3 { "Terms of the running resistance" }
                (figure(figures::resistance_terms(run), "The three terms of the running resistance, stacked, and the resistance of the track's gradient in the same scale (Fig. 5 of the paper)."))
                h3 { "Innovations" }
                (figure(figures::innovations(run), "Measured less expected. A consistent filter has about 95 % of them inside the band."))
                (missing_innovations(run))
                (readings(run))
            }
            h3 { "Features" }
            (feature_table(run.features, report.train, &report.features))
        }
    }
}

/// What happened to the resistance where `learning` is set. The paper's filter corrects it all along and learns nothing of the truth.
fn learning_words(report: &Report) -> &'static str {
    match report.mode {
        "paper" => "The filter corrected r0, r1 and r2",
        _ => "The running resistance was learned",
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
    if super::axis::Axis::of_motion(run).runs_backward() {
        words += " The train ran towards smaller locations: figures over location read from right to left.";
    }
    words
}

/// Why samples have no innovation.
fn missing_innovations(run: &RunView) -> Markup {
    let mut first = 0;
    let mut unread = 0;
    let mut anew = 0;
    for (index, estimate) in run.estimates.iter().enumerate() {
        let readings = estimate.innovation.map(|innovation| innovation.readings);
        match readings {
            None if index == 0 => first += 1,
            None if estimate.validity.cause().is_some() => unread += 1,
            None => anew += 1,
            Some(readings) if readings.contains(&Reading::Missing) => unread += 1,
            Some(_) => (),
        }
    }
    let reasons = [
        (
            first,
            "is the first, of which nothing was expected",
            "are the first",
        ),
        (
            unread,
            "lacks a reading that could be used",
            "lack a reading that could be used",
        ),
        (
            anew,
            "begins anew from the measurement, so nothing was expected of it",
            "begin anew from the measurement, so nothing was expected of them",
        ),
    ];
    let mut told = reasons
        .into_iter()
        .filter(|(count, ..)| *count > 0)
        .map(|(count, one, many)| format!("{count} {}", if count == 1 { one } else { many }));
    let Some(start) = told.next() else {
        return html! {};
    };
    let told = told.fold(start, |all, next| format!("{all}; {next}"));
    html! { p.small { "Gaps, of " (counted(run.estimates.len(), "sample", "samples")) ": " (told) "." } }
}

fn readings(run: &RunView) -> Markup {
    let causes: Vec<(Cause, u32)> = run
        .counters
        .iter()
        .filter(|(_, count)| *count > 0)
        .collect();
    let dropped = run.counters.time_not_increasing;
    let gated = gated(run);
    let has_doubts = run
        .estimates
        .iter()
        .any(|estimate| estimate.validity.cause().is_some());
    html! {
        h3 { "Use of the readings" }
        @if causes.is_empty() && dropped == 0 && gated == 0 && !has_doubts {
            p { "Every reading was there and was used." }
        }
        (figure(figures::readings(run), "Over time: validity of the estimate, where the resistance was learned, the regime, and each cause for which a reading was not used."))
        @if !causes.is_empty() || dropped > 0 || gated > 0 {
            div.wide { table {
                thead { tr { th scope="col" { "cause" } th scope="col" { "samples" } th.text scope="col" { "meaning" } } }
                tbody {
                    @for (cause, count) in causes {
                        tr { th scope="row" { (cause.as_str()) } td { (count) } td.text { (meaning(cause)) } }
                    }
                    @if dropped > 0 {
                        tr { th scope="row" { "time_not_increasing" } td { (dropped) } td.text { "the time did not increase: the sample was dropped" } }
                    }
                    @if gated > 0 {
                        tr { th scope="row" { "gated" } td { (gated) } td.text { "the reading lay too far from what was expected to move the estimate" } }
                    }
                }
            } }
        }
    }
}

fn feature_table(features: &Features, train: &Train, config: &FeatureConfig) -> Markup {
    let mass_kg = train.rotating_mass_kg();
    let row = |name: &str, unit: &str, [count, mean, sd]: [String; 3]| {
        html! { tr { th scope="row" { (name) } td { (count) } td { (mean) } td { (sd) } td.text { (unit) } } }
    };
    // No standard deviation: seen once in a run, or not at all.
    let once = |value: Option<Real>, decimals: usize| {
        let count = if value.is_some() { "1" } else { "0" };
        [
            count.to_owned(),
            number(value, decimals),
            NOTHING.to_owned(),
        ]
    };
    let phase = |name: &str, phase: Option<&Phase>| {
        let of = |field: fn(&Phase) -> Real| phase.map(field);
        html! {
            (row(&format!("{name}: start"), "km", once(of(|p| p.start_location_m / 1000.0), 2)))
            (row(&format!("{name}: speed at its start"), "km/h", once(of(|p| KMH * p.start_speed_mps), 1)))
            (row(&format!("{name}: duration"), "s", once(of(|p| p.duration_s), 0)))
            (row(&format!("{name}: length"), "m", once(of(|p| p.length_m), 0)))
        }
    };
    let line = features.max_effort.as_ref();
    let effort = line.map(|line| line.effort).unwrap_or_default();
    let [effort_count, effort_mean, _] = statistic(&effort, mass_kg / 1e3, 1);
    let effort_sd = number(
        line.and_then(EffortLine::known_sd)
            .map(|sd| sd * mass_kg / 1e3),
        1,
    );
    let window = |[lower, upper]: [Real; 2]| format!("{lower} to {upper} km/h");
    let energy = &features.energy;
    let energies = [
        ("Work of the traction", energy.traction_j_per_kg),
        ("Work of the brake", energy.brake_j_per_kg),
        ("Taken by r0", energy.r0_j_per_kg),
        ("Taken by r1 v", energy.r1_j_per_kg),
        ("Taken by r2 v\u{b2}", energy.r2_j_per_kg),
        ("Taken by the gradient", energy.gradient_j_per_kg),
    ];
    let moved = features.regime_time_s.iter().sum::<Real>() > 0.0;
    html! {
        div.wide { table.features {
            thead { tr {
                th scope="col" { "feature" } th scope="col" { "count" } th scope="col" { "mean" }
                th scope="col" { "standard deviation" } th.text scope="col" { "unit" }
            } }
            tbody {
                (row(&format!("Largest tractive effort, {}", window(config.effort_window_kmh)), "kN", [effort_count, effort_mean, effort_sd]))
                (row("Tractive effort of the fitted line at its lower speed", "kN", once(line.map(|l| l.at_lower_n_per_kg * mass_kg / 1e3), 1)))
                (row("Slope of the fitted line", "kN per m/s", once(line.and_then(EffortLine::known_slope).map(|slope| slope * mass_kg / 1e3), 2)))
                (row(&format!("Tractive power, {}", window(config.power_window_kmh)), "kW", statistic(&features.power_w_per_kg, mass_kg / 1e3, 0)))
                (row(&format!("Largest tractive power, {}", window(config.max_power_window_kmh)), "kW", once(features.max_power_w_per_kg.map(|p| p * mass_kg / 1e3), 0)))
                @for (step, rate) in brake_steps(config).iter().zip(&features.brake_rate_mps2) {
                    (row(&format!("Brake rate, {step}"), "m/s\u{b2}", statistic(rate, 1.0, 3)))
                }
                (row("Cruise speed", "km/h", statistic(&features.cruise_speed_mps, KMH, 1)))
                (row("Cruise speed, median", "km/h", once(features.cruise_speed_median_mps.map(|v| KMH * v), 1)))
                (phase("Final coast", features.final_coast.as_ref()))
                (phase("Final brake", features.final_brake.as_ref()))
                @for (name, j_per_kg) in energies {
                    (row(name, "kWh", once(moved.then_some(j_per_kg * mass_kg / 3.6e6), 1)))
                }
            }
        } }
        p.small {
            "Forces, powers and energies are those per mass times the rotating mass of the train file, "
            (number(mass_kg / 1000.0, 1)) " t."
        }
        (switching_points(features))
    }
}

/// The ATB-EG steps as configured, from the fastest.
fn brake_steps(config: &FeatureConfig) -> [String; 5] {
    let [a, b, c, d] = config.brake_steps_kmh;
    [
        format!("above {a} km/h"),
        format!("{a} to {b} km/h"),
        format!("{b} to {c} km/h"),
        format!("{c} to {d} km/h"),
        format!("below {d} km/h"),
    ]
}

fn switching_points(features: &Features) -> Markup {
    let points = &features.switching_points;
    html! {
        @if !points.is_empty() {
            details {
                summary { (counted(points.len(), "switching point", "switching points")) }
                div.wide { table {
                    thead { tr {
                        th scope="col" { "location" br; span.unit { "km" } }
                        th scope="col" { "speed" br; span.unit { "km/h" } }
                        th.text scope="col" { "from" }
                        th.text scope="col" { "to" }
                    } }
                    tbody { @for point in points {
                        tr {
                            td { (number(point.location_m / 1000.0, 2)) }
                            td { (number(KMH * point.speed_mps, 1)) }
                            td.text { (swatch(point.from)) (point.from.as_str()) }
                            td.text { (swatch(point.to)) (point.to.as_str()) }
                        }
                    } }
                } }
                @if features.switching_points_lost > 0 {
                    p.small { (features.switching_points_lost) " more were not kept." }
                }
            }
        }
    }
}

/// Where the runs without figures are.
fn others(report: &Report) -> Markup {
    let others = report.runs.get(RUNS_IN_FULL..).unwrap_or_default();
    html! {
        @if let Some(first) = others.first() {
            section id="others" {
                h2 { "The other runs" }
                p {
                    "The first " (RUNS_IN_FULL) " of " (report.runs.len()) " runs are shown in full. The " (counted(others.len(), "other", "others")) ", from "
                    (first.name) " on, are in the table of runs, in " code { "features.csv" } ", " code { "parameters.csv" } " and one "
                    code { ".estimates.csv" } " each. For their figures replay them on their own, " code { "rundown replay ... " (first.name) ".csv" }
                    ". Replayed on its own a run begins with the manufacturer's values and not with what the runs before it taught."
                }
            }
        }
    }
}

fn reading_aids() -> Markup {
    html! {
        section id="reading-aids" {
            h2 { "How to read this" }
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
            }
        }
    }
}

/// A picture with its words below; it scrolls where the screen is too narrow to read it.
fn figure(svg: String, caption: &str) -> Markup {
    html! {
        figure {
            div.wide { (PreEscaped(svg)) }
            figcaption { (caption) }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::example::{Example, report, train};
    use super::*;
    use rundown::state;

    /// What no page may hold, whatever the runs were.
    fn check(page: &str) {
        for word in ["NaN", "inf ", ">inf<", "http", "<script", "url(", "@import"] {
            assert!(!page.contains(word), "{word}");
        }
        for tag in [
            "section", "figure", "table", "svg", "tr", "td", "div", "details",
        ] {
            let (open, close) = (format!("<{tag}"), format!("</{tag}>"));
            let begins = |at: usize| !page[at + open.len()..].starts_with(char::is_alphanumeric);
            let opened = page
                .match_indices(&open)
                .filter(|(at, _)| begins(*at))
                .count();
            assert_eq!(opened, page.matches(&close).count(), "{tag}");
        }
    }

    fn of(runs: &[Example]) -> String {
        let page = html(&report(runs, &train()));
        check(&page);
        page
    }

    #[test]
    fn every_section_is_there_and_linked() {
        let mut second = Example::run();
        second.name = "run02".to_owned();
        let page = of(&[Example::run(), second]);
        for id in [
            "summary",
            "resistance",
            "runs",
            "run-1",
            "run-2",
            "reading-aids",
        ] {
            assert!(page.contains(&format!("id=\"{id}\"")), "{id}");
        }
        assert!(page.contains("href=\"#run-2\""));
        assert!(!page.contains("id=\"others\""));
        for heading in [
            "Driving regimes",
            "Motion and resistance parameters",
            "Terms of the running resistance",
            "Innovations",
            "Use of the readings",
            "Features",
        ] {
            assert_eq!(
                page.matches(&format!("<h3>{heading}</h3>")).count(),
                2,
                "{heading}"
            );
        }
        assert_eq!(page.matches("<svg").count(), 2 + 2 * 5);
        assert!(page.contains("lack a reading that could be used"));
        assert!(page.contains("the speed was not sent"));
    }

    #[test]
    fn the_headline_says_what_was_learned() {
        let page = of(&[Example::run()]);
        assert!(page.contains("1 run was replayed"));
        // r(100 km/h) = 7.1e-3 + 1.5e-4 * 27.78 + 2.7e-5 * 27.78² = 0.03210, stated 0.03343.
        assert!(page.contains("at 100\u{a0}km/h 0.03210\u{a0}N/kg"));
        assert!(page.contains("4.0\u{a0}% below the manufacturer's 0.03343"));
        assert!(page.contains("of the time, at 80 to 130 km/h"));
    }

    #[test]
    fn without_a_run_there_is_no_estimate() {
        let page = of(&[]);
        assert!(page.contains("No run was replayed"));
        assert!(page.contains("no estimate"));
    }

    #[test]
    fn an_empty_run_says_why() {
        let mut dropped = Example::empty();
        dropped.counters.time_not_increasing = 7;
        let page = of(&[Example::empty(), dropped]);
        assert!(page.contains("no estimate: the run has no usable sample"));
        assert!(page.contains("all 7 samples were dropped"));
    }

    #[test]
    fn one_or_two_samples_are_a_page_too() {
        for count in [1, 2] {
            let page = of(&[Example::first(count)]);
            let word = if count == 1 {
                "1 sample over"
            } else {
                "2 samples over"
            };
            assert!(page.contains(word));
        }
        assert!(of(&[Example::first(1)]).contains("no value: it takes two samples"));
        of(&[Example::standing()]);
    }

    #[test]
    fn numbers_that_are_not_finite_leave_gaps() {
        let nan = Real::NAN;
        let mut run = Example::run();
        for estimate in run.estimates.iter_mut().skip(20).step_by(7) {
            estimate.belief.mean[state::SPEED] = nan;
            estimate.belief.covariance[(state::R1, state::R1)] = Real::INFINITY;
            estimate.effort_n_per_kg = Some(nan);
            estimate.gradient_n_per_kg = nan;
        }
        for estimate in run.estimates.iter_mut().skip(40).step_by(11) {
            estimate.belief.mean[state::LOCATION] = nan;
            estimate.time_s = nan;
            estimate.dt_s = nan;
        }
        run.features.power_w_per_kg.mean = nan;
        run.features.regime_time_s[0] = nan;
        of(&[run.clone()]);
        for estimate in &mut run.estimates {
            estimate.belief.mean.fill(nan);
            estimate.belief.covariance.fill(nan);
            estimate.time_s = nan;
        }
        let page = of(&[run]);
        assert!(page.contains("no estimate: no value is finite"));
        let mut report_of_nan = report(&[], &train()).vehicle;
        report_of_nan.push((
            "run01".to_owned(),
            Gaussian::independent([nan; 3], [1.0; 3]),
        ));
        let page = html(&Report {
            title: String::new(),
            train: &train(),
            runs: Vec::new(),
            mode: "gated",
            features: FeatureConfig::default(),
            vehicle: report_of_nan,
        });
        check(&page);
        assert!(page.contains("left behind is not finite"));
    }

    #[test]
    fn windows_are_those_of_the_configuration() {
        let (train, runs) = (train(), [Example::run()]);
        let config = FeatureConfig {
            effort_window_kmh: [5.0, 35.0],
            power_window_kmh: [45.0, 100.0],
            max_power_window_kmh: [60.5, 95.0],
            brake_steps_kmh: [160.0, 120.0, 90.0, 45.0],
            ..FeatureConfig::default()
        };
        let mut report = report(&runs, &train);
        let paper = [
            "10 to 30 km/h",
            "50 to 130 km/h",
            "50 to 90 km/h",
            "above 130 km/h",
            "80 to 60 km/h",
        ];
        let own = [
            "5 to 35 km/h",
            "45 to 100 km/h",
            "60.5 to 95 km/h",
            "above 160 km/h",
            "120 to 90 km/h",
        ];
        let page = html(&report);
        assert!(
            paper
                .iter()
                .all(|label| page.contains(&format!(", {label}<")))
        );
        report.features = config;
        let page = html(&report);
        assert!(
            own.iter()
                .all(|label| page.contains(&format!(", {label}<")))
        );
        assert!(
            !paper
                .iter()
                .any(|label| page.contains(&format!(", {label}<")))
        );
    }

    #[test]
    fn names_and_warnings_are_escaped() {
        let mut run = Example::run();
        run.name = "<script>alert('x')</script> & \"co\"".to_owned();
        run.warnings.push("line 3: <b>bold</b>".to_owned());
        let page = of(&[run]);
        assert!(page.contains("&lt;script&gt;"));
        assert!(!page.contains("<b>bold"));
    }

    #[test]
    fn beyond_the_first_runs_it_says_where_the_others_are() {
        let runs: Vec<Example> = (1..=RUNS_IN_FULL + 2)
            .map(|index| Example {
                name: format!("run{index:02}"),
                ..Example::first(3)
            })
            .collect();
        let page = of(&runs);
        assert!(page.contains("id=\"others\"") && page.contains("rundown replay ... run13.csv"));
        assert!(page.contains("id=\"run-12\"") && !page.contains("id=\"run-13\""));
        assert!(!page.contains("href=\"#run-13\""));
        assert_eq!(page.matches(">run14<").count(), 1, "the table has it");
    }

    #[test]
    fn the_reference_mode_warns() {
        let train = train();
        let runs = [Example::run()];
        let mut report = report(&runs, &train);
        assert!(!html(&report).contains("reference mode"));
        assert!(html(&report).contains("resistance was learned over"));
        report.mode = "paper";
        let page = html(&report);
        assert!(
            page.contains("does not follow")
                && page.contains("The filter corrected r0, r1 and r2 over")
        );
        assert!(!page.contains("resistance was learned over"));
    }
}
