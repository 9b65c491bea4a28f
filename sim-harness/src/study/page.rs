//! `report.html` of a study: each figure of section 4 with the paper's statement, our value and the truth beside it.

use super::claims::{Claim, Verdict, summary};
use super::{
    figures::Picture, gather::Gathered, moments::Moments, slope::SlopeAnswer, tallies::Tallies, trials::Sensitivity,
};
use maud::{Markup, PreEscaped, html};
use rundown::tick::paper::{Difference, PaperConfig};
use rundown_pages::numbers::{NOTHING, counted, number};
use rundown_pages::run_pages;
use rundown_pages::shell::{Section, choice_column, column, document, figure, prose, sortable, table, text_column};

#[derive(Clone, Debug)]
pub struct StudyPage<'a> {
    pub train: &'a str,
    pub track: &'a str,
    pub source: String,
    pub gathered: &'a Gathered,
    pub pictures: &'a [Picture],
    pub slopes: &'a [Picture],
    /// The last figure, where it was made.
    pub tunnel: Option<&'a Picture>,
    pub answers: &'a [SlopeAnswer],
    pub claims: &'a [Claim],
    pub sensitivity: &'a [Sensitivity],
    /// The filter of the paper's mode.
    pub filter: PaperConfig,
    /// The runs that are listed have pages.
    pub has_run_pages: bool,
}

/// Fig. 1, a file of its own: it has no numbers.
pub const METHOD: &str = include_str!("../../../docs/pictures/fig1_method.svg");
/// What a file needs and a page does without.
const NAME_SPACE: &str = " xmlns=\"http://www.w3.org/2000/svg\"";

const FIGURES: [(&str, &str); 8] = [
    ("2", "Fig. 2: speed profiles"),
    ("3", "Fig. 3: the filter on a single run"),
    ("4", "Fig. 4: histograms of r0, r1 and r2"),
    ("5", "Fig. 5: terms of the running resistance"),
    ("6", "Fig. 6: driving regimes"),
    ("7", "Fig. 7: cruise speed, final coast, final brake"),
    ("8", "Fig. 8: brake rates by ATB-EG step"),
    ("9", "Fig. 9: tractive power"),
];

/// What the page is called.
pub fn title(train: &str, track: &str) -> String {
    format!("Case study: {train} on {track}")
}

pub fn page(page: &StudyPage) -> String {
    let mut sections = vec![Section::new("truth", "Does the estimate follow the truth?", truth(page))];
    let method = html! { figure { div.wide { (PreEscaped(METHOD.replace(NAME_SPACE, ""))) } figcaption {
        "What is computed from what. The loop from the estimates back into the effort is why the true resistance cancels out."
    } } };
    sections.push(Section::new("fig-1", "Fig. 1: the method", method));
    sections.extend(FIGURES.map(|(number, heading)| {
        let pictures = page.pictures.iter().filter(|p| p.name.starts_with(&format!("fig{number}_")));
        let body = html! {
            @for picture in pictures { (figure(&picture.drawing, &picture.caption)) }
            (claims_table(page.claims.iter().filter(|claim| claim.place == number), None))
        };
        Section::new(format!("fig-{number}"), heading, body)
    }));
    sections.extend(page.tunnel.map(tunnel));
    sections.extend([
        Section::new("table-1", "Table 1: the paper's filter", table1(&page.filter, page.sensitivity)),
        Section::new("claims", "All claims of section 4", claims_table(page.claims.iter(), Some("figure, section"))),
        Section::new("fleet", "All runs in numbers", fleet(page.gathered)),
        Section::new("runs", "Runs", runs(page.gathered, page.has_run_pages)),
    ]);
    document(&title(page.train, page.track), &summary(page), &sections)
}

