//! The comparison as a table on the screen, as records, and as a page.

use super::comparison::Compared;
use super::reading::{Combination, Gradient, Initial, Reading, SigmaPoints};
use super::remarks::{JudgedRuns, REMARKS, SMALL_MPS2, STRONG_MPS2, TRIED};
use crate::output::markdown::{cells, table};
use crate::study::figures::Picture;
use crate::study::moments::Moments;
use maud::{Markup, html};
use rundown_files::column::Column;
use rundown_pages::numbers::number;
use rundown_pages::shell::{Section, choice_column, column, document, figure, sortable};

/// The columns of `readings.csv`.
pub fn columns() -> Vec<Column<Compared>> {
    let word = |name: &str, meaning: &str, of: fn(&Combination) -> &'static str| {
        Column::text(name, meaning, move |one: &Compared| of(&one.combination))
    };
    let share = "share of the seeds in which the remark holds:";
    let mut columns = vec![
        word("effort", "which samples an effort is computed from: `backward` or `forward`", |c| c.reading.effort()),
        word("gradient", "where the gradient is read", |c| c.reading.gradient_word()),
        word("initial_values", "what the initial values of Table 1 are", |c| c.reading.initial_word()),
        word("points", "how the sigma points are spread", |c| c.reading.points_word()),
        word("speed", "how the recorder gives whole km/h", |c| c.recorder.speed_word()),
        Column::number("skew_s", "s", "how much older the speed is than the location", |one: &Compared| {
            one.combination.recorder.skew_s
        }),
        Column::count("seeds", "sets of runs", |one: &Compared| one.judged.len()),
        Column::number("remarks_that_hold", "1", "remarks of section 4.2 that hold, mean over the seeds", |one| {
            Compared::remarks(one)
        }),
        Column::count("remarks_judged", "remarks that are judged", Compared::of_remarks),
    ];
    columns.extend(quantities());
    columns.extend(trials());
    columns.extend(REMARKS.iter().enumerate().map(|(index, (name, statement))| {
        let of = move |one: &Compared| one.shares()[index];
        Column::number(&format!("holds_{}", name.replace(' ', "_")), "1", &format!("{share} {statement}"), of)
            .empty_when("recorded runs say nothing of it")
    }));
    columns
}

