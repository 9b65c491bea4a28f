//! The tables of the page.

use crate::answer::whole::Answer;
use crate::evidence::{Along, Evidence};
use crate::investigation::Investigation;
use crate::named::Named;
use crate::wording::{confidence, interval, listed, place, plain, unit, with_ends};
use maud::{Markup, html};
use rundown::model::effects::Coordinate;
use rundown_pages::numbers::{NOTHING, number, percent};
use rundown_pages::shell::{column, table, text_column};

/// A cell beside several rows begins with the first of them.
const TOP: &str = "vertical-align: top";

pub(super) fn evidence(found: &Investigation) -> Markup {
    let (evidence, p_value) = (&found.evidence, found.p_value);
    let place = |one: &Evidence| match one.along {
        Along::Over(Coordinate::Location) => format!("km {}", number(one.at / 1000.0, 1)),
        Along::Over(Coordinate::Speed) => format!("{} km/h", number(3.6 * one.at, 0)),
        Along::Over(Coordinate::Time) => format!("{} min", number(one.at / 60.0, 1)),
        Along::Over(Coordinate::Temperature) => format!("{} \u{b0}C", number(one.at, 0)),
        Along::Over(Coordinate::Day) => format!("day {}", number(one.at - found.findings.conditions.first_day, 0)),
        Along::Regime if one.at > 0.5 => "power".to_owned(),
        Along::Regime if one.at < -0.5 => "brake".to_owned(),
        Along::Regime => "coast".to_owned(),
        Along::Direction => if one.at > 0.0 { "up" } else { "down" }.to_owned(),
    };
    let head = [
        text_column("residuals vary with"),
        column("score", "standard deviations"),
        column("most at", ""),
        column("p-value", ""),
    ];
    let rows = html! {
        @for one in evidence { tr {
            th scope="row" { (one.along.name()) }
            td { (number(one.score, 1)) }
            td { (place(one)) }
            td { (number(one.p_value, 3)) }
        } }
        tr { th scope="row" { "any of them" } td { (NOTHING) } td { (NOTHING) } td { (number(p_value, 3)) } }
    };
    html! {
        h3 { "Is it chance?" }
        (table(head, rows))
        p.small { "Found by a sign-flip test over runs, 999 times: intervals of one run are not independent, so the run is the unit. The least p-value that can come out is 0.001." }
        @if !found.named.is_empty() {
            p {
                "With the effects in the model the same test of what is left gives p = " (number(found.p_value_after, 3))
                ", on the runs that the effects were found in."
                @if let Some([before, after]) = found.p_value_held_out {
                    " On the hold-out runs alone, with the effects that the others show: " (number(before, 3)) " before, " (number(after, 3)) " after."
                }
            }
        }
    }
}

pub(super) fn effects(found: &Investigation) -> Markup {
    if found.named.is_empty() {
        return html! { p { "Nothing was added to the model." } };
    }
    let head = [
        text_column("effect"),
        column("confidence", "in the name"),
        text_column("parameter"),
        column("value", ""),
        column("95 % interval", ""),
        text_column("unit"),
        text_column("not distinguishable from"),
        text_column("would separate them"),
    ];
    html! {
        (table(head, html! { @for one in &found.named { (effect(one)) } }))
        p.small { "The same lies beside this page as " code { "model/train.toml" } " and " code { "model/track.toml" } "." }
    }
}

