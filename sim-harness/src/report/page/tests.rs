//! What no page may hold, and what every page must.

use super::super::example::{self, report, train};
use super::*;
use crate::logs::Failed;
use rundown::estimator::config::Mode;
use rundown::{Real, features::FeatureConfig, filter::gaussian::Gaussian, model::state};
use rundown_files::replay::ReplayedRun;
use rundown_pages::assets::SCRIPT;

/// What no page may hold, whatever the runs were.
fn check(page: &str) {
    let page = page.replace(SCRIPT, "");
    for word in ["NaN", "inf ", ">inf<", "http", "url(", "@import"] {
        assert!(!page.contains(word), "{word}");
    }
    for tag in ["section", "figure", "table", "svg", "tr", "td", "div", "details", "script"] {
        let (open, close) = (format!("<{tag}"), format!("</{tag}>"));
        let begins = |at: usize| !page[at + open.len()..].starts_with(char::is_alphanumeric);
        let opened = page.match_indices(&open).filter(|(at, _)| begins(*at)).count();
        assert_eq!(opened, page.matches(&close).count(), "{tag}");
    }
    for data in page.split("<script type=\"application/json\">").skip(1) {
        let (json, _) = data.split_once("</script>").unwrap();
        assert!(serde_json::from_str::<serde_json::Value>(json).is_ok(), "{json}");
    }
}

/// The page of all runs, and the page of each.
fn pages(report: &Report) -> (String, Vec<String>) {
    let first = html(report);
    let of_runs: Vec<String> = (0..report.runs.len()).map(|index| run_html(index, report)).collect();
    of_runs.iter().chain([&first]).for_each(|page| check(page));
    (first, of_runs)
}

fn of(runs: &[ReplayedRun]) -> (String, Vec<String>) {
    pages(&report(runs, &train()))
}

#[test]
fn every_section_is_there_and_linked() {
    let mut second = example::run();
    second.name = "run02".to_owned();
    let (first, of_runs) = of(&[example::run(), second]);
    let linked = |page: &str, id: &str| {
        assert!(page.contains(&format!("id=\"{id}\"")) && page.contains(&format!("href=\"#{id}\"")), "{id}");
    };
    ["resistance", "runs", "reading-aids"].iter().for_each(|id| linked(&first, id));
    assert!(first.contains("id=\"summary\"") && first.contains("href=\"report/run0002.html\">run02<"));
    assert_eq!(first.matches("<svg").count(), 2);
    for page in &of_runs {
        ["regimes", "motion", "terms", "innovations", "readings", "features"].iter().for_each(|id| linked(page, id));
        assert_eq!(page.matches("<svg").count(), 5);
        assert!(page.contains("lack a reading that could be used") && page.contains("the speed was not sent"));
    }
    assert!(of_runs[0].contains("href=\"run0002.html\">next: run02<") && !of_runs[0].contains(">before: "));
    assert!(of_runs[1].contains("href=\"run0001.html\">before: run01<") && !of_runs[1].contains(">next: "));
}

#[test]
fn a_figure_of_a_run_goes_over_location_and_time() {
    let (_, of_runs) = of(&[example::run(), example::standing()]);
    let both = "\"views\":[{\"name\":\"location\"";
    assert_eq!(of_runs[0].matches(both).count(), 3);
    assert!(!of_runs[1].contains(both));
}

#[test]
fn the_headline_says_what_was_learned() {
    let run = example::run();
    let (page, _) = of(std::slice::from_ref(&run));
    assert!(page.contains("1 run was replayed"));
    // r(100 km/h) = 7.1e-3 + 1.5e-4 * 27.78 + 2.7e-5 * 27.78² = 0.03210, stated 0.03343.
    assert!(page.contains("at 100\u{a0}km/h 0.03210\u{a0}N/kg"));
    assert!(page.contains("4.0\u{a0}% below the manufacturer's 0.03343"));
    let speeds_mps = RunView::of(&run, None).learned().speeds_mps.unwrap();
    let [least, largest] = [speeds_mps.start, speeds_mps.end].map(|mps| number(KMH * mps, 0));
    assert!(page.contains(&format!("of the time, at {least} to {largest} km/h")));
}