fn summary(page: &StudyPage) -> Markup {
    let count = |verdict| page.claims.iter().filter(|c| c.verdict == verdict).count();
    let gathered = page.gathered;
    let runs = gathered.paper.runs as usize;
    html! {
            p.lead {
                (counted(runs, "run", "runs")) ", " (page.source) "; " (known(gathered)) ". Of " (page.claims.len())
                " claims of section 4 of the paper, " strong { (count(Verdict::Reproduced)) " are reproduced" } ", "
                strong { (count(Verdict::Not) + count(Verdict::NotVisible)) " are not" } ", of these " (count(Verdict::NotVisible))
                " because nobody could see so small a change, and " (count(Verdict::NoData)) " cannot be assessed with these runs. " (summary::elsewhere(page.claims)) (summary::basis(page.claims)) " "
                a href="#claims" { "All of them, with the reason" } "."
            }
            p {
                "What that is worth: " (summary::by_kind(page.claims)) ". An " em { "input" } " was put into the scenario, the description or the method: it could not fail; what is "
                em { "recovered" } " was put in and found again by the extractor, with the error that is said; what is " em { "predicted" } " could have failed; what is "
                em { "observed" } " stands in recorded runs, whose truth nobody knows."
            }
            @if let (Some(example), Some(cause)) = (&gathered.example, &gathered.example_aside) {
                p { "The run of Figs. 3, 5 and 6, " (example.gated.name) ", is one of the runs that were set aside (" (cause) "): it is in no other figure, and in no claim but those on one run." }
            }
            @if gathered.set_aside > 0 {
                p { (counted(gathered.set_aside, "run was", "runs were")) " perturbed and set aside; runs.csv says by what, and --keep-perturbed keeps them." }
            }
            @if !gathered.failed.is_empty() {
                p.note {
                    (counted(gathered.failed.len(), "log", "logs")) " could not be used; the first: "
                    (prose(gathered.failed.first().map_or("", |failed| failed.error.as_str())))
                }
            }
            @let notes = &gathered.notes;
            @if !notes.is_empty() {
                p.note { "What the recorders did to the logs, before anything else looked at them:" }
                ul { @for note in notes { li { (prose(note)) } } }
            }
            p {
                "Paper: Cunillera, Be\u{161}inovi\u{107}, van Oort, Goverde, Real-time train motion parameter estimation using an Unscented Kalman Filter, "
                "Transportation Research Part C 143 (2022) 103794. Its recorded runs are not public. Figures have its numbers; where two pictures stand below each other, "
                "the first is the paper's mode and the second the gated mode on the same runs. Every picture lies beside this page as SVG with its numbers as CSV."
            }
    }
}

/// The last figure: why section 4.2 observed no influence of a tunnel.
fn tunnel(picture: &Picture) -> Section {
    let words = "Section 4.2 observed no influence of the tunnel at Best. Here the truth has one that the description lacks: \
        in the paper's mode r0 stays as it is, so nothing is there to be observed; the gap workflow looks for it.";
    let body = html! { p { (words) } (figure(&picture.drawing, &picture.caption)) };
    Section::new("tunnel", "The tunnel at Best", body)
}

pub fn known(gathered: &Gathered) -> String {
    let (runs, known) = (gathered.paper.runs, gathered.truth.runs);
    match (known, runs) {
        (_, 0) => "none could be used".to_owned(),
        (0, _) => "no truth lies beside them, so the columns of truth are empty".to_owned(),
        (1, 1) => "its truth is known and shown".to_owned(),
        _ if known == runs => "their truth is known and shown".to_owned(),
        _ => format!("the truth of {known} of them is known: columns of truth speak of these"),
    }
}

/// The paper's loop and the truth, before anything else is believed.
fn truth(page: &StudyPage) -> Markup {
    let slopes = |mode: &str, runs| {
        let answer = page.answers.iter().find(|a| a.mode == mode && a.runs == runs);
        answer.map_or_else(|| NOTHING.to_owned(), |answer| answer.slope.map(|slope| number(slope, 2)).join(" / "))
    };
    html! {
            p.note {
                strong { "The paper's loop does not follow the true resistance. " }
                "It calculates the effort from the change of speed and its own resistance, and lets that effort drive the filter that is to find the resistance: "
                "the true one cancels out, however well the speed is tracked. What the coefficients of Figs. 3 and 4 show is by how much speed, location and effort are apart in time, "
                "within what the initial deviations of Table 1 allow. Figures of r0, r1, r2 and of resistance in the paper's mode are therefore no measurement of the train."
            }
            @if !page.answers.is_empty() {
                p {
                    "Simulated vehicles with 0.7 to 1.3 of the described resistance show it. Slope of estimated on true deviation at 60 / 100 / 140 km/h after one run: paper "
                    strong { (slopes("paper", 1)) } ", gated " strong { (slopes("gated", 1)) }
                    ", with measured effort " strong { (slopes("measured", 1)) } "."
                }
                @for picture in page.slopes { (figure(&picture.drawing, &picture.caption)) }
                (answers(page.answers))
            }
    }
}

fn answers(answers: &[SlopeAnswer]) -> Markup {
    let head = [
        text_column("mode"),
        column("runs", ""),
        column("slope", "60 / 100 / 140 km/h"),
        column("spread about it", "%"),
        column("error of r(v)", "rms, 20 to 140 km/h, %"),
        column("Cram\u{e9}r-Rao bound", "the same, %"),
        column("efficiency", "variances"),
        column("truths in the 95 % interval", "%"),
    ];
    let rows = html! { @for a in answers { tr {
        th scope="row" { (a.mode) }
        td { (a.runs) }
        td { (a.slope.map(|v| number(v, 2)).join(" / ")) }
        td { (a.spread_percent.map(|v| number(v, 2)).join(" / ")) }
        td { (number(a.rmse_percent, 2)) }
        td { (number(a.bound_percent, 2)) }
        td { (number(a.efficiency, 3)) }
        td { (number(100.0 * a.coverage, 0)) }
    } } };
    html! {
        (table(head, rows))
        p.small {
            "Bound: Fisher information of r0, r1, r2 over the true coasting samples (with measured effort: over all), location and speed of each stretch unknown, "
            "a reading in whole km/h as normal noise of 1/\u{221a}12 km/h, with the prior of the gated mode. An efficiency above 1 is chance, or a prior that suits these vehicles."
        }
    }
}

