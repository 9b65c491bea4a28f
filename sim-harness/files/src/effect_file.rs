//! Tables `[[effect]]` of a train or track file. Out: the [`Effects`] of a model, and which of them act in a run.
//!
//! ```toml
//! [[effect]]
//! name = "tunnel_drag"
//! from_m = 4000
//! to_m = 9000
//! k = 1.1e-5
//! ```
//!
//! An effect with `runs = ["run03", "run07"]` acts in these runs only; a board does not know it and has it always.

use crate::refusal::ReadError;
use crate::toml_file::{Step, TomlFile};
use jiff::Timestamp;
use jiff::civil::{Date, DateTime};
use rundown::model::effects::{Effect, EffectError, Effects};
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};
use std::fmt::Display;

/// One table.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct EffectEntry {
    /// Name and parameters.
    #[serde(flatten)]
    pub effect: Effect,
    /// The runs in which it acts, by the names of their files without the ending; none: all.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub runs: Option<Vec<String>>,
}

impl EffectEntry {
    /// An effect of all runs.
    pub fn everywhere(effect: Effect) -> Self {
        Self { effect, runs: None }
    }

    fn acts_in(&self, run: &str) -> bool {
        self.runs.as_ref().is_none_or(|runs| runs.iter().any(|name| without_ending(name) == run))
    }
}

/// A run may be named as its file is.
fn without_ending(name: &str) -> &str {
    name.strip_suffix(".csv").unwrap_or(name)
}

/// What is said of the entries of the train's and the track's file that name runs which are not among those that are
/// read: there they never act.
pub fn of_no_run(train: &[EffectEntry], track: &[EffectEntry], is_read: impl Fn(&str) -> bool) -> Vec<String> {
    let of_file = |(file, entries): (&'static str, &'_ [EffectEntry])| {
        let said = |(index, entry): (usize, &EffectEntry)| {
            let named = entry.runs.iter().flatten();
            let unknown: Vec<String> =
                named.filter(|name| !is_read(without_ending(name))).map(|name| format!("{name:?}")).collect();
            let unknown = (!unknown.is_empty()).then(|| unknown.join(", "))?;
            Some(format!("{file}: effect[{index}].runs: expected names of runs, found {unknown}, which no log has"))
        };
        entries.iter().enumerate().filter_map(said).collect::<Vec<String>>()
    };
    [("train", train), ("track", track)].map(of_file).concat()
}

/// Checks the entries of one file.
///
/// # Errors
/// [`ReadError`] names the place of the first parameter that is out of range.
pub(crate) fn check<T: DeserializeOwned>(file: &TomlFile<T>, entries: &[EffectEntry]) -> Result<(), ReadError> {
    for (index, entry) in entries.iter().enumerate() {
        let Err(error) = entry.effect.check() else { continue };
        return Err(refuse_effect(file, index, entry.effect.name(), &error));
    }
    Ok(())
}

/// Refuses entry `index` of `[[effect]]`, of the kind `name`, for an error that names kind and parameter.
pub fn refuse_effect<T: DeserializeOwned>(
    file: &TomlFile<T>,
    index: usize,
    name: &str,
    error: &dyn Display,
) -> ReadError {
    let text = error.to_string();
    let of_kind = text.strip_prefix(name).unwrap_or(&text);
    file.refuse_error(&[Step::Name("effect"), Step::Index(index)], &of_kind)
}

/// The effects of the track and of the train that act in a run; `None`: those that act in all.
///
/// # Errors
/// [`EffectError`]: both files together have more than a model may have.
///
/// ```
/// use rundown::model::effects::{DraggingBrake, Effect, SteadyWind};
/// use rundown_files::effect_file::{EffectEntry, effects};
///
/// let wind = EffectEntry::everywhere(Effect::SteadyWind(SteadyWind { wind_mps: 2.0 }));
/// let drag = Effect::DraggingBrake(DraggingBrake { drag_n_per_kg: 0.01 });
/// let drag = EffectEntry { effect: drag, runs: Some(vec!["run03".to_owned()]) };
/// let of = |run| effects(&[wind.clone()], &[drag.clone()], run).map(|effects| effects.len());
/// assert_eq!((of(Some("run02"))?, of(Some("run03"))?, of(None)?), (1, 2, 1));
/// # Ok::<(), rundown::model::effects::EffectError>(())
/// ```
pub fn effects(track: &[EffectEntry], train: &[EffectEntry], run: Option<&str>) -> Result<Effects, EffectError> {
    let acts = |entry: &&EffectEntry| match run {
        Some(run) => entry.acts_in(run),
        None => entry.runs.is_none(),
    };
    let acting = track.iter().chain(train).filter(acts);
    Effects::try_new(acting.map(|entry| entry.effect.clone()))
}

