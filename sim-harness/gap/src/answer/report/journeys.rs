//! Running time and energy of the hold-out runs, before and after.

use crate::answer::{json::NO_ENERGY, whole::Answer};
use crate::candidate::ShowsIn;
use crate::candidates;
use crate::holdout::journey::{Spread, Summary};
use crate::holdout::share::Share;
use crate::named::Named;
use maud::{Markup, html};
use rundown_pages::numbers::{NOTHING, counted, number, percent};

/// Tables and what they mean; nothing where no run was simulated.
pub(super) fn journeys(answer: &Answer) -> Markup {
    let Some(times) = answer.times() else {
        return html! {};
    };
    let stalled: usize = answer.found.journeys.iter().map(|j| j.stalled).sum();
    let full_power = |one: &Named| candidates::of_effect(&one.effect).facts().nature.shows_in == ShowsIn::FullPower;
    let limited = answer.found.named.iter().any(full_power);
    let least_runs = answer.holdout().least_resampled;
    html! {
        h3 { "Running time" }
        p {
            "The time to cover the distance of each window of up to 120 s, from its measured first speed and with the recorded effort at each place, summed over a run: "
            (number(times.measured / 60.0, 0)) " min in " (times.share.runs) " runs. "
            (gone(&times.share, least_runs))
            @if limited { " The recorded effort drives the train, so what a limit of the traction costs does not show here." }
            @if stalled > 0 { " In " (stalled) " windows a simulated train did not arrive; they are left out." }
        }
        (table("simulated less measured running time of a run", "s", &times))
        h3 { "Energy at the wheel" }
        @match answer.energies() {
            Some(energies) => {
                p {
                    "What each model needs at the wheel to run the measured speeds while the train powers, against the effort column: "
                    (number(energies.measured, 0)) " kWh in " (energies.share.runs) " runs, with the described mass. " (gone(&energies.share, least_runs))
                }
                (table("needed less measured energy of a run", "kWh", &energies))
            }
            None => p { "The energy at the wheel " (NO_ENERGY) "." },
        }
    }
}

fn table(what: &str, unit: &str, summary: &Summary) -> Markup {
    let row = |name: &str, rms: f64, spread: Option<&Spread>| {
        let value = |of: &dyn Fn(&Spread) -> f64| spread.map_or_else(|| NOTHING.to_owned(), |s| number(of(s), 2));
        html! { tr {
            th scope="row" { (name) }
            td { (number(rms, 2)) }
            td { (value(&|s| s.mean)) }
            td { (value(&|s| s.quantiles[0])) }
            td { (value(&|s| s.quantiles[1])) }
            td { (value(&|s| s.quantiles[2])) }
            td { (spread.map_or_else(|| NOTHING.to_owned(), |s| percent(s.relative))) }
        } }
    };
    let share = &summary.share;
    html! { div.wide { table {
        thead {
            tr {
                th.text scope="col" rowspan="2" { (what) br; span.unit { (unit) } }
                th scope="col" rowspan="2" { "root mean square" }
                th scope="col" rowspan="2" { "mean" }
                th scope="colgroup" colspan="3" { "of the runs lie below" }
                th scope="col" rowspan="2" { "in sum" }
            }
            tr { th scope="col" { "10 %" } th scope="col" { "50 %" } th scope="col" { "90 %" } }
        }
        tbody {
            (row("before: believed model", share.before, Some(&summary.before)))
            (row("after: with the effects", share.after, Some(&summary.after)))
            (row("noise floor: a perfect model", share.floor, None))
        }
    } } }
}

/// The share that is gone, in a sentence.
fn gone(share: &Share, least_runs: usize) -> String {
    let Some(removed) = share.removed else {
        return "Before, the errors were no larger than noise makes them in so many runs: there was nothing to remove."
            .to_owned();
    };
    let whole = |share: f64| number(100.0 * share, 0);
    let interval = match share.removed_95 {
        Some((low, high)) => format!("95\u{a0}% interval {} to {}", whole(low), whole(high)),
        None if share.runs < least_runs => "too few runs for an interval".to_owned(),
        None => "no interval: in some resampled runs there was nothing to remove".to_owned(),
    };
    format!(
        "{}\u{a0}% of the removable gap is gone ({interval}; {}).",
        whole(removed),
        counted(share.runs, "run", "runs")
    )
}
