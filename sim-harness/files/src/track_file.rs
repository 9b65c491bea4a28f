//! Track descriptions: a TOML file, see [`TrackFile`]. Out: the estimator's [`Track`], and the tables the estimator has
//! no use for.

use crate::effect_file::{self, EffectEntry};
use crate::toml_file::{self, Step, TomlFile};
use crate::{exchanged::Described, refusal::ReadError};
use rundown::estimator::config::Config;
use rundown::model::track::{Curve, Gradient, MAX_CURVES, MAX_GRADIENTS, MAX_TARGETS, Target, Track, TrackError};
use rundown::model::units::KmPerHour;
use serde::{Deserialize, Serialize};
use std::{fmt::Display, path::Path};

/// Standard deviation of the gradients of a line of which none is known, permille: that of main lines through hills.
const UNDESCRIBED_SD_PERMILLE: f64 = 5.0;
/// Beyond, nothing would be said of a gradient, permille.
pub const MOST_SD_PERMILLE: f64 = 100.0;
/// Trams turn no sharper, m.
const LEAST_RADIUS_M: f64 = 10.0;
/// No line permits more, on wheels or without, km/h.
const MOST_LIMIT_KMH: f64 = 650.0;

/// What a track file holds. Every table is sorted by where its entries begin.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
#[expect(missing_docs, reason = "named as in the file, with units")]
pub struct TrackFile {
    pub name: String,
    pub length_m: f64,
    /// How far a gradient may be off, standard deviation, permille; see [`TrackFile::gradient_sd_permille`].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub gradient_sd_permille: Option<f64>,
    /// Piecewise constant until the next entry.
    #[serde(default)]
    pub gradient: Vec<Gradient>,
    #[serde(default)]
    pub curve: Vec<Curve>,
    #[serde(default)]
    pub tunnel: Vec<Tunnel>,
    /// Speed limits, each until the next entry.
    #[serde(default)]
    pub speed_limit: Vec<SpeedLimit>,
    #[serde(default)]
    pub feeding_section: Vec<FeedingSection>,
    #[serde(default)]
    pub stop: Vec<Stop>,
    /// Polyline for map matching.
    #[serde(default)]
    pub centre_line: Vec<CentreLinePoint>,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub effect: Vec<EffectEntry>,
}

/// One tunnel.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
#[expect(missing_docs, reason = "named with their units")]
pub struct Tunnel {
    pub from_m: f64,
    pub to_m: f64,
}

/// One speed limit.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
#[expect(missing_docs, reason = "named with their units")]
pub struct SpeedLimit {
    pub from_m: f64,
    pub kmh: f64,
}

/// One feeding section.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
#[expect(missing_docs, reason = "named with their units")]
pub struct FeedingSection {
    pub from_m: f64,
    pub to_m: f64,
    pub name: String,
}

/// One stop.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
#[expect(missing_docs, reason = "named with their units")]
pub struct Stop {
    pub at_m: f64,
    pub name: String,
}

/// One point of the centre line.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
#[expect(missing_docs, reason = "named with their units")]
pub struct CentreLinePoint {
    /// Location along the track, m.
    pub at_m: f64,
    pub latitude_deg: f64,
    pub longitude_deg: f64,
}

impl TrackFile {
    /// Reads and checks a track file.
    ///
    /// # Errors
    /// [`ReadError`] names file, line and column.
    pub fn read(path: &Path) -> Result<(Self, Track), ReadError> {
        Self::parse(path, &toml_file::text_of(path)?)
    }