/// Days since 1970-01-01 UTC of a departure written as in `runs.csv`, `2026-03-01T08:12:00Z` or with another offset;
/// none when it is no such date.
///
/// ```
/// use rundown_files::effect_file::day_of;
///
/// assert_eq!(day_of("1970-01-02T12:00:00Z"), Some(1.5));
/// assert_eq!(day_of("1970-01-02T12:00:00+02:00"), day_of("1970-01-02 10:00"));
/// assert_eq!(day_of("2026-03-01"), Some(20_513.0));
/// assert_eq!(day_of("tomorrow"), None);
/// ```
pub fn day_of(departure_utc: &str) -> Option<f64> {
    let text = departure_utc.trim().replacen(' ', "T", 1);
    if let Ok(instant) = text.parse::<Timestamp>() {
        return Some(instant.as_duration().as_secs_f64() / 86_400.0);
    }
    let at = text.parse::<DateTime>().or_else(|_| text.parse::<Date>().map(Date::into)).ok()?;
    let epoch = jiff::civil::date(1970, 1, 1).at(0, 0, 0, 0);
    let seconds = at.duration_since(epoch).as_secs_f64();
    Some(seconds / 86_400.0)
}

/// The date of a day since 1970-01-01 UTC; none beyond the years of the calendar.
///
/// ```
/// use rundown_files::effect_file::date_of;
///
/// assert_eq!(date_of(20_513.4).as_deref(), Some("2026-03-01"));
/// assert_eq!(date_of(f64::NAN), None);
/// ```
pub fn date_of(day: f64) -> Option<String> {
    let days = day.is_finite().then(|| jiff::Span::new().try_days(day.floor() as i64).ok())??;
    Some(jiff::civil::date(1970, 1, 1).checked_add(days).ok()?.to_string())
}

#[cfg(test)]
mod tests {
    use crate::track_file::TrackFile;
    use rundown::model::effects::{Effect, TemperatureResistance, TunnelDrag};

    const TRACK: &str = "name = \"line\"\nlength_m = 10000\n";

    fn refused(table: &str) -> String {
        let text = format!("{TRACK}[[effect]]\n{table}");
        let refused = TrackFile::parse("track.toml".as_ref(), &text);
        refused.unwrap_err().to_string()
    }

    #[test]
    fn effects_are_read_by_name_and_written_as_they_were_read() {
        let text = format!(
            "{TRACK}[[effect]]\nfrom_m = 4000\nto_m = 9000.0\nk = 1.1e-5\nname = \"tunnel_drag\"\nruns = [\"run03\"]\n\
             [[effect]]\nname = \"temperature_resistance\"\ndr0_per_degC = -1e-4\nref_c = 15\n\
             [[effect]]\nname = \"unknown\"\ncoordinate = \"speed\"\ntable = [[0, 0.5], [30, 0.25]]\n"
        );
        let (file, _) = TrackFile::parse("track.toml".as_ref(), &text).unwrap();
        let tunnel = TunnelDrag { from_m: 4000.0, to_m: 9000.0, k: 1.1e-5 };
        assert_eq!(file.effect[0].effect, Effect::TunnelDrag(tunnel));
        assert_eq!(file.effect[0].runs, Some(vec!["run03".to_owned()]));
        let grease = TemperatureResistance { dr0_per_deg_c: -1e-4, ref_c: 15.0 };
        assert_eq!(file.effect[1].effect, Effect::TemperatureResistance(grease));
        assert_eq!(file.effect[2].effect.name(), "unknown");
        let written = toml::to_string(&file).unwrap();
        let (again, _) = TrackFile::parse("again.toml".as_ref(), &written).unwrap();
        assert_eq!(again, file, "{written}");
    }

    #[test]
    fn a_wrong_effect_is_named_with_its_place() {
        assert_eq!(
            refused("name = \"warm_up\"\namplitude = 3\ntau_s = 300\n"),
            "track.toml:5:13: effect[0].amplitude: expected -0.5 to 0.5, found 3"
        );
        assert_eq!(
            refused("name = \"tunnel_drag\"\nfrom_m = 9\nto_m = 8\nk = 0\n"),
            "track.toml:6:8: effect[0].to_m: expected beyond from_m = 9, found 8"
        );
        for (table, says) in [
            ("name = \"tunnel\"\n", "unknown variant `tunnel`"),
            ("name = \"warm_up\"\namplitude = 0.003\n", "missing field `tau_s`"),
            ("name = \"steady_wind\"\nwind_mps = 2\nsigma = 1\n", "unknown field `sigma`"),
            ("wind_mps = 2\n", "missing field `name`"),
        ] {
            let found = refused(table);
            assert!(found.starts_with("track.toml:3:") && found.contains(says), "{found}");
        }
    }

    #[test]
    fn a_departure_has_a_day() {
        for (text, day) in [
            ("1969-12-31", -1.0),
            ("1970-01-01T00:00:00Z", 0.0),
            ("1999-12-31", 10_956.0),
            ("2000-02-29", 11_016.0),
            ("2000-03-01", 11_017.0),
            ("2024-12-31T06:00:00Z", 20_088.25),
            ("2025-01-01", 20_089.0),
        ] {
            assert_eq!(super::day_of(text), Some(day), "{text}");
        }
    }
}