#[test]
fn without_a_run_there_is_no_estimate() {
    let (page, _) = of(&[]);
    assert!(page.contains("No run was replayed"));
    assert!(page.contains("no estimate"));
}

#[test]
fn an_empty_run_says_why() {
    let mut dropped = example::empty();
    dropped.summary.counters.time_not_increasing = 7;
    let (page, _) = of(&[example::empty(), dropped]);
    assert!(page.contains("no estimate: the run has no usable sample"));
    assert!(page.contains("all 7 samples were dropped"));
}

#[test]
fn one_or_two_samples_are_a_page_too() {
    for count in [1, 2] {
        let (_, page) = of(&[example::first(count)]);
        let word = if count == 1 { "1 sample over" } else { "2 samples over" };
        assert!(page[0].contains(word));
    }
    assert!(of(&[example::first(1)]).1[0].contains("no value: it takes two samples"));
    of(&[example::standing()]);
}

#[test]
fn numbers_that_are_not_finite_leave_gaps() {
    let nan = Real::NAN;
    let mut run = example::run();
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
    run.summary.features.power_w_per_kg.mean = nan;
    run.summary.features.regime_time_s[0] = nan;
    of(&[run.clone()]);
    for estimate in &mut run.estimates {
        estimate.belief.mean.fill(nan);
        estimate.belief.covariance.fill(nan);
        estimate.time_s = nan;
    }
    let (_, page) = of(&[run]);
    assert!(page[0].contains("no estimate: no value is finite"));
    let after = vec![("run01".to_owned(), Gaussian::independent([nan; 3], [1.0; 3]))];
    let page = html(&Report {
        title: String::new(),
        vehicles: vec![Vehicle { unit: String::new(), after }],
        ..report(&[], &train())
    });
    check(&page);
    assert!(page.contains("left behind is not finite"));
}

#[test]
fn notes_and_logs_that_could_not_be_used_are_on_the_page() {
    let (runs, train) = ([example::run()], train());
    let mut report = report(&runs, &train);
    assert!(!html(&report).contains("id=\"notes\"") && !html(&report).contains("id=\"failed\""));
    let notes = ["speeds are truncated <1 km/h>".to_owned()];
    let failed = [Failed { file: "b.csv".into(), error: "b.csv: expected a header".to_owned(), refusal: None }];
    (report.notes, report.failed) = (&notes, &failed);
    let page = html(&report);
    check(&page);
    assert!(page.contains("<li>speeds are truncated &lt;1 km/h&gt;</li>"));
    assert!(page.contains("1 log could not be used:") && page.contains("<li><div>b.csv: expected a header</div></li>"));
}

#[test]
fn the_table_of_runs_has_the_resistance_at_a_speed_that_was_reached() {
    let (mut run, train) = (example::run(), train());
    let cell = |run: &ReplayedRun, speed_kmh: Real| {
        let r = Resistance::at(&run.vehicle_after, KmPerHour(speed_kmh).to_mps()).unwrap();
        format!("{} \u{b1} {}", number(r.mean_n_per_kg, 5), number(r.upper() - r.mean_n_per_kg, 5))
    };
    let page = html(&report(std::slice::from_ref(&run), &train));
    assert!(page.contains("r(100\u{a0}km/h)<br><span class=\"unit\">N/kg, 95 % interval"));
    assert!(page.contains(&cell(&run, 100.0)), "{}", cell(&run, 100.0));
    // A tram that coasts from 57 km/h.
    for estimate in &mut run.estimates {
        let speed_mps = &mut estimate.belief.mean[state::SPEED];
        *speed_mps = speed_mps.min(57.0 / 3.6);
    }
    let page = html(&report(std::slice::from_ref(&run), &train));
    assert!(page.contains("r(50\u{a0}km/h)<br>") && page.contains(&cell(&run, 50.0)));
    let mut in_papers = report(std::slice::from_ref(&run), &train);
    in_papers.mode = Mode::Paper;
    assert!(!html(&in_papers).contains(&cell(&run, 50.0)), "its interval is no measure");
}