    /// How far a gradient may be off: as the file says; else nothing where gradients are described, and as much as
    /// lines differ from flat ones where none are.
    ///
    /// ```
    /// use rundown_files::track_file::TrackFile;
    ///
    /// let bare = "name = \"bare\"\nlength_m = 5000\n";
    /// let (bare, _) = TrackFile::parse("bare.toml".as_ref(), bare)?;
    /// assert_eq!(bare.gradient_sd_permille(), 5.0);
    /// let flat = "name = \"flat\"\nlength_m = 5000\ngradient_sd_permille = 0\n";
    /// let (flat, _) = TrackFile::parse("flat.toml".as_ref(), flat)?;
    /// assert_eq!(flat.gradient_sd_permille(), 0.0);
    /// # Ok::<(), rundown_files::refusal::ReadError>(())
    /// ```
    pub fn gradient_sd_permille(&self) -> f64 {
        let unsaid = if self.gradient.is_empty() { UNDESCRIBED_SD_PERMILLE } else { 0.0 };
        self.gradient_sd_permille.unwrap_or(unsaid)
    }

    /// Which entries begin beyond the line, where nothing of them acts; none where none do.
    pub fn beyond_the_line(&self) -> Option<String> {
        let off = |at_m: f64| usize::from(!(-1.0..=self.length_m + 1.0).contains(&at_m));
        let counts = [
            ("gradient", self.gradient.iter().map(|entry| off(entry.from_m)).sum()),
            ("curve", self.curve.iter().map(|entry| off(entry.from_m)).sum()),
            ("tunnel", self.tunnel.iter().map(|entry| off(entry.from_m)).sum()),
            ("speed_limit", self.speed_limit.iter().map(|entry| off(entry.from_m)).sum()),
            ("stop", self.stop.iter().map(|entry| off(entry.at_m)).sum::<usize>()),
        ];
        let named: Vec<String> = counts.iter().filter(|(_, n)| *n > 0).map(|(name, n)| format!("{n} {name}")).collect();
        let line = format!("lie beyond the line, which goes from 0 to {} m: is length_m right?", self.length_m);
        (!named.is_empty()).then(|| format!("track: {} {line}", named.join(", ")))
    }

    /// The configuration of an estimator on this track, where it has no doubt of its own.
    pub fn doubted(&self, mut config: Config) -> Config {
        let doubt = &mut config.track_doubt.gradient_sd_permille;
        if *doubt == 0.0 {
            *doubt = self.gradient_sd_permille();
        }
        config
    }

    /// How far gradients may be off as a configuration or this file says, standard deviation, permille; none where
    /// neither says anything of described ones.
    pub fn said_sd_permille(&self, config: &Config) -> Option<f64> {
        let doubted = self.doubted(*config).track_doubt.gradient_sd_permille;
        (doubted > 0.0 || self.gradient_sd_permille.is_some()).then_some(doubted)
    }

    /// Where trains stop, m.
    pub fn stops_m(&self) -> Vec<f64> {
        self.stop.iter().map(|stop| stop.at_m).collect()
    }

    /// Stops and permitted speeds as the estimator takes them, sorted. At one place the limit comes first.
    pub fn targets(&self) -> Vec<Target> {
        let limits = self
            .speed_limit
            .iter()
            .map(|limit| Target { at_m: limit.from_m, limit_mps: Some(KmPerHour(limit.kmh).to_mps()) });
        let stops = self.stop.iter().map(|stop| Target { at_m: stop.at_m, limit_mps: None });
        let mut targets: Vec<Target> = limits.chain(stops).collect();
        targets.sort_by(|a, b| a.at_m.total_cmp(&b.at_m));
        targets
    }

    /// Reads and checks a text; `path` is for the messages.
    ///
    /// # Errors
    /// As [`TrackFile::read`].
    ///
    /// ```
    /// use rundown::model::direction::Direction;
    /// use rundown_files::track_file::TrackFile;
    ///
    /// let text = "name = \"hill\"\nlength_m = 5000\n[[gradient]]\nfrom_m = 0\npermille = 10\n";
    /// let (file, track) = TrackFile::parse("hill.toml".as_ref(), text)?;
    /// assert_eq!(file.gradient.len(), 1);
    /// assert!((track.mean_gradient(1000.0, 162.0, Direction::Up) - 0.010).abs() < 1e-12);
    /// # Ok::<(), rundown_files::refusal::ReadError>(())
    /// ```
    pub fn parse(path: &Path, text: &str) -> Result<(Self, Track), ReadError> {
        let file = TomlFile::parse(path, text);
        checked(file.map_err(|error| Described::Track.or_exchanged(error, path, text))?)
    }
}