fn verdict(verdict: Verdict) -> Markup {
    let class = match verdict {
        Verdict::Reproduced => "good",
        Verdict::Not | Verdict::NotVisible => "bad",
        Verdict::NoData | Verdict::Elsewhere => "dim",
    };
    html! { strong class=(class) { (verdict.as_str()) } }
}

/// With a column of that name for the place in the paper, where there is one: then the reader may sort and filter.
fn claims_table<'a>(claims: impl Iterator<Item = &'a Claim>, place: Option<&str>) -> Markup {
    let table = if place.is_some() { sortable } else { table };
    let words = text_column;
    let head = [
        words("the paper says; by which criterion"),
        choice_column("verdict"),
        choice_column("kind"),
        words("paper's mode"),
        words("gated mode"),
        words("truth"),
        words("error"),
    ];
    let rows = html! { @for claim in claims { tr {
        @if place.is_some() { td.word { (claim.place) } }
        td.text.claim {
            (claim.statement)
            div.small {
                @if claim.sets.all > 1 { (claim.sets.words()) " sets. " }
                (claim.why)
                @if let Some(least) = claim.least { ". Visible: " (least.reason) }
            }
        }
        td.word { (verdict(claim.verdict)) }
        td.word { (claim.kind.as_str()) }
        td.text { (claim.paper) }
        td.text { (claim.gated) }
        td.text { (claim.truth) }
        td.text { (claim.error) }
    } } };
    table(place.map(choice_column).into_iter().chain(head).collect::<Vec<_>>(), rows)
}

fn table1(config: &PaperConfig, sensitivity: &[Sensitivity]) -> Markup {
    let effort = match config.difference {
        Difference::Backward => "over the interval before a step (backward)",
        Difference::Forward => "over the interval of the step (forward)",
    };
    let [alpha, beta, kappa] = config.spread.parameters().map(|value| format!("{value:?}"));
    let [r0, r1, r2] = config.initial_davis_sd;
    let rows = [
        ("\u{3b1}", alpha),
        ("\u{3b2}", beta),
        ("\u{3ba}", kappa),
        ("\u{3c3} of the location, initial", format!("{} m", config.initial_location_sd_m)),
        ("\u{3c3} of the speed, initial", format!("{} km/h", config.initial_speed_sd_kmh)),
        ("\u{3c3} of r0, initial", format!("{r0:e} N/kg")),
        ("\u{3c3} of r1, initial", format!("{r1:e} N/(kg m/s)")),
        ("\u{3c3} of r2, initial", format!("{r2:e} N/(kg (m/s)\u{b2})")),
        ("\u{3c3} of a location reading", format!("{} m", config.location_sd_m)),
        ("\u{3c3} of a speed reading", format!("{} km/h", config.speed_sd_kmh)),
        ("calculated effort", effort.to_owned()),
    ];
    let rows = html! { @for (name, value) in rows { tr { th scope="row" { (name) } td { (value) } } } };
    html! {
            (table([text_column("parameter"), column("value", "")], rows))
            p.small { "The paper's mode runs with these values. Those of Table 1 are standard deviations; of the effort the text says less, see docs/paper.md. " code { "rundown tune" } " looks for better ones by the paper's two criteria." }
            @if !sensitivity.is_empty() { (initial(sensitivity)) }
    }
}

/// The remark of section 4.2 as a table; also for the page of `rundown tune`.
pub fn initial(sensitivity: &[Sensitivity]) -> Markup {
    let of_changes = [
        text_column("changed"),
        column("initial deviation", "times Table 1"),
        column("runs with a negative coefficient", ""),
    ];
    let least = ["r0", "r1", "r2"].map(|name| column(&format!("least {name}"), "of the manufacturer's"));
    let rows = html! { @for s in sensitivity { tr {
        th scope="row" { (s.which) }
        td { (s.factor) }
        td { (s.negative_runs) " of " (s.runs) }
        @for share in s.least_share { td { (number(share, 3)) } }
    } } };
    html! {
        h3 { "Larger initial deviations" }
        (table(of_changes.into_iter().chain(least), rows))
    }
}

