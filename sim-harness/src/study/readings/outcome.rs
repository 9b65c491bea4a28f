//! The comparison as a table on the screen, as records, and as a page.

use super::comparison::{Compared, Plan};
use super::remarks::{REMARKS, SMALL_MPS2, STRONG_MPS2, TRIED};
use crate::study::figures::Picture;
use crate::study::moments::Moments;
use maud::{Markup, html};
use rundown_files::table::{Cell, Record};
use rundown_pages::numbers::number;
use rundown_pages::shell::{Section, column, document, figure, sortable, text_column};

pub fn records(all: &[Compared]) -> Vec<Record> {
    all.iter().map(record).collect()
}

fn record(one: &Compared) -> Record {
    let (reading, recorder) = (one.combination.reading, one.combination.recorder);
    let mut record: Record = [
        ("effort", reading.effort()),
        ("gradient", reading.gradient_word()),
        ("initial_values", reading.initial_word()),
        ("points", reading.points_word()),
        ("speed", recorder.speed_word()),
    ]
    .map(|(name, word)| (name.to_owned(), Cell::from(word)))
    .to_vec();
    let mut push = |name: &str, value: Option<f64>| record.push((name.to_owned(), Cell::from(value)));
    push("skew_s", Some(recorder.skew_s));
    push("seeds", Some(one.judged.len() as f64));
    push("remarks_that_hold", Some(one.remarks()));
    for (name, moments) in [
        ("log_likelihood_per_sample", one.moments(|judged| judged.log_likelihood_per_sample)),
        ("gain_of_best_initial_values_nats_per_sample", one.gains()),
        ("speed_rms_kmh", one.moments(|judged| judged.rms_kmh)),
        ("r0_quantile_01", one.moments(|judged| judged.r0_ends[0])),
        ("r0_quantile_99", one.moments(|judged| judged.r0_ends[1])),
        ("skewness_r0", one.moments(|judged| judged.skewness[0])),
        ("skewness_r1", one.moments(|judged| judged.skewness[1])),
        ("skewness_r2", one.moments(|judged| judged.skewness[2])),
    ] {
        push(name, moments.mean());
        push(&format!("{name}_sd"), moments.sd());
    }
    for (index, factor) in ["10", "100"].iter().enumerate() {
        for (coefficient, name) in ["r0", "r1", "r2"].iter().enumerate() {
            let share = one.moments(|judged| judged.negative[index][coefficient]).mean();
            push(&format!("negative_runs_share_sd_{name}_x{factor}"), share);
        }
    }
    for (index, kind) in ["q", "drawn"].iter().enumerate() {
        for (place, mps2) in SMALL_MPS2.iter().enumerate() {
            push(&format!("way_of_r0_{kind}_{mps2}"), one.moments(|judged| judged.noise[index].way[place]).mean());
        }
        for (place, mps2) in STRONG_MPS2.iter().enumerate() {
            let share = one.moments(|judged| judged.noise[index].strong_negative[place]).mean();
            push(&format!("negative_runs_share_{kind}_{mps2}"), share);
        }
    }
    for ((name, _), share) in REMARKS.iter().zip(one.shares()) {
        push(&format!("holds_{}", name.replace(' ', "_")), Some(share));
    }
    record
}

/// The combinations, those with the most remarks first.
fn ranked(all: &[Compared]) -> Vec<&Compared> {
    let mut ranked: Vec<&Compared> = all.iter().collect();
    ranked.sort_by(|a, b| b.remarks().total_cmp(&a.remarks()));
    ranked
}