fn checked(file: TomlFile<TrackFile>) -> Result<(TrackFile, Track), ReadError> {
    let values = &file.values;
    let entry = |table, index| Entry { file: &file, table, index };
    if let Some(sd) = values.gradient_sd_permille.filter(|sd| !(0.0..=MOST_SD_PERMILLE).contains(sd)) {
        let expected = format!("expected 0 to {MOST_SD_PERMILLE}, found {sd}");
        return Err(file.refuse_dotted("gradient_sd_permille", expected));
    }
    sorted(&file, "curve", "from_m", &values.curve, |c| c.from_m, false)?;
    sorted(&file, "tunnel", "from_m", &values.tunnel, |t| t.from_m, false)?;
    sorted(&file, "speed_limit", "from_m", &values.speed_limit, |l| l.from_m, true)?;
    sorted(&file, "feeding_section", "from_m", &values.feeding_section, |s| s.from_m, false)?;
    sorted(&file, "stop", "at_m", &values.stop, |s| s.at_m, false)?;
    sorted(&file, "centre_line", "at_m", &values.centre_line, |p| p.at_m, true)?;
    for (index, curve) in values.curve.iter().enumerate() {
        entry("curve", index).ends(curve.from_m, curve.to_m)?;
        let is_radius = curve.radius_m >= LEAST_RADIUS_M && curve.radius_m.is_finite();
        entry("curve", index).need(is_radius, "radius_m", || format!("{LEAST_RADIUS_M} or more"), curve.radius_m)?;
    }
    apart(&file, "tunnel", &values.tunnel, |tunnel| (tunnel.from_m, tunnel.to_m))?;
    for (index, limit) in values.speed_limit.iter().enumerate() {
        let is_speed = limit.kmh > 0.0 && limit.kmh <= MOST_LIMIT_KMH;
        let expected = || format!("above 0, at most {MOST_LIMIT_KMH}");
        entry("speed_limit", index).need(is_speed, "kmh", expected, limit.kmh)?;
    }
    apart(&file, "feeding_section", &values.feeding_section, |section| (section.from_m, section.to_m))?;
    for (index, point) in values.centre_line.iter().enumerate() {
        let point_at = entry("centre_line", index);
        point_at.within("latitude_deg", point.latitude_deg, 90.0)?;
        point_at.within("longitude_deg", point.longitude_deg, 180.0)?;
    }
    if values.centre_line.len() == 1 {
        return Err(file.refuse_dotted("centre_line", "expected at least 2 points, found 1"));
    }
    effect_file::check(&file, &values.effect)?;
    let track = Track::try_new(values.length_m, values.gradient.iter().copied());
    let track = track
        .and_then(|track| track.with_curves(values.curve.iter().copied()))
        .and_then(|track| track.with_targets(values.targets()));
    match track {
        Ok(track) => Ok((file.values, track)),
        Err(error) => Err(track_refusal(&file, error)),
    }
}

fn track_refusal(file: &TomlFile<TrackFile>, error: TrackError) -> ReadError {
    let TrackFile { gradient, curve, speed_limit, stop, .. } = &file.values;
    let entry = |table, index| Entry { file, table, index };
    match error {
        TrackError::Length { found } => file.refuse_dotted("length_m", format!("expected above 0, found {found}")),
        // The estimator stops at the first entry too many; a person wants to know how many there are.
        TrackError::TooMany { .. } => entry("gradient", MAX_GRADIENTS).too_many(MAX_GRADIENTS, gradient.len()),
        // Order, ends and radius were checked before.
        TrackError::BadCurve { index } => entry("curve", index).too_many(MAX_CURVES, curve.len()),
        // Order and speeds were checked before.
        TrackError::BadTarget { .. } => {
            let found = speed_limit.len() + stop.len();
            file.refuse(&[], format!("expected at most {MAX_TARGETS} speed limits and stops together, found {found}"))
        }
        TrackError::BadGradient { index } => match gradient.get(index) {
            Some(g) if g.from_m.is_finite() => entry("gradient", index).refuse("permille", "-200 to 200", g.permille),
            found => entry("gradient", index).refuse("from_m", "a finite number", found.map_or(f64::NAN, |g| g.from_m)),
        },
        TrackError::NotSorted { index } => {
            let from_m = |index: usize| gradient.get(index).map_or(f64::NAN, |entry| entry.from_m);
            entry("gradient", index).refuse("from_m", beyond(from_m(index.saturating_sub(1))), from_m(index))
        }
        _ => file.refuse(&[], error.to_string()),
    }
}