/// Mean and standard deviation over the seeds of what a filter gives.
fn quantities() -> Vec<Column<Compared>> {
    type Of = fn(&Compared) -> Moments;
    let all: [(&str, &'static str, &str, Of); 8] = [
        ("log_likelihood_per_sample", "1", "logarithm of the likelihood of a sample", |one| {
            one.moments(|judged| judged.log_likelihood_per_sample)
        }),
        (
            "gain_of_best_initial_values_nats_per_sample",
            "nat",
            "what the best initial deviations would add to the logarithm of the likelihood of a sample",
            Compared::gains,
        ),
        ("speed_rms_kmh", "km/h", "root mean square of filtered less read speed", |one| one.moments(|j| j.rms_kmh)),
        ("r0_quantile_01", "N/kg", "1 % quantile of r0", |one| one.moments(|judged| judged.r0_ends[0])),
        ("r0_quantile_99", "N/kg", "99 % quantile of r0", |one| one.moments(|judged| judged.r0_ends[1])),
        ("skewness_r0", "1", "skewness of r0", |one| one.moments(|judged| judged.skewness[0])),
        ("skewness_r1", "1", "skewness of r1", |one| one.moments(|judged| judged.skewness[1])),
        ("skewness_r2", "1", "skewness of r2", |one| one.moments(|judged| judged.skewness[2])),
    ];
    let both = |(name, unit, meaning, of): (&str, &'static str, &str, Of)| {
        let deviation = "standard deviation of it over the seeds";
        [
            Column::number(name, unit, &format!("{meaning}, mean over the seeds"), move |one: &Compared| {
                of(one).mean()
            }),
            Column::number(&format!("{name}_sd"), unit, deviation, move |one: &Compared| of(one).sd())
                .empty_when("there is one seed"),
        ]
    };
    all.into_iter().flat_map(both).collect()
}

/// What other settings of the filter give, mean over the seeds.
fn trials() -> Vec<Column<Compared>> {
    let negative = "share of the runs with a negative coefficient with";
    let mut columns = Vec::new();
    let number = |name: String, meaning: String, of: Box<dyn Fn(&JudgedRuns) -> f64 + Send + Sync>| {
        Column::number(&name, "1", &meaning, move |one: &Compared| one.moments(&of).mean())
    };
    for (index, factor) in ["10", "100"].into_iter().enumerate() {
        for (place, name) in ["r0", "r1", "r2"].into_iter().enumerate() {
            let meaning = format!("{negative} {factor} times the initial deviation of {name}");
            let of = move |judged: &JudgedRuns| judged.negative[index][place];
            columns.push(number(format!("negative_runs_share_sd_{name}_x{factor}"), meaning, Box::new(of)));
        }
    }
    for (index, (kind, where_to)) in [("q", "in Q"), ("drawn", "drawn")].into_iter().enumerate() {
        for (place, mps2) in SMALL_MPS2.iter().enumerate() {
            let meaning = format!(
                "what r0 covers with {mps2} m/s\u{b2} of acceleration noise {where_to}, as a multiple of that without"
            );
            let of = move |judged: &JudgedRuns| judged.noise[index].way[place];
            columns.push(number(format!("way_of_r0_{kind}_{mps2}"), meaning, Box::new(of)));
        }
        for (place, mps2) in STRONG_MPS2.iter().enumerate() {
            let meaning = format!("{negative} {mps2} m/s\u{b2} of acceleration noise {where_to}");
            let of = move |judged: &JudgedRuns| judged.noise[index].strong_negative[place];
            columns.push(number(format!("negative_runs_share_{kind}_{mps2}"), meaning, Box::new(of)));
        }
    }
    columns
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
    for one in all {
        let (reading, recorder) = (one.combination.reading, one.combination.recorder);
        let mean = |moments: Moments, digits| number(moments.mean(), digits);
        let end = |index: usize| number(one.moments(|j| j.r0_ends[index]).mean().map(|r0| 1e3 * r0), 3);
        let mark = |share: Option<f64>| match share {
            None => '-',
            Some(s) if s >= 1.0 => '1',
            Some(s) if s > 0.0 => '~',
            Some(_) => '.',
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
    text += "\nremarks, in this order (1 in all seeds, ~ in some, . in none, - not judged):\n";
    for (name, statement) in REMARKS {
        text += &format!("  {name:13} {statement}\n");
    }
    text + "log p: logarithm of the likelihood a sample. nats a sample: what the best initial deviations would add to it.\n"
}

/// `readings.md`: what [`screen`] has, and what larger initial deviations do.
pub fn markdown(all: &[Compared]) -> String {
    let head = cells([
        "effort",
        "speed",
        "older by, s",
        &format!("remarks, of {}", all.first().map_or(REMARKS.len(), Compared::of_remarks)),
        "filtered less read, km/h",
        "r0, 1 to 99 % quantile, 10\u{207b}\u{b3} N/kg",
        "negative runs, deviation of r0 \u{d7} 100",
        "log-likelihood a sample",
        "best initial deviations, nats a sample",
    ]);
    let row = |one: &Compared| {
        let Combination { reading, recorder } = one.combination;
        let end = |index: usize| number(one.moments(|j| j.r0_ends[index]).mean().map(|r0| 1e3 * r0), 3);
        // Large ones are known to the unit, small ones to a tenth.
        let nats =
            |moments: Moments| number(moments.mean(), usize::from(moments.mean().is_some_and(|n| n.abs() < 10.0)));
        vec![
            reading.words(),
            recorder.speed_word().to_owned(),
            number(recorder.skew_s, 0),
            number(one.remarks(), 1),
            number(one.moments(|j| j.rms_kmh).mean(), 2),
            format!("{} to {}", end(0), end(1)),
            number(one.moments(|j| j.negative[1][0]).mean(), 2),
            nats(one.moments(|j| j.log_likelihood_per_sample)),
            nats(one.gains()),
        ]
    };
    table(&head, &all.iter().map(row).collect::<Vec<_>>())
}

/// `on`: what they are compared on; `notes`: what a person must know of it.
pub fn page(on: &str, notes: &[String], all: &[Compared], pictures: &[Picture]) -> String {
    let judged = all.first().map_or(REMARKS.len(), Compared::of_remarks);
    let lead = html! {
        p.lead {
            "Readings of section 4.2 of the paper and recorders it does not exclude, compared on " (on)
            ": which of its remarks on the filter hold (" (judged) " of " (REMARKS.len())
            " are judged), and how far Table 1 is from the initial deviations that the paper's criterion prefers."
        }
        @for note in notes { p.note { (note) } }
    };
    let remarks = html! {
            p { "A remark that can be read in two ways stands here twice. The last six try other settings on the first " (TRIED) " runs of each set." }
            ol { @for (name, statement) in REMARKS { li { strong { (name) } ": " (statement) } } }
            p { "Share of the seeds in which each holds:" }
            (by_remark(all))
    };
    let pictures = html! { @for picture in pictures { (figure(&picture.drawing, &picture.caption)) } };
    let sections = [
        Section::new("pictures", "Over the skew", pictures),
        Section::new("comparison", "All combinations", comparison(all)),
        Section::new("remarks", "The remarks", remarks),
    ];
    document("Readings of the paper compared", &lead, &sections)
}

/// In the order in which they are listed: a rank by remarks alone would be a verdict, and likelihoods of two recorders
/// have no order.
fn comparison(all: &[Compared]) -> Markup {
    let head = [
        choice_column("reading"),
        choice_column("speed"),
        column("older by", "s"),
        column("remarks", "mean over seeds"),
        column("log-likelihood", "a sample"),
        column("best deviations", "nats a sample"),
        column("filtered less read", "km/h, rms"),
        column("r0, 1 to 99 %", "10\u{207b}\u{b3} N/kg"),
    ];
    let with_sd = |moments: &Moments, digits| {
        // What is large is known to the unit.
        let digits = if moments.mean().is_some_and(|mean| mean.abs() >= 10.0) { 0 } else { digits };
        let mean = number(moments.mean(), digits);
        moments.sd().map_or(mean.clone(), |sd| format!("{mean} \u{b1} {}", number(sd, digits)))
    };
    let end = |one: &Compared, index: usize| number(one.moments(|j| j.r0_ends[index]).mean().map(|r0| 1e3 * r0), 3);
    let rows = html! { @for one in all { tr {
        (named(one))
        td { (number(one.remarks(), 1)) }
        td { (with_sd(&one.moments(|j| j.log_likelihood_per_sample), 1)) }
        td { (with_sd(&one.gains(), 1)) }
        td { (with_sd(&one.moments(|j| j.rms_kmh), 2)) }
        td { (end(one, 0)) " to " (end(one, 1)) }
    } } };
    html! {
            (sortable(head, rows))
            p.small { "Mean \u{b1} standard deviation over the seeds; readings.csv has all digits, and those of r0. Likelihoods compare readings of the same recorder; between recorders the data differ. Point: the gradient is that of the train's front, not the mean under it; variances: Table 1 read as such. Best deviations: what the most likely initial deviations would add." }
    }
}

/// The effort, and what is not as the text says, in words so short that the table fits its page.
fn short(reading: Reading) -> String {
    let [is_point, is_variance, is_spread] = [
        reading.gradient == Gradient::Point,
        reading.initial == Initial::Variances,
        reading.points != SigmaPoints::Printed,
    ];
    let others = [
        (is_point, reading.gradient_word()),
        (is_variance, reading.initial_word()),
        (is_spread, reading.points_word()),
    ];
    let others = others.into_iter().filter(|(is_so, _)| *is_so).map(|(_, word)| word);
    std::iter::once(reading.effort()).chain(others).collect::<Vec<_>>().join(", ")
}

/// What is compared: the reading, and the recorder.
fn named(one: &Compared) -> Markup {
    let Combination { reading, recorder } = one.combination;
    html! {
        th scope="row" { (short(reading)) }
        td.text { (recorder.speed_word()) }
        td { (recorder.skew_s) }
    }
}

/// The share of the seeds in which each remark holds; remarks by their numbers in the list.
fn by_remark(all: &[Compared]) -> Markup {
    let head = [choice_column("reading"), choice_column("speed"), column("older by", "s")];
    let numbers = (1..=REMARKS.len()).map(|number| column(&number.to_string(), ""));
    let rows = html! { @for one in all { tr {
        (named(one))
        @for share in one.shares() { td { (share_of_seeds(share)) } }
    } } };
    sortable(head.into_iter().chain(numbers), rows)
}

fn share_of_seeds(share: Option<f64>) -> String {
    // So that 15 columns fit a page: a whole share has no digits.
    let digits = if share.is_some_and(|share| share.fract() == 0.0) { 0 } else { 2 };
    number(share, digits)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::output::markdown::{found, measured, page};

    /// A row of the document is one that was measured, and what was measured has the combinations that are compared
    /// now.
    #[test]
    fn the_table_of_the_document_has_the_rows_that_were_measured() {
        let all: Vec<Compared> = Combination::all().into_iter().map(Compared::new).collect();
        let [document, measured, now] = [page("paper.md"), measured("readings.md"), markdown(&all)];
        let [theirs, then, now] = [&document, &measured, &now].map(|text| found(text, "| effort | speed |"));
        assert_eq!((&theirs[0], &then[0]), (&now[0], &now[0]));
        let labels = |rows: &[Vec<String>]| rows.iter().map(|row| row[..3].to_vec()).collect::<Vec<_>>();
        assert_eq!(labels(&then), labels(&now));
        assert!(theirs.len() > 5, "{}", theirs.len());
        for row in &theirs[1..] {
            assert!(then.contains(row), "docs/paper.md: {row:?}");
        }
    }
}
