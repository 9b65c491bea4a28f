//! Scenario files: a TOML file, see [`ScenarioFile`]; every field that is left out is that of the case study.
//!
//! In: a path or a text. Out: [`Simulation`], ready to be run. Errors name file, line and column.

use super::believed;
use jiff::civil::Date;
use rundown::model::bounds::OutOfRange;
use rundown_files::toml_file::{Step, TomlError, TomlFile};
use rundown_files::track_file::TrackFile;
use rundown_files::train_file::{DavisTable, TrainFile};
use rundown_truth::effects::Effect;
use rundown_truth::habits::DriverKind;
use rundown_truth::line::Line;
use rundown_truth::plan::{Dates, Headings};
use rundown_truth::scenario::{Scenario, UnscheduledStop};
use rundown_truth::sensors::{Bursts, LocationWalk, Sensors, SpeedReading};
use rundown_truth::train::{DavisTruth, TrainTruth};
use rundown_truth::weather::Climate;
use serde::{Deserialize, Serialize};
use std::path::Path;

/// A commented example: the case study with the loads, winds and powers of everyday.
pub const EXAMPLE: &str = include_str!("../../../data/scenarios/case_study.toml");

/// Runs on a line with a tunnel that nobody described.
pub const HIDDEN_EFFECT: &str = include_str!("../../../data/scenarios/hidden_effect.toml");

/// A scenario, ready to be run.
#[derive(Clone, Debug)]
pub struct Simulation {
    /// For people.
    pub name: String,
    /// What is simulated.
    pub scenario: Scenario,
    /// The track as described.
    pub track: TrackFile,
    /// The train as described.
    pub train: TrainFile,
    /// How many runs.
    pub runs: usize,
    /// Seed of all draws.
    pub seed: u64,
    /// Name of the vehicle.
    pub unit: String,
    /// Whether logs have the column of the effort.
    pub effort_column: bool,
    /// Whether logs have the column of the temperature.
    pub temperature_column: bool,
    /// The text it was read from.
    pub text: String,
}

/// What a scenario file holds.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct ScenarioFile {
    /// For people.
    pub name: String,
    /// How many runs.
    pub runs: usize,
    /// Seed of all draws.
    pub seed: u64,
    /// `up`, `down`, or `both` in turns.
    pub directions: DirectionsWord,
    /// Name of the vehicle.
    pub unit: String,
    /// Integration step, s.
    pub step_s: f64,
    /// Dates of the runs.
    pub dates: DatesTable,
    /// The line.
    pub line: LineTable,
    /// The train as described.
    pub train: TrainTable,
    /// The driver.
    pub driver: DriverTable,
    /// Wind along the line.
    pub wind: SpreadTable,
    /// Load of the day.
    pub load: LoadTable,
    /// Temperatures.
    pub temperature: TemperatureTable,
    /// The recorder.
    pub sensors: SensorTable,
    /// The column of the effort.
    pub effort: EffortTable,
    /// A red signal.
    pub red_signal: Option<RedSignalTable>,
    /// What the description does not have.
    pub effect: Vec<Effect>,
}

/// `directions`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum DirectionsWord {
    /// Locations grow.
    #[default]
    Up,
    /// Locations fall.
    Down,
    /// In turns, up first.
    Both,
}

/// `[dates]`.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct DatesTable {
    /// First day.
    pub start: String,
    /// The runs are spread over so many days.
    pub days: f64,
}

/// `[line]`: a name, or a track file.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct LineTable {
    /// `case_study`, `hilly`.
    pub name: Option<LineName>,
    /// Seed of a hilly line.
    pub seed: u64,
    /// A track file, beside the scenario file.
    pub file: Option<String>,
}

/// `line.name`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum LineName {
    /// 32 103 m, 140 km/h, 40 km/h at both ends, nearly flat.
    CaseStudy,
    /// The same with gradients up to 10 permille, drawn.
    Hilly,
}