fn beyond(before_m: f64) -> String {
    format!("beyond {before_m}, where the entry before begins")
}

/// Entries are finite and in order; `strictly` where two at one place would contradict each other.
fn sorted<T>(
    file: &TomlFile<TrackFile>,
    table: &'static str,
    field: &str,
    entries: &[T],
    begin_m: impl Fn(&T) -> f64,
    strictly: bool,
) -> Result<(), ReadError> {
    let mut before = f64::NEG_INFINITY;
    for (index, entry) in entries.iter().enumerate() {
        let found = begin_m(entry);
        let entry = Entry { file, table, index };
        entry.need(found.is_finite(), field, || "a finite number".to_owned(), found)?;
        entry.need(found > before || (!strictly && found == before), field, || beyond(before), found)?;
        before = found;
    }
    Ok(())
}

/// Entries end behind where they begin, and before the next one does: a place is in one tunnel, and fed by one section.
fn apart<T>(
    file: &TomlFile<TrackFile>,
    table: &'static str,
    entries: &[T],
    ends_m: impl Fn(&T) -> (f64, f64),
) -> Result<(), ReadError> {
    let mut before = f64::NEG_INFINITY;
    for (index, one) in entries.iter().enumerate() {
        let (from_m, to_m) = ends_m(one);
        let entry = Entry { file, table, index };
        entry.ends(from_m, to_m)?;
        entry.need(from_m >= before, "from_m", || format!("{before} or more, where the entry before ends"), from_m)?;
        before = to_m;
    }
    Ok(())
}

/// An entry of a table, to be refused.
struct Entry<'a> {
    file: &'a TomlFile<TrackFile>,
    table: &'static str,
    index: usize,
}