#[test]
fn each_unit_of_a_fleet_has_its_own_resistance() {
    let unit = |unit: &str, r0: Real| {
        let after = vec![("run01".to_owned(), Gaussian::independent([r0, 1.5e-4, 2.7e-5], [4e-4, 1e-5, 5e-7]))];
        Vehicle { unit: unit.to_owned(), after }
    };
    let train = train();
    let mut report = report(&[], &train);
    report.vehicles = vec![unit("201", 7e-3), unit("202", 12e-3)];
    let page = html(&report);
    check(&page);
    assert!(page.contains("The runs are of 2 units") && !page.contains("After the last run"));
    let row =
        |unit: &str| page.split(&format!(">{unit}</th>")).nth(1).unwrap().split("</tr>").next().unwrap().to_owned();
    let r = |belief: &Vehicle| {
        number(Resistance::at(belief.last().unwrap(), KmPerHour(60.0).to_mps()).unwrap().mean_n_per_kg, 5)
    };
    for vehicle in &report.vehicles {
        assert!(row(&vehicle.unit).contains(&format!(">{} (", r(vehicle))), "{}", row(&vehicle.unit));
        assert!(page.contains(&format!("<h3>unit {}</h3>", vehicle.unit)));
    }
    assert_ne!(r(&report.vehicles[0]), r(&report.vehicles[1]));
    assert_eq!(page.matches("<figure").count(), 2, "a curve for each");
}

#[test]
fn windows_are_those_of_the_configuration() {
    let (train, runs) = (train(), [example::run()]);
    let config = FeatureConfig {
        effort_window_kmh: [5.0, 35.0],
        power_window_kmh: [45.0, 100.0],
        max_power_window_kmh: [60.5, 95.0],
        brake_steps_kmh: [160.0, 120.0, 90.0, 45.0],
        ..FeatureConfig::default()
    };
    let mut report = report(&runs, &train);
    let paper = ["10 to 30 km/h", "50 to 130 km/h", "50 to 90 km/h", "above 130 km/h", "80 to 60 km/h"];
    let own = ["5 to 35 km/h", "45 to 100 km/h", "60.5 to 95 km/h", "above 160 km/h", "120 to 90 km/h"];
    let page = run_html(0, &report);
    assert!(paper.iter().all(|label| page.contains(&format!(", {label}<"))));
    report.features = config;
    let page = run_html(0, &report);
    assert!(own.iter().all(|label| page.contains(&format!(", {label}<"))));
    assert!(!paper.iter().any(|label| page.contains(&format!(", {label}<"))));
}

#[test]
fn names_and_warnings_are_escaped() {
    let mut run = example::run();
    run.name = "<script>alert('x')</script> & \"co\"".to_owned();
    run.warnings.push("line 3: <b>bold</b>".to_owned());
    let (first, of_run) = of(&[run]);
    for page in [&first, &of_run[0]] {
        assert!(page.contains("&lt;script&gt;"));
        assert!(!page.contains("<b>bold") && !page.contains("<script>alert"));
    }
}

#[test]
fn the_reference_mode_warns() {
    let train = train();
    let runs = [example::run()];
    let mut report = report(&runs, &train);
    assert!(!html(&report).contains("reference mode"));
    assert!(html(&report).contains("resistance was learned over"));
    assert!(html(&report).contains("(95\u{a0}% between"));
    report.mode = Mode::Paper;
    let page = html(&report);
    assert!(page.contains("does not follow") && page.contains("The filter corrected r0, r1 and r2 over"));
    assert!(!page.contains("resistance was learned over"));
    assert!(!page.contains("(95\u{a0}% between"), "the filter's interval is none of the vehicle");
}