/// `[train]`: as in a train file, and how the truth differs.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields, default)]
#[allow(missing_docs)]
pub struct TrainTable {
    pub name: String,
    pub mass_kg: f64,
    pub rotating_mass_factor: f64,
    pub length_m: f64,
    pub max_tractive_effort_n: f64,
    pub max_power_w: f64,
    pub max_brake_mps2: f64,
    pub davis: DavisTable,
    /// True over described r0, r1, r2.
    pub true_davis_over_described: [f64; 3],
}

/// `[driver]`.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct DriverTable {
    /// `intercity` or `short_hops`.
    pub kind: DriverWord,
    /// Share of the runs that cruise by turns of power and coast.
    pub cycle_share: f64,
    /// Share of the runs with a running brake test after the departure.
    pub brake_test_share: f64,
    /// Whether the log goes on for 30 to 60 s after the last stop.
    pub final_dwell: bool,
}

/// `driver.kind`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum DriverWord {
    /// One long run, a long final coast.
    #[default]
    Intercity,
    /// Stops every 4 to 6 km unless the line has its own.
    ShortHops,
}

/// `[wind]`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct SpreadTable {
    /// Standard deviation between runs, m/s.
    pub sd_mps: f64,
}

/// `[load]`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct LoadTable {
    /// Standard deviation between runs as a share of the mass.
    pub sd: f64,
}

/// `[temperature]`.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields, default)]
#[allow(missing_docs)]
pub struct TemperatureTable {
    /// Whether logs have the column `ambient_temperature_c`.
    pub column: bool,
    pub mean_c: f64,
    pub yearly_c: f64,
    pub daily_c: f64,
    pub run_sd_c: f64,
    pub drift_sd_c_per_h: f64,
}

/// `[sensors]`.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields, default)]
#[allow(missing_docs)]
pub struct SensorTable {
    pub sampling_s: f64,
    pub speed: SpeedWord,
    pub speed_quantum_kmh: f64,
    pub speed_noise_kmh: f64,
    /// White noise.
    pub location_sd_m: f64,
    /// Slow noise, with its time constant.
    pub location_walk_sd_m: f64,
    pub location_walk_s: f64,
    /// Age of location and speed.
    pub latency_s: f64,
    /// Further age of the location.
    pub location_lag_s: f64,
    /// Share of readings that are lost, each on its own.
    pub dropout_share: f64,
    /// Share of samples at which a longer gap begins.
    pub gap_share: f64,
    /// Its least and greatest length in samples.
    pub gap_samples: [usize; 2],
}

/// `sensors.speed`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
#[allow(missing_docs)]
pub enum SpeedWord {
    #[default]
    Rounded,
    Truncated,
    Exact,
}

/// `[effort]`.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields, default)]
#[allow(missing_docs)]
pub struct EffortTable {
    /// Whether logs have the column `effort_n_per_kg`.
    pub column: bool,
    /// At the moment of the sample, not the mean since the sample before.
    pub momentary: bool,
    pub gain: f64,
    /// Standard deviation of the gain between runs.
    pub gain_sd: f64,
    pub noise_n_per_kg: f64,
}

/// `[red_signal]`.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
#[allow(missing_docs)]
pub struct RedSignalTable {
    /// Along the way travelled.
    pub at_m: f64,
    pub dwell_s: f64,
    /// Share of the runs that meet it.
    #[serde(default = "all")]
    pub share: f64,
}

fn all() -> f64 {
    1.0
}

impl Default for ScenarioFile {
    fn default() -> Self {
        Self {
            name: "case study".to_owned(),
            runs: 67,
            seed: 1,
            directions: DirectionsWord::Up,
            unit: "unit-1".to_owned(),
            step_s: Scenario::default().step_s,
            dates: DatesTable::default(),
            line: LineTable::default(),
            train: TrainTable::default(),
            driver: DriverTable::default(),
            wind: SpreadTable::default(),
            load: LoadTable::default(),
            temperature: TemperatureTable::default(),
            sensors: SensorTable::default(),
            effort: EffortTable::default(),
            red_signal: None,
            effect: Vec::new(),
        }
    }
}