pub fn screen(all: &[Compared]) -> String {
    let mut text = format!(
        "{:8} {:5} {:10} {:7} {:9} {:>6}  {:>7} {:>9} {:>10} {:>8} {:>15}  remarks in all / some seeds\n",
        "effort",
        "grad.",
        "Table 1",
        "points",
        "speed",
        "skew,s",
        "remarks",
        "log p",
        "nats a sample",
        "rms km/h",
        "r0, 1e-3 N/kg"
    );
    for one in ranked(all) {
        let (reading, recorder) = (one.combination.reading, one.combination.recorder);
        let mean = |moments: Moments, digits| number(moments.mean(), digits);
        let end = |index: usize| number(one.moments(|j| j.r0_ends[index]).mean().map(|r0| 1e3 * r0), 3);
        let mark = |share: f64| match share {
            s if s >= 1.0 => '1',
            s if s > 0.0 => '~',
            _ => '.',
        };
        text += &format!(
            "{:8} {:5} {:10} {:7} {:9} {:>6}  {:>7} {:>9} {:>10} {:>8} {:>15}  {}\n",
            reading.effort(),
            reading.gradient_word(),
            reading.initial_word(),
            reading.points_word(),
            recorder.speed_word(),
            recorder.skew_s,
            number(one.remarks(), 1),
            mean(one.moments(|j| j.log_likelihood_per_sample), 2),
            mean(one.gains(), 2),
            mean(one.moments(|j| j.rms_kmh), 2),
            format!("{}..{}", end(0), end(1)),
            one.shares().map(mark).iter().collect::<String>(),
        );
    }
    text += "\nremarks, in this order (1 in all seeds, ~ in some, . in none):\n";
    for (name, statement) in REMARKS {
        text += &format!("  {name:13} {statement}\n");
    }
    text + "log p: logarithm of the likelihood a sample. nats a sample: what the best initial deviations would add to it.\n"
}

pub fn page(plan: &Plan, all: &[Compared], pictures: &[Picture]) -> String {
    let lead = html! {
        p.lead {
            "Readings of section 4.2 of the paper and recorders it does not exclude, compared on " (plan.seeds) " sets of " (plan.runs)
            " simulated runs: which of its " (REMARKS.len()) " remarks on the filter hold, and how far Table 1 is from the initial deviations that the paper's criterion prefers."
        }
    };
    let remarks = html! {
            p { "A remark that can be read in two ways stands here twice. The last six try other settings on the first " (TRIED) " runs of each set." }
            ul { @for (name, statement) in REMARKS { li { strong { (name) } ": " (statement) } } }
    };
    let pictures = html! { @for picture in pictures { (figure(&picture.drawing, &picture.caption)) } };
    let sections = [
        Section::new("pictures", "Over the skew", pictures),
        Section::new("comparison", "All combinations", comparison(all)),
        Section::new("remarks", "The remarks", remarks),
    ];
    document("Readings of the paper compared", &lead, &sections)
}

fn comparison(all: &[Compared]) -> Markup {
    let words = ["effort", "gradient", "Table 1", "\u{3b1}, \u{3b2}, \u{3ba}", "speed"].map(text_column);
    let numbers = [
        column("skew", "s"),
        column("remarks", "mean over seeds"),
        column("log-likelihood", "a sample"),
        column("best initial deviations", "nats a sample"),
        column("filtered less read", "km/h, rms"),
        column("r0, 1 % quantile", "10\u{207b}\u{b3} N/kg"),
        column("99 %", "10\u{207b}\u{b3} N/kg"),
    ];
    let remarks = REMARKS.map(|(name, _)| column(name, "share"));
    let with_sd = |moments: &Moments, unit: f64, digits| {
        let [mean, sd] = [moments.mean(), moments.sd()].map(|value| number(value.map(|v| v / unit), digits));
        format!("{mean} \u{b1} {sd}")
    };
    let rows = html! { @for one in ranked(all) {
        @let (reading, recorder) = (one.combination.reading, one.combination.recorder);
        tr {
            th scope="row" { (reading.effort()) }
            td.text { (reading.gradient_word()) }
            td.text { (reading.initial_word()) }
            td.text { (reading.points_word()) }
            td.text { (recorder.speed_word()) }
            td { (recorder.skew_s) }
            td { (number(one.remarks(), 1)) }
            td { (with_sd(&one.moments(|j| j.log_likelihood_per_sample), 1.0, 2)) }
            td { (with_sd(&one.gains(), 1.0, 2)) }
            td { (with_sd(&one.moments(|j| j.rms_kmh), 1.0, 2)) }
            td { (with_sd(&one.moments(|j| j.r0_ends[0]), 1e-3, 3)) }
            td { (with_sd(&one.moments(|j| j.r0_ends[1]), 1e-3, 3)) }
            @for share in one.shares() { td { (number(share, 2)) } }
        }
    } };
    html! {
            (sortable(words.into_iter().chain(numbers).chain(remarks), rows))
            p.small { "Mean \u{b1} standard deviation over the seeds. Likelihoods compare readings of the same recorder; between recorders the data differ." }
    }
}
