//! Scenario files: a TOML file, explained by [`EXAMPLE`]; every field that is left out is that of the case study.
//!
//! In: a path or a text. Out: [`Simulation`], ready to be run. Errors name file, line and column.

use super::believed;
use jiff::civil::Date;
use rundown::{model::resistance::Davis, model::train::TrainDescription};
use rundown_files::toml_file::{Step, TomlFile};
use rundown_files::{effect_file::refuse_effect, refusal::ReadError, track_file::TrackFile, train_file::TrainFile};
use rundown_truth::plan::{Dates, Headings};
use rundown_truth::recorders::Recorder;
use rundown_truth::scenario::{Scenario, UnscheduledStop};
use rundown_truth::sensors::{Bursts, LocationWalk, Sensors, SpeedReading};
use rundown_truth::train::{DavisTruth, TrainTruth};
use rundown_truth::{effects::Effect, habits::DriverKind, line::Line, weather::Climate};
use serde::Deserialize;
use std::path::{Path, PathBuf};

/// A commented example with every field: the case study with the loads, winds and powers of everyday.
pub const EXAMPLE: &str = include_str!("../../../data/scenarios/case_study.toml");

/// Runs on a line with an undescribed tunnel.
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
    /// The file of this text, where there is one.
    pub file: Option<PathBuf>,
}

/// The tables of a scenario file, each field with its type, what it is where it is left out, and for a number its
/// range. Every field is explained in [`EXAMPLE`]. What is the truth's own is read into the truth's types; a table of
/// its own here has fields that the truth has elsewhere.
macro_rules! tables {
    ($($name:ident in $table:literal { $($field:ident: $type:ty = $default:expr $(, $least:literal to $most:literal)?;)* })*) => {$(
        #[derive(Deserialize)]
        #[serde(deny_unknown_fields, default)]
        struct $name {
            $($field: $type,)*
        }

        impl Default for $name {
            fn default() -> Self {
                Self { $($field: $default,)* }
            }
        }

        impl $name {
            /// Each number with its least and its most.
            fn numbers(&self) -> Vec<(&'static str, f64, f64, f64)> {
                vec![$($((concat!($table, stringify!($field)), self.$field as f64, $least, $most),)?)*]
            }
        }
    )*};
}