fn fleet(gathered: &Gathered) -> Markup {
    type OfTallies = fn(&Tallies) -> &Moments;
    let rows: [(&str, f64, usize, OfTallies); 12] = [
        ("r0, 10\u{207b}\u{b3} N/kg", 1e-3, 3, |t| &t.davis[0]),
        ("r1, 10\u{207b}\u{2074} N/(kg m/s)", 1e-4, 3, |t| &t.davis[1]),
        ("r2, 10\u{207b}\u{2075} N/(kg (m/s)\u{b2})", 1e-5, 3, |t| &t.davis[2]),
        ("cruise speed, km/h", 1.0, 1, |t| &t.cruise_kmh),
        ("final coast, s", 1.0, 0, |t| &t.coast_s),
        ("final brake, s", 1.0, 0, |t| &t.brake_s),
        ("share of traction, %", 0.01, 1, |t| &t.shares[0]),
        ("share of cruise, %", 0.01, 1, |t| &t.shares[1]),
        ("share of coast, %", 0.01, 1, |t| &t.shares[2]),
        ("share of brake, %", 0.01, 1, |t| &t.shares[3]),
        ("mean power 50 to 130 km/h, kW", 1.0, 0, |t| &t.power_kw),
        ("largest power 50 to 90 km/h, kW", 1.0, 0, |t| &t.max_power_kw),
    ];
    let cells = |tallies: &Tallies, of: OfTallies, unit: f64, digits: usize| {
        let moments = of(tallies);
        let in_unit = |value: Option<f64>| number(value.map(|v| v / unit), digits);
        let ends = (moments.count > 0).then_some((moments.least, moments.largest));
        format!(
            "{} \u{b1} {} ({} to {})",
            in_unit(moments.mean()),
            in_unit(moments.sd()),
            in_unit(ends.map(|e| e.0)),
            in_unit(ends.map(|e| e.1)),
        )
    };
    let head = [text_column("quantity"), column("paper's mode", ""), column("gated mode", ""), column("truth", "")];
    let rows = html! { @for (name, unit, digits, of) in rows { tr {
        th scope="row" { (name) }
        td { (cells(&gathered.paper, of, unit, digits)) }
        td { (cells(&gathered.gated, of, unit, digits)) }
        td { @if gathered.truth.runs > 0 { (cells(&gathered.truth, of, unit, digits)) } @else { (NOTHING) } }
    } } };
    html! {
            p { (gathered.paper.runs) " runs, " (gathered.rows) " samples; mean \u{b1} standard deviation (least to largest), a value for each run. Figures draw "
                (gathered.drawn.len()) " of them, evenly spread; this table, Fig. 8's steps and the claims have all." }
            (table(head, rows))
    }
}

/// A row for each run, as the gated mode saw it.
fn runs(gathered: &Gathered, has_run_pages: bool) -> Markup {
    let head = [
        text_column("run"),
        choice_column("unit"),
        column("top speed", "km/h"),
        column("cruise speed", "km/h"),
        column("final coast", "s"),
        column("final brake", "s"),
        column("traction", "% of the time"),
        column("cruise", "%"),
        column("coast", "%"),
        column("brake", "%"),
        column("power", "kW"),
        column("r(100 km/h)", "10\u{207b}\u{b3} N/kg"),
        column("learned", "% of the time"),
    ];
    let r100 = |[r0, r1, r2]: [f64; 3]| 1e3 * (r0 + (r1 + r2 * 100.0 / 3.6) * 100.0 / 3.6);
    let rows = html! { @for (index, run) in gathered.listed.iter().enumerate() { @let seen = &run.gated; tr {
        th scope="row" { (run_pages::linked(&run.name, index, has_run_pages)) }
        td.word { (run.unit) }
        td { (number(run.top_kmh, 1)) }
        td { (number(seen.cruise_kmh, 1)) }
        td { (number(seen.coast_s, 0)) }
        td { (number(seen.brake_s, 0)) }
        @for regime in 0..4 { td { (number(seen.shares.map(|shares| 100.0 * shares[regime]), 1)) } }
        td { (number(seen.power_kw, 0)) }
        td { (number(r100(seen.davis), 2)) }
        td { (number(seen.learned_share.map(|share| 100.0 * share), 1)) }
    } } };
    let all = gathered.gated.runs as usize;
    html! {
        p {
            "As the gated mode saw them. " code { "runs.csv" } " beside this page has the paper's mode and the truth, too"
            @if gathered.listed.len() < all { "; listed are the first " (gathered.listed.len()) " of " (all) }
            "."
            @if has_run_pages { " Each of them has a page in the folder " code { (run_pages::FOLDER) } "." }
        }
        (sortable(head, rows))
    }
}
