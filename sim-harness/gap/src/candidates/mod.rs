//! All candidates: one file for each kind of effect.

use crate::candidate::{Candidate, Have, Prior};
use crate::config::GapConfig;
use crate::refusal::Refusal;
use rundown::model::effects::{Effect, EffectKind};
use rundown_files::refusal::Place;
use std::path::Path;

macro_rules! candidates {
    ($($number:literal $Kind:ident $name:ident $place:ident $summary:literal $parameters:tt)*) => {
        $(pub(crate) mod $name;)*

        /// The candidate of a kind.
        pub fn of(kind: EffectKind) -> &'static dyn Candidate {
            match kind {
                $(EffectKind::$Kind => &$name::This,)*
            }
        }
    };
}

rundown_wire::effects_catalogue!(candidates);
mod kit;
pub(crate) mod sensors;

/// All that a search looks among. Of terms that fit alike to the last digit the first is taken: a wrong r2 before a
/// mass in coasting, an unnamed one last.
pub fn searched() -> impl Iterator<Item = &'static dyn Candidate> {
    let named = EffectKind::ALL.iter().rev().filter(|kind| **kind != EffectKind::Unknown);
    named.map(|kind| of(*kind)).chain([of(EffectKind::Unknown)])
}

/// The candidate of an effect.
pub fn of_effect(effect: &Effect) -> &'static dyn Candidate {
    of(effect.kind())
}

/// A kind by its name.
pub fn by_name(name: &str) -> Option<EffectKind> {
    EffectKind::ALL.into_iter().find(|kind| kind.name() == name)
}

/// What is known of an effect, for `--explain`; `None` when there is none of this name.
///
/// ```
/// use rundown_gap::candidates::explain;
///
/// assert!(explain("steady_wind").is_some_and(|text| text.contains("other direction")));
/// assert_eq!(explain("ghost"), None);
/// ```
pub fn explain(name: &str) -> Option<String> {
    let of = of(by_name(name)?).facts();
    Some(format!(
        "{name}\n\n{}\n\n  law              {}\n  parameters       {}\n  how it shows     {}\n  confounded with  {}\n  separated by     {}\n",
        of.what, of.law, of.parameters, of.shows, of.confounded, of.separates
    ))
}

/// The defaults of all thresholds and priors as a file, each below what it is, its unit and its source.
pub fn printed_config() -> String {
    let mut text = GapConfig::default().commented();
    for candidate in searched() {
        let Prior { least, most, shapes, source } = candidate.facts().prior;
        if source.is_empty() {
            continue;
        }
        text.push_str(&format!("# {source}\n[prior.{}]\nleast = {least:?}\n", candidate.name()));
        if most.is_finite() {
            text.push_str(&format!("most = {most:?}\n"));
        }
        if !shapes.is_empty() {
            text.push_str(&format!("shapes = {shapes:?}\n"));
        }
        text.push('\n');
    }
    text
}

/// Refuses a prior of an effect that is none, or that has no prior of its own.
///
/// # Errors
/// Names it.
pub fn check_priors(config: &GapConfig) -> Result<(), String> {
    let known = |name: &&String| searched().any(|of| of.name() == **name && !of.facts().prior.source.is_empty());
    match config.prior.keys().find(|name| !known(name)) {
        Some(name) => Err(format!("prior.{name}: expected an effect that has sizes or shapes to set, found {name}")),
        None => Ok(()),
    }
}

/// Reads thresholds and priors from a file as [`printed_config`] prints it; what it leaves out stays as it is.
///
/// # Errors
/// Names the file.
pub fn read_config(path: &Path) -> Result<GapConfig, Refusal> {
    let read = || -> Result<GapConfig, Box<dyn std::error::Error>> {
        let config: GapConfig = toml::from_str(&std::fs::read_to_string(path)?)?;
        check_priors(&config)?;
        Ok(config)
    };
    read().map_err(|error| Refusal::unread(Place::of_file(path).refuse("", error.to_string()).into()))
}

const OTHER_DIRECTION: &str = "runs in the other direction";
const OTHER_SPEED: &str = "runs at another speed";
/// What shows the effort.
pub const EFFORT: &str = "an effort column";
/// What tells capability from habit.
pub const POSITION: &str = "the position of the controller";

/// What would separate two effects that the data at hand do not. Never what the data have already.
pub fn separates(a: EffectKind, b: EffectKind, have: Have) -> &'static str {
    let [first, second] = [a, b].map(of);
    let natures = [first, second].map(|candidate| candidate.facts().nature);
    if !have.both_directions && natures[0].turns != natures[1].turns {
        return OTHER_DIRECTION;
    }
    if let Some(special) = first.separated_from(b).or_else(|| second.separated_from(a)) {
        return special;
    }
    if !have.effort && natures.iter().any(|nature| nature.needs_effort) {
        return EFFORT;
    }
    if natures.iter().any(|nature| nature.by_place) {
        return OTHER_SPEED;
    }
    if have.effort { "more runs" } else { EFFORT }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_effect_of_the_board_has_its_page() {
        let refused = serde_json::from_str::<Effect>(r#"{"name": "ghost"}"#).unwrap_err();
        let text = refused.to_string();
        let mut words = text.split('`').skip(1).step_by(2).filter(|w| *w != "ghost");
        assert!(EffectKind::ALL.iter().all(|kind| words.next() == Some(kind.name())), "{text}");
        assert_eq!(words.next(), None);
        assert!(EffectKind::ALL.iter().all(|kind| explain(kind.name()).is_some()));
    }

    #[test]
    fn what_the_data_have_is_not_asked_for() {
        for have in [(false, false), (false, true), (true, false), (true, true)] {
            let have = Have { effort: have.0, both_directions: have.1 };
            for (a, b) in EffectKind::ALL.iter().flat_map(|a| EffectKind::ALL.iter().map(move |b| (*a, *b))) {
                let advice = separates(a, b, have);
                assert_eq!(advice, separates(b, a, have));
                assert!(!(have.both_directions && advice == OTHER_DIRECTION), "{a:?} {b:?}");
                assert!(!(have.effort && advice == EFFORT), "{a:?} {b:?}");
            }
        }
    }

    #[test]
    fn the_other_direction_separates_a_tunnel_from_a_gradient_first() {
        let have = |both_directions| Have { effort: true, both_directions };
        let of = |have| separates(EffectKind::TunnelDrag, EffectKind::GradientError, have);
        assert_eq!((of(have(false)), of(have(true))), (OTHER_DIRECTION, OTHER_SPEED));
    }
}