tables! {
    ScenarioFile in "" {
        name: String = "case study".to_owned();
        runs: usize = 67, 1.0 to 1e6;
        seed: u64 = 1;
        directions: Headings = Scenario::default().headings;
        unit: String = "unit-1".to_owned();
        step_s: f64 = Scenario::default().step_s, 0.005 to 0.05;
        dates: DatesTable = DatesTable::default();
        line: LineTable = LineTable::default();
        train: TrainTable = TrainTable::default();
        driver: DriverTable = DriverTable::default();
        wind: WindTable = WindTable::default();
        load: LoadTable = LoadTable::default();
        temperature: TemperatureTable = TemperatureTable::default();
        sensors: SensorTable = SensorTable::default();
        effort: EffortTable = EffortTable::default();
        red_signal: Option<UnscheduledStop> = None;
        effect: Vec<Effect> = Vec::new();
    }
    DatesTable in "dates." {
        start: String = "2024-01-08".to_owned();
        days: f64 = Dates::default().days, 0.001 to 36_525.0;
    }
    // A name, or a track file beside the scenario file.
    LineTable in "line." {
        name: Option<LineName> = None;
        seed: u64 = 1;
        file: Option<String> = None;
    }
    TrainTable in "train." {
        name: String = believed::TRAIN_NAME.to_owned();
        mass_kg: f64 = TrainTruth::default().mass_kg;
        rotating_mass_factor: f64 = TrainTruth::default().gamma;
        length_m: f64 = TrainTruth::default().length_m;
        max_tractive_effort_n: f64 = TrainTruth::default().max_tractive_effort_n;
        max_power_w: f64 = TrainTruth::default().max_power_w;
        max_brake_mps2: f64 = TrainTruth::default().max_brake_mps2;
        notches: u8 = Scenario::default().notches, 0.0 to 32.0;
        davis: Davis = TrainDescription::CASE_STUDY.davis;
        true_davis_over_described: [f64; 3] = [1.0; 3];
    }
    DriverTable in "driver." {
        kind: DriverKind = Scenario::default().driver;
        drivers: usize = Scenario::default().drivers, 0.0 to 1000.0;
        cycle_share: f64 = Scenario::default().cycle_share, 0.0 to 1.0;
        coast_brake_n_per_kg: f64 = Scenario::default().coast_brake_n_per_kg, 0.0 to 0.3;
        brake_test_share: f64 = Scenario::default().brake_test_share, 0.0 to 1.0;
        final_dwell: bool = Scenario::default().final_dwell;
    }
    WindTable in "wind." {
        sd_mps: f64 = 0.0, 0.0 to 20.0;
    }
    LoadTable in "load." {
        sd: f64 = 0.0, 0.0 to 0.3;
    }
    SensorTable in "sensors." {
        sampling_s: f64 = Sensors::default().sampling_s, 0.005 to 600.0;
        speed: SpeedReading = Sensors::default().speed;
        speed_quantum_kmh: f64 = Sensors::default().speed_quantum_kmh, 1e-6 to 50.0;
        speed_noise_kmh: f64 = Sensors::default().speed_noise_kmh, 0.0 to 50.0;
        location_sd_m: f64 = Sensors::default().location_noise_m, 0.0 to 10_000.0;
        location_walk_sd_m: f64 = 0.0, 0.0 to 10_000.0;
        location_walk_s: f64 = LocationWalk::of(0.0).tau_s, 0.1 to 1e6;
        latency_s: f64 = Sensors::default().latency_s, 0.0 to 600.0;
        location_offset_m: f64 = 0.0, -10_000.0 to 10_000.0;
        location_lag_s: f64 = Sensors::default().location_lag_s, 0.0 to 600.0;
        dropout_share: f64 = Sensors::default().dropout_probability, 0.0 to 0.9;
        gap_share: f64 = 0.0, 0.0 to 0.9;
        gap_samples: [usize; 2] = [3, 12];
        recorder: Option<Recorder> = None;
        speed_lag_s: [f64; 2] = [0.0; 2];
        location_step_m: f64 = 0.0, 0.0 to 1000.0;
        location_by_wheel: bool = false;
        stuck_share: f64 = 0.0, 0.0 to 0.9;
        stuck_samples: [usize; 2] = [8, 25];
        lost_second_every_s: f64 = 0.0, 0.0 to 86_400.0;
        standing_rows: bool = true;
        day_clock_s: Option<[f64; 2]> = None;
    }
    EffortTable in "effort." {
        column: bool = false;
        momentary: bool = false;
        gain: f64 = 1.0, 0.1 to 10.0;
        gain_sd: f64 = 0.0, 0.0 to 0.3;
        brake_gain: f64 = 1.0, 0.0 to 10.0;
        electric_brake_only: bool = false;
        noise_n_per_kg: f64 = 0.0, 0.0 to 1.0;
        step_n_per_kg: f64 = 0.0, 0.0 to 1.0;
        lag_s: f64 = 0.0, 0.0 to 600.0;
    }
    TemperatureTable in "temperature." {
        column: bool = false;
        mean_c: f64 = Climate::default().mean_c, -80.0 to 80.0;
        yearly_c: f64 = Climate::default().yearly_c, -80.0 to 80.0;
        daily_c: f64 = Climate::default().daily_c, -80.0 to 80.0;
        run_sd_c: f64 = Climate::default().run_sd_c, -80.0 to 80.0;
        drift_sd_c_per_h: f64 = Climate::default().drift_sd_c_per_h, -80.0 to 80.0;
    }
}