impl Default for DatesTable {
    fn default() -> Self {
        Self { start: "2024-01-08".to_owned(), days: Dates::default().days }
    }
}

impl Default for LineTable {
    fn default() -> Self {
        Self { name: None, seed: 1, file: None }
    }
}

impl Default for TrainTable {
    fn default() -> Self {
        Self::of(&TrainTruth::default())
    }
}

impl TrainTable {
    /// The table of a train that is as described.
    pub fn of(train: &TrainTruth) -> Self {
        Self {
            name: "double-deck electric unit, six cars".to_owned(),
            mass_kg: train.mass_kg,
            rotating_mass_factor: train.gamma,
            length_m: train.length_m,
            max_tractive_effort_n: train.max_tractive_effort_n,
            max_power_w: train.max_power_w,
            max_brake_mps2: train.max_brake_mps2,
            davis: DavisTable { r0: train.davis.r0, r1: train.davis.r1, r2: train.davis.r2 },
            true_davis_over_described: [1.0; 3],
        }
    }
}

impl Default for DriverTable {
    fn default() -> Self {
        let scenario = Scenario::default();
        Self {
            kind: DriverWord::Intercity,
            cycle_share: scenario.cycle_share,
            brake_test_share: scenario.brake_test_share,
            final_dwell: scenario.final_dwell,
        }
    }
}

impl Default for TemperatureTable {
    fn default() -> Self {
        let climate = Climate::default();
        Self {
            column: false,
            mean_c: climate.mean_c,
            yearly_c: climate.yearly_c,
            daily_c: climate.daily_c,
            run_sd_c: climate.run_sd_c,
            drift_sd_c_per_h: climate.drift_sd_c_per_h,
        }
    }
}

impl Default for SensorTable {
    fn default() -> Self {
        let sensors = Sensors::default();
        Self {
            sampling_s: sensors.sampling_s,
            speed: SpeedWord::Rounded,
            speed_quantum_kmh: sensors.speed_quantum_kmh,
            speed_noise_kmh: sensors.speed_noise_kmh,
            location_sd_m: sensors.location_noise_m,
            location_walk_sd_m: 0.0,
            location_walk_s: LocationWalk::of(0.0).tau_s,
            latency_s: sensors.latency_s,
            location_lag_s: sensors.location_lag_s,
            dropout_share: sensors.dropout_probability,
            gap_share: 0.0,
            gap_samples: [3, 12],
        }
    }
}

impl Default for EffortTable {
    fn default() -> Self {
        Self { column: false, momentary: false, gain: 1.0, gain_sd: 0.0, noise_n_per_kg: 0.0 }
    }
}

impl Simulation {
    /// Reads and checks a scenario file; a track file that it names lies beside it.
    ///
    /// # Errors
    /// [`TomlError`] names file, line and column.
    pub fn read(path: &Path) -> Result<Self, TomlError> {
        let text = std::fs::read_to_string(path).map_err(|source| TomlError::Io { path: path.to_owned(), source })?;
        Self::parse(path, &text)
    }