fn effect(one: &Named) -> Markup {
    let parameters = parameters(one);
    let rows = parameters.len().max(1);
    let listed = |names: Vec<String>| if names.is_empty() { NOTHING.to_owned() } else { names.join(", ") };
    let named = html! {
        th scope="row" rowspan=(rows) style=(TOP) {
            (plain(one.effect.name()))
            @if let Some((from_m, to_m)) = one.effect.section_m() { br; span.unit { (place(from_m, to_m)) } }
            @if let Some(coordinate) = one.coordinate() { br; span.unit { "over " (coordinate) } }
            @if !one.runs.is_empty() { br; span.unit { "in " (one.runs.len()) " runs" } }
        }
        td rowspan=(rows) style=(TOP) { (confidence(one)) }
    };
    let rivals = html! {
        td.text rowspan=(rows) style=(TOP) { (listed(one.rivals().map(plain).collect())) }
        td.text rowspan=(rows) style=(TOP) { (listed(one.would_separate.iter().map(|what| plain(what)).collect())) }
    };
    html! {
        @if parameters.is_empty() { tr { (named) td.text colspan="4" { "a table: the line through the data below" } (rivals) } }
        @for (index, (name, value)) in parameters.iter().enumerate() {
            @let (value, ends) = with_ends(*value, interval(one, name));
            tr {
                @if index == 0 { (named) }
                td.text { code { (name) } }
                td { (value) }
                td { @match ends { Some([low, high]) => { (low) " to " (high) }, None => { (NOTHING) } } }
                td.text { (unit(one.effect.kind(), name)) }
                @if index == 0 { (rivals) }
            }
        }
        @if !one.runs.is_empty() {
            tr { td.small.text colspan="8" { "runs: " (one.runs.join(", ")) } }
        }
    }
}

/// Parameters by name; not those at zero that were not fitted.
fn parameters(one: &Named) -> Vec<(String, f64)> {
    let json = one.json();
    let mut all: Vec<(String, f64)> =
        ["from_m", "to_m"].iter().filter_map(|name| Some(((*name).to_owned(), json[name].as_f64()?))).collect();
    if let Some(map) = json["parameters"].as_object() {
        all.extend(map.iter().filter_map(|(n, v)| Some((n.clone(), v.as_f64()?))));
    }
    all.retain(|(name, value)| *value != 0.0 || interval(one, name).is_some());
    all
}

/// The gap in numbers.
pub(super) fn gap(answer: &Answer) -> Markup {
    let found = &answer.found;
    let gap = &found.gap;
    let compared = found.compared.len();
    if compared == 0 {
        return html! { p { "No hold-out run could be compared: too few runs, or too little to simulate in them." } };
    }
    let trained = plain(&listed(found.trained.iter().map(|one| one.effect.name())));
    let rows = html! {
        @for (name, value) in [("before: believed model", gap.before), ("after: with the effects", gap.after), ("noise floor: a perfect model", gap.floor)] {
            tr { th scope="row" { (name) } td { (number(value, 3)) } }
        }
        tr { th scope="row" { "share of the removable gap that is gone" } td { @match gap.removed { Some(removed) => { (percent(removed)) }, None => { "there was none" } } } }
        @if let Some((low, high)) = gap.removed_95 {
            tr { th scope="row" { "its 95 % interval, from " (gap.runs) " resampled runs" } td { (percent(low)) " to " (percent(high)) } }
        }
    };
    html! {
        p {
            (found.held_out.len()) " of " (answer.input.runs.len()) " runs were held out of a second analysis; from the others alone it found " (trained)
            ". With that, the hold-out runs were simulated:"
        }
        (table([text_column("error of the simulated speed"), column("root mean square", "m/s")], rows))
        @if let Some(touched) = &found.touched {
            p {
                "Where the effects act, in " (touched.count) " of these speeds: " (number(touched.share.before, 3)) " m/s before, "
                (number(touched.share.after, 3)) " after, and a perfect model would leave " (number(touched.share.floor, 3))
                @if let Some(removed) = touched.share.removed { ": " (percent(removed)) " of the gap there is gone" }
                @if let Some((low, high)) = touched.share.removed_95 { " (95\u{a0}% interval " (percent(low)) " to " (percent(high)) ")" }
                @if let Some((multiple, (low, high))) = touched.multiple {
                    ". The measured speeds differ from the believed model by " (number(multiple, 2)) " times what the effects foresee (95\u{a0}% interval "
                    (number(low, 2)) " to " (number(high, 2)) "), whatever the noise floor is"
                }
                "."
            }
        }
        p.small { (compared) " speeds compared, each weighed by how well a perfect model would foresee it. The removable gap is what lies between before and the noise floor, in mean squares." }
        @if let Some(innovations) = answer.innovations {
            p {
                "Innovations of the on-board estimator's speed on the same runs, root mean square: "
                (number(innovations.before_mps, 3)) " m/s with the believed model, " (number(innovations.after_mps, 3)) " m/s with the repaired one."
            }
        }
    }
}