#[derive(Clone, Copy, Deserialize)]
#[serde(rename_all = "snake_case")]
enum LineName {
    CaseStudy,
    Hilly,
}

impl TrainTable {
    /// The described train as the truth has it.
    fn truth(&self) -> TrainTruth {
        let Self { mass_kg, rotating_mass_factor: gamma, length_m, davis: Davis { r0, r1, r2 }, .. } = *self;
        let Self { max_tractive_effort_n, max_power_w, max_brake_mps2, .. } = *self;
        let davis = DavisTruth { r0, r1, r2 };
        TrainTruth { mass_kg, gamma, length_m, davis, max_tractive_effort_n, max_power_w, max_brake_mps2 }
    }
}

impl SensorTable {
    /// `given`: whether the file has a field. What it leaves out is that of the recorder, or else of the case study.
    fn sensors(&self, effort: &EffortTable, given: &dyn Fn(&str) -> bool) -> Sensors {
        let walk = LocationWalk { sd_m: self.location_walk_sd_m, tau_s: self.location_walk_s };
        let bursts = |probability, samples| (probability > 0.0).then_some(Bursts { probability, samples });
        let own = Sensors {
            sampling_s: self.sampling_s,
            speed: self.speed,
            speed_quantum_kmh: self.speed_quantum_kmh,
            speed_noise_kmh: self.speed_noise_kmh,
            location_noise_m: self.location_sd_m,
            location_walk: (walk.sd_m > 0.0).then_some(walk),
            dropout_probability: self.dropout_share,
            bursts: bursts(self.gap_share, self.gap_samples),
            latency_s: self.latency_s,
            location_offset_m: self.location_offset_m,
            location_lag_s: self.location_lag_s,
            speed_lag_s: self.speed_lag_s,
            location_step_m: self.location_step_m,
            location_by_wheel: self.location_by_wheel,
            location_stuck: bursts(self.stuck_share, self.stuck_samples),
            lost_second_every_s: self.lost_second_every_s,
            standing_rows: self.standing_rows,
            day_clock_s: self.day_clock_s,
            effort_gain: effort.gain,
            brake_gain: effort.brake_gain,
            effort_momentary: effort.momentary,
            effort_gain_sd: effort.gain_sd,
            effort_noise_n_per_kg: effort.noise_n_per_kg,
            effort_step_n_per_kg: effort.step_n_per_kg,
            effort_lag_s: effort.lag_s,
            ..Sensors::default()
        };
        let Some(recorder) = self.recorder else {
            return own;
        };
        let mut sensors = Sensors {
            effort_gain: own.effort_gain,
            brake_gain: own.brake_gain,
            effort_momentary: own.effort_momentary,
            effort_gain_sd: own.effort_gain_sd,
            effort_noise_n_per_kg: own.effort_noise_n_per_kg,
            effort_step_n_per_kg: own.effort_step_n_per_kg,
            effort_lag_s: own.effort_lag_s,
            ..recorder.sensors()
        };
        /// Takes a property from the file where one of its fields is there.
        macro_rules! take {
            ($($property:ident by $($field:literal)+;)*) => {
                $(if $(given($field))||+ { sensors.$property = own.$property; })*
            };
        }
        take! {
            sampling_s by "sampling_s";
            speed by "speed";
            speed_quantum_kmh by "speed_quantum_kmh";
            speed_noise_kmh by "speed_noise_kmh";
            location_noise_m by "location_sd_m";
            location_walk by "location_walk_sd_m" "location_walk_s";
            dropout_probability by "dropout_share";
            bursts by "gap_share" "gap_samples";
            latency_s by "latency_s";
            location_offset_m by "location_offset_m";
            location_lag_s by "location_lag_s";
            speed_lag_s by "speed_lag_s";
            location_step_m by "location_step_m";
            location_by_wheel by "location_by_wheel";
            location_stuck by "stuck_share" "stuck_samples";
            lost_second_every_s by "lost_second_every_s";
            standing_rows by "standing_rows";
            day_clock_s by "day_clock_s";
        }
        sensors
    }
}