    /// Reads and checks a text; `path` is for the messages and for a track file beside it.
    ///
    /// # Errors
    /// As [`Simulation::read`].
    ///
    /// ```
    /// use sim_harness::simulation::scenario_file::Simulation;
    ///
    /// let text = "runs = 3\n[[effect]]\nname = \"steady_wind\"\nwind_mps = 4\n";
    /// let simulation = Simulation::parse("s.toml".as_ref(), text)?;
    /// assert_eq!(simulation.scenario.effects[0].name(), "steady_wind");
    /// let error = Simulation::parse("s.toml".as_ref(), "rums = 3\n").unwrap_err().to_string();
    /// assert!(error.starts_with("s.toml:1:1: unknown field `rums`"));
    /// # Ok::<(), rundown_files::toml_file::TomlError>(())
    /// ```
    pub fn parse(path: &Path, text: &str) -> Result<Self, TomlError> {
        let file: TomlFile<ScenarioFile> = TomlFile::parse(path, text)?;
        check_numbers(&file)?;
        let values = &file.values;
        let (line, track) = line(&file, path)?;
        let train = believed::train_file(&values.train);
        let refused =
            |error: OutOfRange| file.refuse_dotted(&format!("train.{}", error.field), format!("train.{error}"));
        train.train().map_err(refused)?;
        for (index, effect) in values.effect.iter().enumerate() {
            let place = [Step::Name("effect"), Step::Index(index)];
            effect.check(!line.curves().is_empty()).map_err(|error| file.refuse(&place, error.to_string()))?;
        }
        let dates = dates(&file)?;
        Ok(Self {
            name: values.name.clone(),
            scenario: scenario(values, line, dates),
            track,
            train,
            runs: values.runs,
            seed: values.seed,
            unit: values.unit.clone(),
            effort_column: values.effort.column,
            temperature_column: values.temperature.column,
            text: text.to_owned(),
        })
    }
}

fn scenario(values: &ScenarioFile, line: Line, dates: Dates) -> Scenario {
    let train = &values.train;
    let DavisTable { r0, r1, r2 } = train.davis;
    let sensors = &values.sensors;
    let temperature = values.temperature;
    Scenario {
        train: TrainTruth {
            mass_kg: train.mass_kg,
            gamma: train.rotating_mass_factor,
            length_m: train.length_m,
            davis: DavisTruth { r0, r1, r2 },
            max_tractive_effort_n: train.max_tractive_effort_n,
            max_power_w: train.max_power_w,
            max_brake_mps2: train.max_brake_mps2,
        },
        line,
        driver: match values.driver.kind {
            DriverWord::Intercity => DriverKind::CaseStudy,
            DriverWord::ShortHops => DriverKind::ShortHop,
        },
        cycle_share: values.driver.cycle_share,
        brake_test_share: values.driver.brake_test_share,
        final_dwell: values.driver.final_dwell,
        unscheduled_stop: values.red_signal.map(|red| UnscheduledStop {
            at_m: red.at_m,
            dwell_s: red.dwell_s,
            share: red.share,
        }),
        davis_scale: train.true_davis_over_described,
        wind_sd_mps: values.wind.sd_mps,
        load_sd: values.load.sd,
        headings: match values.directions {
            DirectionsWord::Up => Headings::Up,
            DirectionsWord::Down => Headings::Down,
            DirectionsWord::Both => Headings::Both,
        },
        dates,
        climate: Climate {
            mean_c: temperature.mean_c,
            yearly_c: temperature.yearly_c,
            daily_c: temperature.daily_c,
            run_sd_c: temperature.run_sd_c,
            drift_sd_c_per_h: temperature.drift_sd_c_per_h,
        },
        effects: values.effect.clone(),
        step_s: values.step_s,
        sensors: Sensors {
            sampling_s: sensors.sampling_s,
            speed: match sensors.speed {
                SpeedWord::Rounded => SpeedReading::Rounded,
                SpeedWord::Truncated => SpeedReading::Truncated,
                SpeedWord::Exact => SpeedReading::Exact,
            },
            speed_quantum_kmh: sensors.speed_quantum_kmh,
            speed_noise_kmh: sensors.speed_noise_kmh,
            speed_gain: 1.0,
            location_noise_m: sensors.location_sd_m,
            location_walk: (sensors.location_walk_sd_m > 0.0)
                .then_some(LocationWalk { sd_m: sensors.location_walk_sd_m, tau_s: sensors.location_walk_s }),
            dropout_probability: sensors.dropout_share,
            bursts: (sensors.gap_share > 0.0)
                .then_some(Bursts { probability: sensors.gap_share, samples: sensors.gap_samples }),
            latency_s: sensors.latency_s,
            location_lag_s: sensors.location_lag_s,
            effort_gain: values.effort.gain,
            effort_momentary: values.effort.momentary,
            effort_gain_sd: values.effort.gain_sd,
            effort_noise_n_per_kg: values.effort.noise_n_per_kg,
        },
    }
}