impl Entry<'_> {
    fn refuse(&self, field: &str, expected: impl Display, found: f64) -> ReadError {
        let steps = [Step::Name(self.table), Step::Index(self.index), Step::Name(field)];
        self.file.refuse(&steps, format!("expected {expected}, found {found}"))
    }

    fn too_many(&self, most: usize, found: usize) -> ReadError {
        let steps = [Step::Name(self.table), Step::Index(self.index)];
        self.file.refuse(&steps, format!("expected at most {most}, found {found}"))
    }

    fn need(&self, good: bool, field: &str, expected: impl Fn() -> String, found: f64) -> Result<(), ReadError> {
        if good { Ok(()) } else { Err(self.refuse(field, expected(), found)) }
    }

    fn ends(&self, from_m: f64, to_m: f64) -> Result<(), ReadError> {
        self.need(to_m > from_m && to_m.is_finite(), "to_m", || format!("beyond from_m = {from_m}"), to_m)
    }

    fn within(&self, field: &str, found: f64, most: f64) -> Result<(), ReadError> {
        // NaN is in no range.
        self.need((-most..=most).contains(&found), field, || format!("{} to {most}", -most), found)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn message(tables: &str) -> String {
        let text = format!("name = \"line\"\nlength_m = 1000\n{tables}");
        TrackFile::parse("track.toml".as_ref(), &text).unwrap_err().to_string()
    }

    #[test]
    fn every_table_is_read() {
        let text = "name = \"line\"\nlength_m = 1000\n\
            [[gradient]]\nfrom_m = 0\npermille = 4\n[[curve]]\nfrom_m = 1\nto_m = 2\nradius_m = 300\n\
            [[tunnel]]\nfrom_m = 3\nto_m = 4\n[[speed_limit]]\nfrom_m = 0\nkmh = 40\n\
            [[feeding_section]]\nfrom_m = 0\nto_m = 9\nname = \"A\"\n[[stop]]\nat_m = 7\nname = \"B\"\n\
            [[centre_line]]\nat_m = 0\nlatitude_deg = 51\nlongitude_deg = 5\n\
            [[centre_line]]\nat_m = 900\nlatitude_deg = 51.01\nlongitude_deg = 5\n";
        let (file, track) = TrackFile::parse("track.toml".as_ref(), text).unwrap();
        assert_eq!(track.length_m(), 1000.0);
        assert_eq!((file.curve.len(), file.tunnel.len(), file.speed_limit.len()), (1, 1, 1));
        assert_eq!((file.feeding_section.len(), file.stop.len(), file.centre_line.len()), (1, 1, 2));
    }

    #[test]
    fn a_track_without_tables_is_flat() {
        let (file, _) = TrackFile::parse("t".as_ref(), "name = \"flat\"\nlength_m = 10.0\n").unwrap();
        assert!(file.gradient.is_empty());
    }

    #[test]
    fn unsorted_gradients_are_found_where_they_stand() {
        let found = message("[[gradient]]\nfrom_m = 100\npermille = 1\n[[gradient]]\nfrom_m = 50\npermille = 2\n");
        assert_eq!(
            found,
            "track.toml:7:10: gradient[1].from_m: expected beyond 100, where the entry before begins, found 50"
        );
        let found = message("[[gradient]]\nfrom_m = 100\npermille = 1\n[[gradient]]\nfrom_m = 100\npermille = 2\n");
        assert_eq!(
            found,
            "track.toml:7:10: gradient[1].from_m: expected beyond 100, where the entry before begins, found 100"
        );
    }

    #[test]
    fn every_other_table_must_be_sorted_too() {
        for (table, field, rest) in [
            ("curve", "from_m", "to_m = 500\nradius_m = 300\n"),
            ("tunnel", "from_m", "to_m = 500\n"),
            ("speed_limit", "from_m", "kmh = 40\n"),
            ("feeding_section", "from_m", "to_m = 500\nname = \"A\"\n"),
            ("stop", "at_m", "name = \"A\"\n"),
            ("centre_line", "at_m", "latitude_deg = 0\nlongitude_deg = 0\n"),
        ] {
            let entry = |at: u32| format!("[[{table}]]\n{field} = {at}\n{rest}");
            let found = message(&(entry(100) + &entry(50)));
            let expected = format!("{table}[1].{field}: expected beyond 100, where the entry before begins, found 50");
            assert!(found.ends_with(&expected), "{found}");
        }
    }

    #[test]
    fn overlapping_tunnels_and_feeding_sections_are_refused() {
        for (table, more) in [("tunnel", ""), ("feeding_section", "name = \"A\"\n")] {
            let entry = |from_m: u32, to_m: u32| format!("[[{table}]]\nfrom_m = {from_m}\nto_m = {to_m}\n{more}");
            let lines = 5 + more.lines().count();
            let found = message(&(entry(100, 300) + &entry(250, 400)));
            let line = lines + 2;
            let expected = "expected 300 or more, where the entry before ends, found 250";
            assert_eq!(found, format!("track.toml:{line}:10: {table}[1].from_m: {expected}"));
            let text = format!("name = \"line\"\nlength_m = 1000\n{}{}", entry(100, 300), entry(300, 400));
            assert!(TrackFile::parse("track.toml".as_ref(), &text).is_ok());
        }
    }

    #[test]
    fn impossible_values_are_refused() {
        assert!(
            message("[[gradient]]\nfrom_m = 0\npermille = 400\n")
                .starts_with("track.toml:5:12: gradient[0].permille: expected -200 to 200, found 400")
        );
        assert!(message("[[gradient]]\nfrom_m = nan\npermille = 4\n").starts_with("track.toml:4:10: "));
        assert_eq!(
            message("[[tunnel]]\nfrom_m = 9\nto_m = 9\n"),
            "track.toml:5:8: tunnel[0].to_m: expected beyond from_m = 9, found 9"
        );
        assert_eq!(
            message("[[speed_limit]]\nfrom_m = 9\nkmh = 651\n"),
            "track.toml:5:7: speed_limit[0].kmh: expected above 0, at most 650, found 651"
        );
        assert_eq!(
            message("[[speed_limit]]\nfrom_m = 9\nkmh = 0\n"),
            "track.toml:5:7: speed_limit[0].kmh: expected above 0, at most 650, found 0"
        );
        assert!(
            message("[[centre_line]]\nat_m = 0\nlatitude_deg = 95\nlongitude_deg = 0\n")
                .starts_with("track.toml:5:16: centre_line[0].latitude_deg: expected -90 to 90, found 95")
        );
        assert!(
            message("[[centre_line]]\nat_m = 0\nlatitude_deg = 5\nlongitude_deg = 0\n")
                .ends_with("at least 2 points, found 1")
        );
        let error = TrackFile::parse("t".as_ref(), "name = \"x\"\nlength_m = 0\n").unwrap_err();
        assert_eq!(error.to_string(), "t:2:12: length_m: expected above 0, found 0");
        assert!(
            message("[[gradients]]\nfrom_m = 0\npermille = 0\n")
                .starts_with("track.toml:3:3: unknown field `gradients`, expected one of `name`")
        );
    }

    #[test]
    fn what_lies_beyond_the_line_is_said() {
        let parse = |tables: &str| TrackFile::parse("t".as_ref(), &format!("name = \"l\"\nlength_m = 900\n{tables}"));
        let (file, _) =
            parse("[[stop]]\nat_m = 90000\nname = \"A\"\n[[speed_limit]]\nfrom_m = -50\nkmh = 9\n").unwrap();
        let said = "track: 1 speed_limit, 1 stop lie beyond the line, which goes from 0 to 900 m: is length_m right?";
        assert_eq!(file.beyond_the_line().as_deref(), Some(said));
        let (file, _) = parse("[[stop]]\nat_m = 900\nname = \"A\"\n[[gradient]]\nfrom_m = 0\npermille = 1\n").unwrap();
        assert_eq!(file.beyond_the_line(), None);
    }

    #[test]
    fn too_many_gradients_are_counted() {
        let entry = |index: usize| format!("[[gradient]]\nfrom_m = {index}\npermille = 0\n");
        let tables: String = (0..MAX_GRADIENTS + 2).map(entry).collect();
        let found = message(&tables);
        assert!(found.ends_with("gradient[512]: expected at most 512, found 514"), "{found}");
        assert!(found.starts_with(&format!("track.toml:{}:", 3 + 3 * MAX_GRADIENTS)), "{found}");
    }

    #[test]
    fn limits_and_stops_become_targets_and_too_many_are_counted() {
        let limit = |index: usize| format!("[[speed_limit]]\nfrom_m = {index}\nkmh = 36\n");
        let stop = |at_m: f64| format!("[[stop]]\nat_m = {at_m}\nname = \"s\"\n");
        let head = "name = \"t\"\nlength_m = 1000\n";
        let text = format!("{head}{}{}{}", limit(0), limit(500), stop(100.0));
        let (file, track) = TrackFile::parse("track.toml".as_ref(), &text).unwrap();
        let targets = file.targets();
        let places: Vec<(f64, Option<f64>)> = targets.iter().map(|t| (t.at_m, t.limit_mps)).collect();
        assert_eq!(places, [(0.0, Some(10.0)), (100.0, None), (500.0, Some(10.0))]);
        assert_eq!(track.targets(), 3);
        let many: String = (0..MAX_TARGETS).map(limit).collect();
        assert!(TrackFile::parse("track.toml".as_ref(), &format!("{head}{many}")).is_ok());
        let found = message(&(many + &stop(900.0)));
        assert!(
            found.ends_with("track.toml: expected at most 192 speed limits and stops together, found 193"),
            "{found}"
        );
    }
}