impl Simulation {
    /// Reads and checks a scenario file; a track file that it names lies beside it.
    pub fn read(path: &Path) -> Result<Self, ReadError> {
        Self::read_with(path, None)
    }

    /// The same with a recorder in place of the one that the file names.
    ///
    /// # Errors
    /// As [`Simulation::read`].
    pub fn read_with(path: &Path, recorder: Option<Recorder>) -> Result<Self, ReadError> {
        let text = std::fs::read_to_string(path).map_err(|source| ReadError::Io { path: path.to_owned(), source })?;
        log::info!("read {}", path.display());
        let parsed = Self::parse_with(path, &text, recorder)?;
        Ok(Self { file: Some(path.to_owned()), ..parsed })
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
    /// # Ok::<(), rundown_files::refusal::ReadError>(())
    /// ```
    pub fn parse(path: &Path, text: &str) -> Result<Self, ReadError> {
        Self::parse_with(path, text, None)
    }

    /// The same with a recorder in place of the one that the text names; what the text says of single properties stays.
    ///
    /// # Errors
    /// As [`Simulation::read`].
    pub fn parse_with(path: &Path, text: &str, recorder: Option<Recorder>) -> Result<Self, ReadError> {
        let mut file: TomlFile<ScenarioFile> = TomlFile::parse(path, text)?;
        check_numbers(&file)?;
        if recorder.is_some() {
            file.values.sensors.recorder = recorder;
        }
        let given = |field: &str| file.has(&format!("sensors.{field}"));
        let values = &file.values;
        let (line, track) = line(&file, path)?;
        let train = believed::train_file(&values.train.name, &values.train.truth());
        train.train().map_err(|error| file.refuse_error(&[Step::Name("train")], &error))?;
        for (index, effect) in values.effect.iter().enumerate() {
            let refuse = |error| refuse_effect(&file, index, effect.name(), &error);
            effect.check(!line.curves().is_empty(), line.length_m()).map_err(refuse)?;
        }
        let dates = dates(&file)?;
        Ok(Self {
            name: values.name.clone(),
            scenario: scenario(values, line, dates, &given),
            track,
            train,
            runs: values.runs,
            seed: values.seed,
            unit: values.unit.clone(),
            effort_column: values.effort.column,
            temperature_column: values.temperature.column,
            text: match recorder {
                Some(recorder) => format!("# rundown simulate --recorder {}\n{text}", recorder.name()),
                None => text.to_owned(),
            },
            file: None,
        })
    }
}

fn scenario(values: &ScenarioFile, line: Line, dates: Dates, given: &dyn Fn(&str) -> bool) -> Scenario {
    let TemperatureTable { mean_c, yearly_c, daily_c, run_sd_c, drift_sd_c_per_h, .. } = values.temperature;
    Scenario {
        train: values.train.truth(),
        line,
        driver: values.driver.kind,
        drivers: values.driver.drivers,
        notches: values.train.notches,
        electric_brake_only: values.effort.electric_brake_only,
        cycle_share: values.driver.cycle_share,
        coast_brake_n_per_kg: values.driver.coast_brake_n_per_kg,
        brake_test_share: values.driver.brake_test_share,
        final_dwell: values.driver.final_dwell,
        unscheduled_stop: values.red_signal,
        davis_scale: values.train.true_davis_over_described,
        wind_sd_mps: values.wind.sd_mps,
        load_sd: values.load.sd,
        headings: values.directions,
        dates,
        climate: Climate { mean_c, yearly_c, daily_c, run_sd_c, drift_sd_c_per_h },
        effects: values.effect.clone(),
        step_s: values.step_s,
        sensors: values.sensors.sensors(&values.effort, given),
    }
}

/// Ranges of the plain numbers.
fn check_numbers(file: &TomlFile<ScenarioFile>) -> Result<(), ReadError> {
    let v = &file.values;
    within(file, &v.numbers())?;
    divides(file, "step_s", 1.0)?;
    divides(file, "sensors.sampling_s", v.sensors.sampling_s)?;
    let tables = [v.dates.numbers(), v.line.numbers(), v.train.numbers(), v.driver.numbers(), v.wind.numbers()];
    let more = [v.load.numbers(), v.sensors.numbers(), v.effort.numbers(), v.temperature.numbers()];
    within(file, &[tables.concat(), more.concat()].concat())?;
    for (field, [least, most]) in [("gap_samples", v.sensors.gap_samples), ("stuck_samples", v.sensors.stuck_samples)] {
        if least == 0 || most < least {
            let message = format!("expected [least, most] with 1 or more, found [{least}, {most}]");
            return Err(file.refuse_dotted(&format!("sensors.{field}"), message));
        }
    }
    let ranges =
        [("speed_lag_s", Some(v.sensors.speed_lag_s), 600.0), ("day_clock_s", v.sensors.day_clock_s, 86_400.0)];
    for (field, range, limit) in ranges {
        let Some([least, most]) = range else {
            continue;
        };
        if !(0.0 <= least && least <= most && most <= limit) {
            let message = format!("expected [least, most] from 0 to {limit}, found [{least}, {most}]");
            return Err(file.refuse_dotted(&format!("sensors.{field}"), message));
        }
    }
    for (index, scale) in v.train.true_davis_over_described.into_iter().enumerate() {
        if !(0.0..=10.0).contains(&scale) {
            let place = [Step::Name("train"), Step::Name("true_davis_over_described"), Step::Index(index)];
            let message = format!("expected a factor of 0 to 10, found {scale}");
            return Err(file.refuse(&place, message));
        }
    }
    let Some(red) = v.red_signal else { return Ok(()) };
    let numbers = [
        ("red_signal.at_m", red.at_m, 500.0, 1e7),
        ("red_signal.dwell_s", red.dwell_s, 1.0, 3600.0),
        ("red_signal.share", red.share, 0.0, 1.0),
    ];
    within(file, &numbers)
}

/// Each number lies between its least and its most; also taken by NaN.
fn within(file: &TomlFile<ScenarioFile>, numbers: &[(&str, f64, f64, f64)]) -> Result<(), ReadError> {
    for &(field, found, least, most) in numbers {
        if !(least..=most).contains(&found) {
            let message = format!("expected {least} to {most}, found {found}");
            return Err(file.refuse_dotted(field, message));
        }
    }
    Ok(())
}

/// A time is a whole number of steps, so that rows and samples fall on them.
fn divides(file: &TomlFile<ScenarioFile>, field: &str, time_s: f64) -> Result<(), ReadError> {
    let step_s = file.values.step_s;
    let count = (time_s / step_s).round();
    if count >= 1.0 && (count * step_s - time_s).abs() < 1e-9 {
        return Ok(());
    }
    let message = match field {
        "step_s" => format!("expected a divisor of {time_s} s, found {step_s}"),
        _ => format!("expected a multiple of step_s, {step_s} s, found {time_s} s"),
    };
    Err(file.refuse_dotted(field, message))
}

fn dates(file: &TomlFile<ScenarioFile>) -> Result<Dates, ReadError> {
    let DatesTable { start, days } = &file.values.dates;
    let start_s = start
        .parse::<Date>()
        .and_then(|date| date.to_zoned(jiff::tz::TimeZone::UTC))
        .map(|midnight| midnight.timestamp().as_second())
        .map_err(|_| {
            let message = format!("expected a day as \"2024-01-08\", found \"{start}\"");
            file.refuse_dotted("dates.start", message)
        })?;
    Ok(Dates { start_s, days: *days })
}

fn line(file: &TomlFile<ScenarioFile>, path: &Path) -> Result<(Line, TrackFile), ReadError> {
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
        let message = "expected a name or a file, found both";
        return Err(file.refuse_dotted("line.file", message));
    }
    let track_path = path.parent().unwrap_or(Path::new("")).join(track);
    let (track, _) = TrackFile::read(&track_path)?;
    if track.speed_limit.is_empty() {
        let message = format!("expected a track with [[speed_limit]], found none in {}", track_path.display());
        return Err(file.refuse_dotted("line.file", message));
    }
    Ok((believed::line_of(&track), track))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parse(text: &str) -> Result<Simulation, ReadError> {
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
    fn a_recorder_brings_its_properties_and_the_file_may_say_otherwise() {
        for recorder in Recorder::ALL {
            let simulation = parse(&format!("[sensors]\nrecorder = \"{}\"\n", recorder.name())).unwrap();
            assert_eq!(simulation.scenario.sensors, recorder.sensors(), "{recorder:?}");
            let forced = Simulation::parse_with(Path::new("s.toml"), "", Some(recorder)).unwrap();
            assert_eq!(forced.scenario, simulation.scenario);
        }
        let text = "[sensors]\nrecorder = \"event_recorder\"\nspeed = \"rounded\"\nlost_second_every_s = 0\n[effort]\ngain = 1.1\n";
        let expected = Sensors {
            speed: SpeedReading::Rounded,
            lost_second_every_s: 0.0,
            effort_gain: 1.1,
            ..Recorder::EventRecorder.sensors()
        };
        assert_eq!(parse(text).unwrap().scenario.sensors, expected);
        let error = |text: &str| parse(text).unwrap_err().to_string();
        assert!(error("[sensors]\nrecorder = \"tape\"\n").contains("event_recorder"));
        assert_eq!(
            error("[sensors]\nspeed_lag_s = [4, 0.2]\n"),
            "s.toml:2:15: sensors.speed_lag_s: expected [least, most] from 0 to 600, found [4, 0.2]"
        );
    }

    #[test]
    fn refusals_name_line_and_column() {
        let error = |text: &str| parse(text).unwrap_err().to_string();
        assert_eq!(
            error("[dates]\nstart = \"monday\"\n"),
            "s.toml:2:9: dates.start: expected a day as \"2024-01-08\", found \"monday\""
        );
        assert_eq!(
            error("[sensors]\nsampling_s = 5.01\n"),
            "s.toml:2:14: sensors.sampling_s: expected a multiple of step_s, 0.05 s, found 5.01 s"
        );
        assert_eq!(error("step_s = 0.03\n"), "s.toml:1:10: step_s: expected a divisor of 1 s, found 0.03");
        assert_eq!(error("[load]\nsd = 0.4\n"), "s.toml:2:6: load.sd: expected 0 to 0.3, found 0.4");
        assert_eq!(error("[train]\nmass_kg = 5\n"), "s.toml:2:11: train.mass_kg: expected 1000 to 100000000, found 5");
        assert_eq!(
            error("\n[[effect]]\nname = \"tunnel_drag\"\nfrom_m = 5\nto_m = 4\nk = 1\n"),
            "s.toml:5:8: effect[0].to_m: expected a place beyond from_m, found 4"
        );
        assert_eq!(
            error("\n[[effect]]\nname = \"tunnel_drag\"\nfrom_m = 900000\nto_m = 901000\nk = 1\n"),
            "s.toml:4:10: effect[0].from_m: expected a place before the end of the line, at 32103 m, found 900000"
        );
        assert!(error("[line]\nfile = \"no.toml\"\n").starts_with("no.toml: cannot be read"));
        assert!(error("[driver]\nkindd = 1\n").starts_with("s.toml:2:1: unknown field `kindd`"));
    }
}