/// Ranges of the plain numbers.
fn check_numbers(file: &TomlFile<ScenarioFile>) -> Result<(), TomlError> {
    let v = &file.values;
    let within = |field: &str, found: f64, least: f64, most: f64| {
        if (least..=most).contains(&found) {
            return Ok(());
        }
        let message = format!("scenario: expected {field} within {least} to {most}, found {found}");
        Err(file.refuse_dotted(field, message))
    };
    within("runs", v.runs as f64, 1.0, 1e6)?;
    within("step_s", v.step_s, 0.005, 0.05)?;
    divides(file, "step_s", "1 s", 1.0)?;
    divides(file, "sensors.sampling_s", "sampling_s", v.sensors.sampling_s)?;
    within("dates.days", v.dates.days, 0.001, 36_525.0)?;
    let d = &v.driver;
    within("driver.cycle_share", d.cycle_share, 0.0, 1.0)?;
    within("driver.brake_test_share", d.brake_test_share, 0.0, 1.0)?;
    within("wind.sd_mps", v.wind.sd_mps, 0.0, 20.0)?;
    within("load.sd", v.load.sd, 0.0, 0.3)?;
    let s = &v.sensors;
    for (name, found, least, most) in [
        ("sampling_s", s.sampling_s, 0.005, 600.0),
        ("speed_quantum_kmh", s.speed_quantum_kmh, 1e-6, 50.0),
        ("speed_noise_kmh", s.speed_noise_kmh, 0.0, 50.0),
        ("location_sd_m", s.location_sd_m, 0.0, 10_000.0),
        ("location_walk_sd_m", s.location_walk_sd_m, 0.0, 10_000.0),
        ("location_walk_s", s.location_walk_s, 0.1, 1e6),
        ("latency_s", s.latency_s, 0.0, 600.0),
        ("location_lag_s", s.location_lag_s, 0.0, 600.0),
        ("dropout_share", s.dropout_share, 0.0, 0.9),
        ("gap_share", s.gap_share, 0.0, 0.9),
    ] {
        within(&format!("sensors.{name}"), found, least, most)?;
    }
    let [least, most] = s.gap_samples;
    if least == 0 || most < least {
        let message = format!("scenario: expected gap_samples = [least, most] with 1 or more, found [{least}, {most}]");
        return Err(file.refuse_dotted("sensors.gap_samples", message));
    }
    let e = &v.effort;
    within("effort.gain", e.gain, 0.1, 10.0)?;
    within("effort.gain_sd", e.gain_sd, 0.0, 0.3)?;
    within("effort.noise_n_per_kg", e.noise_n_per_kg, 0.0, 1.0)?;
    let t = &v.temperature;
    for (name, found) in [
        ("mean_c", t.mean_c),
        ("yearly_c", t.yearly_c),
        ("daily_c", t.daily_c),
        ("run_sd_c", t.run_sd_c),
        ("drift_sd_c_per_h", t.drift_sd_c_per_h),
    ] {
        within(&format!("temperature.{name}"), found, -80.0, 80.0)?;
    }
    for (index, scale) in v.train.true_davis_over_described.into_iter().enumerate() {
        if !(0.0..=10.0).contains(&scale) {
            let place = [Step::Name("train"), Step::Name("true_davis_over_described"), Step::Index(index)];
            let message = format!("scenario: expected a factor within 0 to 10, found {scale}");
            return Err(file.refuse(&place, message));
        }
    }
    if let Some(red) = v.red_signal {
        within("red_signal.at_m", red.at_m, 500.0, 1e7)?;
        within("red_signal.dwell_s", red.dwell_s, 1.0, 3600.0)?;
        within("red_signal.share", red.share, 0.0, 1.0)?;
    }
    Ok(())
}

/// The step divides a whole number of times, so that rows and samples fall on it.
fn divides(file: &TomlFile<ScenarioFile>, field: &str, name: &str, whole: f64) -> Result<(), TomlError> {
    let step_s = file.values.step_s;
    let count = (whole / step_s).round();
    if count >= 1.0 && (count * step_s - whole).abs() < 1e-9 {
        return Ok(());
    }
    let message = format!("scenario: expected step_s = {step_s} to divide {name}, found {whole} s");
    Err(file.refuse_dotted(field, message))
}

fn dates(file: &TomlFile<ScenarioFile>) -> Result<Dates, TomlError> {
    let DatesTable { start, days } = &file.values.dates;
    let start_s = start
        .parse::<Date>()
        .and_then(|date| date.to_zoned(jiff::tz::TimeZone::UTC))
        .map(|midnight| midnight.timestamp().as_second())
        .map_err(|_| {
            let message = format!("scenario: expected start as \"2024-01-08\", found \"{start}\"");
            file.refuse_dotted("dates.start", message)
        })?;
    Ok(Dates { start_s, days: *days })
}

fn line(file: &TomlFile<ScenarioFile>, path: &Path) -> Result<(Line, TrackFile), TomlError> {
    let LineTable { name, seed, file: track } = &file.values.line;
    let Some(track) = track else {
        let (line, title) = match name.unwrap_or(LineName::CaseStudy) {
            LineName::CaseStudy => (Line::flat_corridor(), "case study corridor".to_owned()),
            LineName::Hilly => (Line::hilly(*seed), format!("hilly line {seed}")),
        };
        let track = believed::corridor(&line, title);
        return Ok((line, track));
    };
    if name.is_some() {
        let message = "scenario: expected a name or a file of the line, found both";
        return Err(file.refuse_dotted("line.file", message));
    }
    let track_path = path.parent().unwrap_or(Path::new("")).join(track);
    let (track, _) = TrackFile::read(&track_path)?;
    if track.speed_limit.is_empty() {
        let message =
            format!("scenario: expected a track with [[speed_limit]], found none in {}", track_path.display());
        return Err(file.refuse_dotted("line.file", message));
    }
    Ok((believed::line_of(&track), track))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parse(text: &str) -> Result<Simulation, TomlError> {
        Simulation::parse(Path::new("s.toml"), text)
    }

    #[test]
    fn an_empty_file_is_the_case_study() {
        let simulation = parse("").unwrap();
        assert_eq!(simulation.scenario, Scenario::default());
        assert_eq!((simulation.runs, simulation.seed), (67, 1));
        assert_eq!(simulation.track.length_m, 32_103.0);
    }

    #[test]
    fn the_example_says_the_defaults_but_for_wind_and_load() {
        let example = parse(EXAMPLE).unwrap();
        let default = parse("").unwrap();
        let calm = Scenario { wind_sd_mps: 0.0, load_sd: 0.0, ..example.scenario };
        assert_eq!(calm, default.scenario);
        assert_eq!(example.train, default.train);
        assert_eq!(example.unit, default.unit);
    }

    #[test]
    fn refusals_name_line_and_column() {
        let error = |text: &str| parse(text).unwrap_err().to_string();
        assert_eq!(
            error("[dates]\nstart = \"monday\"\n"),
            "s.toml:2:9: scenario: expected start as \"2024-01-08\", found \"monday\""
        );
        assert_eq!(
            error("[sensors]\nsampling_s = 5.01\n"),
            "s.toml:2:14: scenario: expected step_s = 0.05 to divide sampling_s, found 5.01 s"
        );
        assert_eq!(error("[train]\nmass_kg = 5\n"), "s.toml:2:11: train.mass_kg: expected 1000 to 100000000, found 5");
        assert_eq!(
            error("\n[[effect]]\nname = \"tunnel_drag\"\nfrom_m = 5\nto_m = 4\nk = 1\n"),
            "s.toml:2:1: tunnel_drag.to_m: expected beyond from_m, found 4"
        );
        assert!(error("[line]\nfile = \"no.toml\"\n").starts_with("no.toml: cannot be read"));
        assert!(error("[driver]\nkindd = 1\n").starts_with("s.toml:2:1: unknown field `kindd`"));
    }
}
