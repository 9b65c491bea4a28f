//! Injected defects: how often the diagnosis of logs finds each, how near its figure is, and how often it accuses a
//! clean log.
//!
//! ```text
//! scenario, seed -> runs of a recorder -> defect, of known size -> diagnosis -> found? figure? interval? anything else?
//! ```
//!
//! Nothing is hidden by hand-made rows: the trains are the simulator's, and a defect is what `docs/check.md` lists.

mod sets;
mod spoil;

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;
use rundown_check::figure::Figure;
use rundown_check::finding::{Finding, Kind};
use rundown_check::{Check, Known, check, check_beside};
use rundown_files::recording::Recording;
use rundown_files::statistics::median;
use rundown_truth::recorders::odometer;
use rundown_truth::scenario::DriveError;
use rundown_truth::sensors::{LocationWalk, Sensors, SpeedReading};
use serde::Serialize;
use sets::{COASTING, RUNS, SERVICES, SUBURBAN, on_stations, service, simulated};
use spoil::{spoilt, turn};

/// Each defect, the finding that it is to give, what it is in words, and the unit of its figure.
macro_rules! defects {
    ($($Defect:ident => $Kind:ident, $words:literal, $unit:literal;)*) => {
        /// A defect that is injected.
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        pub enum Defect {
            $(#[doc = $words] $Defect,)*
        }

        impl Defect {
            /// All of them.
            pub const ALL: [Self; [$($words),*].len()] = [$(Self::$Defect),*];

            /// In words, with the unit of its figure.
            pub fn words(self) -> (&'static str, &'static str) {
                match self { $(Self::$Defect => ($words, $unit),)* }
            }

            fn kind(self) -> Kind {
                match self { $(Self::$Defect => Kind::$Kind,)* }
            }
        }
    };
}

defects! {
    Truncated => TruncatedSpeed, "speeds cut off to whole km/h: their offset", "km/h";
    Wheel => SpeedScale, "a wheel up to 4 % off", "%";
    TruncatedWheel => SpeedScale, "the same beside truncation", "%";
    Skew => Skew, "speed 1 to 4 s old, run by run", "s";
    LostSeconds => LostSeconds, "a second lost every 106 s", "% of rows";
    Midnight => Midnight, "midnight", "s";
    SetBack => ClockSetBack, "clock set back an hour", "s";
    SetForward => ClockSetForward, "clock set forward 10 min", "s";
    NoStandstill => MissingStandstill, "no rows while standing", "s";
    Wrap => Wrap, "odometer wraps at 65 536 m", "m";
    Reset => Reset, "locations begin again at zero", "m";
    Spikes => LocationSpikes, "single locations 1 km off", "m";
    StuckSpeed => StuckSpeed, "speed stuck at zero for 60 s", "m";
    StuckLocation => StuckLocation, "location stuck for 60 s", "m";
    TwoDirections => TwoDirections, "there and back in one log", "m";
    OtherUnit => OtherUnit, "speeds in m/s", "ratio";
    SameRows => SameRows, "a run given again, an hour later", "rows";
    OtherChainage => OtherChainage, "locations of one of 8 runs off by 2.3 km", "m";
    NearChainage => OtherChainage, "locations of one of 8 runs off by 300 m", "m";
    TurnedChainage => TurnedChainage, "one of 8 runs counts from the other end", "m";
    DeadZone => DeadZone, "speeds read zero below 12 km/h", "km/h";
    SmallDeadZone => DeadZone, "speeds read zero below 5 km/h", "km/h";
    Held => HeldSpeeds, "3 % of the speeds repeat the last", "% of rows";
    HeldPieces => HeldSpeeds, "3 % of the speeds held for 2 to 6 rows", "% of rows";
    WheelOnTheWay => WheelChange, "a wheel that reads 1 % less from a place of one run on", "ratio";
    WheelTurned => WheelChange, "wheels turned between runs, 1 %", "ratio";
    HiddenSeconds => LostSeconds, "a second lost every 106 s that a wheel hides", "% of rows";
    LateEffort => EffortLate, "efforts 5 s late", "s";
    EffortSteps => EffortSteps, "efforts in steps of 0.03 N/kg", "N/kg";
    OdometerWheel => LocationScale, "a wheel up to 2.8 % off that gives speed and location, stops described", "%";
    HalfEffort => EffortUnlike, "one of 8 runs has half of its efforts", "ratio";
    FrozenEffort => EffortHeld, "efforts of one of 8 runs stand still for 30 s, 8 times", "s";
    UnsignedBrake => UnsignedBrake, "one of 8 runs has brakes without their sign", "% of its braking";
    SmoothedSpeed => SmoothedSpeed, "speeds are means over 9 s", "s";
    StuckCoasting => StuckSpeed, "speed of a coasting train stuck for 60 s", "m";
    Interpolated => Interpolated, "one run interpolated between rows 10 s apart", "s";
    Saturated => SaturatedSpeed, "speeds end at nine tenths of the largest", "km/h";
}

/// A clean recorder.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Clean {
    /// Satellites, every second.
    Satellites,
    /// The same every 10 s.
    Slow,
    /// An odometer in whole metres, rounded speeds.
    Odometer,
    /// Satellites that drift by 6 m.
    Drifting,
    /// Satellites, on four lines whose runs stop at the same stations.
    Stations,
}

/// A step of the effort, three hundredths of what a train powers with.
const EFFORT_STEP_N_PER_KG: f64 = 0.03;
/// What turning leaves of a wheel.
const TURNED: f64 = 0.99;

impl Defect {
    /// What else is true of a log with this defect, and no false accusation.
    fn belongs(self, kind: Kind) -> bool {
        let by_design = match self {
            Self::TruncatedWheel => kind == Kind::TruncatedSpeed,
            // Once the locations are right the speed is off beside them.
            Self::HiddenSeconds | Self::OdometerWheel => kind == Kind::SpeedScale,
            // Beside a speed that is late the effort is early.
            Self::Skew => kind == Kind::EffortLate,
            // The run is played backwards: its accelerations are those of no effort.
            Self::TurnedChainage => kind == Kind::EffortUnlike,
            Self::TwoDirections => matches!(kind, Kind::Gaps | Kind::MissingStandstill),
            _ => false,
        };
        by_design || kind == self.kind() || harmless(kind)
    }
}

/// How a speed is rounded is no accusation.
fn harmless(kind: Kind) -> bool {
    // Trains that neither coast for long nor stand show no zero of the efforts, in truth.
    matches!(kind, Kind::RoundedSpeed | Kind::SteppedSpeed | Kind::EffortZeroUnseen)
}

impl Clean {
    /// All of them.
    pub const ALL: [Self; 5] = [Self::Satellites, Self::Slow, Self::Odometer, Self::Drifting, Self::Stations];

    fn sensors(self) -> Sensors {
        let satellites = Sensors { sampling_s: 1.0, ..Sensors::default() };
        match self {
            Self::Satellites | Self::Stations => satellites,
            Self::Slow => Sensors { sampling_s: 10.0, ..satellites },
            Self::Odometer => odometer(),
            Self::Drifting => {
                Sensors { location_noise_m: 1.0, location_walk: Some(LocationWalk::of(6.0)), ..satellites }
            }
        }
    }
}

/// A figure beside its truth, with what the diagnosis says of its uncertainty.
#[derive(Clone, Copy, Debug, Serialize)]
struct KnownFigure {
    truth: f64,
    found: Figure,
}

/// What came of the sets of one defect.
#[derive(Clone, Debug, Serialize)]
pub struct DefectRow {
    /// What was injected.
    pub what: &'static str,
    /// Unit of the figures.
    pub unit: &'static str,
    /// Sets.
    pub sets: usize,
    /// Sets in which it was found.
    pub found: usize,
    /// Sets in which something else was found, too.
    pub accused: usize,
    /// What that was.
    pub accused_of: Vec<Kind>,
    /// Median size of the errors of the figure; none where it was never found.
    pub error: Option<f64>,
    /// Largest.
    pub largest_error: Option<f64>,
    /// 95 % intervals, and how many hold the truth; where the figure has one.
    pub intervals: [usize; 2],
}

/// What came of all sets.
#[derive(Clone, Debug, Serialize)]
pub struct CheckBench {
    /// By defect.
    pub rows: Vec<DefectRow>,
    /// Clean sets.
    pub clean: usize,
    /// Those that were accused, with what they were accused of.
    pub accused: Vec<String>,
}

/// Of `bench.json`: path, unit, meaning, null rule.
pub const FIELDS: &[[&str; 4]] = &[
    ["rows[].what", "", "the defect that was injected", ""],
    ["rows[].unit", "", "unit of its figure", ""],
    ["rows[].sets", "", "sets of runs", ""],
    ["rows[].found", "", "sets in which it was found", ""],
    ["rows[].accused", "", "sets in which something else was found, too", ""],
    ["rows[].accused_of[]", "", "what that was, as `kind` of `check.json`", ""],
    ["rows[].error", "as `unit`", "median size of the errors of the figure", "no figure has a known truth"],
    ["rows[].largest_error", "as `unit`", "largest of them", "no figure has a known truth"],
    ["rows[].intervals[]", "", "95 % intervals that were given, and how many of them hold the truth", ""],
    ["clean", "", "sets of clean recorders", ""],
    ["accused[]", "", "recorder, seed and findings of each clean set that was accused", ""],
];

/// Injects each defect into so many sets, and diagnoses as many clean ones of each recorder.
///
/// # Errors
/// [`DriveError`] where a run could not be simulated.
pub fn bench(defects: &[Defect], sets: u64, seed: u64, done: impl Fn() + Sync) -> Result<CheckBench, DriveError> {
    let row = |defect: &Defect| {
        let all = (0..sets).into_par_iter().map(|set| {
            let outcome = injected(*defect, seed.wrapping_add(set));
            done();
            outcome
        });
        all.collect::<Result<Vec<_>, _>>().map(|outcomes| tally(*defect, &outcomes))
    };
    let clean: Vec<(Clean, u64)> = Clean::ALL.iter().flat_map(|clean| (0..sets).map(|set| (*clean, set))).collect();
    let accused = |(recorder, set): &(Clean, u64)| {
        let seed = seed.wrapping_add(1_000_000 + set);
        let sensors = recorder.sensors();
        let mut recordings = match recorder {
            Clean::Stations => on_stations(&SERVICES, &sensors, seed)?,
            _ => simulated(&sensors, seed, &[])?,
        };
        let found = check(&mut recordings);
        done();
        let wrong: Vec<Kind> = all(&found).map(|finding| finding.kind).filter(|kind| !harmless(*kind)).collect();
        Ok((!wrong.is_empty()).then(|| format!("{recorder:?}, seed {seed}: {wrong:?}")))
    };
    let accused = clean.par_iter().map(accused).collect::<Result<Vec<_>, DriveError>>()?;
    Ok(CheckBench {
        rows: defects.iter().map(row).collect::<Result<Vec<_>, _>>()?,
        clean: clean.len(),
        accused: accused.into_iter().flatten().collect(),
    })
}

struct SetOutcome {
    found: bool,
    accused: Vec<Kind>,
    known: Vec<KnownFigure>,
}

fn tally(defect: Defect, outcomes: &[SetOutcome]) -> DefectRow {
    let (what, unit) = defect.words();
    let known = || outcomes.iter().flat_map(|outcome| &outcome.known);
    let errors: Vec<f64> = known().map(|known| (known.found.value - known.truth).abs()).collect();
    let mut accused_of: Vec<Kind> = outcomes.iter().flat_map(|outcome| outcome.accused.iter().copied()).collect();
    accused_of.sort_unstable();
    accused_of.dedup();
    let with_interval = || known().filter(|known| known.found.sd > 0.0);
    let holds = |known: &&KnownFigure| {
        let [low, high] = known.found.interval();
        (low..=high).contains(&known.truth)
    };
    DefectRow {
        what,
        unit,
        sets: outcomes.len(),
        found: outcomes.iter().filter(|outcome| outcome.found).count(),
        accused: outcomes.iter().filter(|outcome| !outcome.accused.is_empty()).count(),
        accused_of,
        error: median(&errors),
        largest_error: errors.iter().copied().reduce(f64::max),
        intervals: [with_interval().count(), with_interval().filter(holds).count()],
    }
}

/// All findings: of recorders, then of runs.
fn all(check: &Check) -> impl Iterator<Item = &Finding> {
    let of_runs = check.runs.iter().flat_map(|run| &run.findings);
    check.recorders.iter().flat_map(|recorder| &recorder.findings).chain(of_runs)
}

fn injected(defect: Defect, seed: u64) -> Result<SetOutcome, DriveError> {
    let mut random = ChaCha8Rng::seed_from_u64(seed ^ 0xC4EC);
    let gain = 1.0 + random.random_range(0.007..0.04) * if random.random_bool(0.5) { 1.0 } else { -1.0 };
    let lags_s: Vec<f64> = (0..RUNS).map(|_| random.random_range(1.0..4.0)).collect();
    let sensors = sensors(defect, gain);
    let lags_s = if defect == Defect::Skew { lags_s } else { Vec::new() };
    let mut recordings = recorded(defect, &sensors, seed, &lags_s)?;
    let mut size = spoilt(defect, &mut recordings, &mut random);
    if matches!(defect, Defect::WheelOnTheWay | Defect::WheelTurned) {
        size = TURNED;
        let turned = simulated(&Sensors { speed_gain: TURNED, ..sensors }, seed, &[])?;
        turn(defect, &mut recordings, &turned, &mut random);
    }
    let stops_m = match defect {
        Defect::OdometerWheel => service(SUBURBAN, &sensors, seed).line.calls_m().to_vec(),
        _ => Vec::new(),
    };
    let check = check_beside(&mut recordings, &Known { stops_m, ..Known::default() });
    let found: Vec<&Finding> = all(&check).filter(|finding| finding.kind == defect.kind()).collect();
    let accused = all(&check).map(|finding| finding.kind).filter(|kind| !defect.belongs(*kind)).collect();
    let injected = Injected { defect, size, gain, lags_s };
    Ok(SetOutcome { found: !found.is_empty(), accused, known: injected.known(&found, &check) })
}

/// What records the runs.
fn sensors(defect: Defect, gain: f64) -> Sensors {
    let mut sensors = Clean::Satellites.sensors();
    match defect {
        Defect::Truncated => sensors.speed = SpeedReading::Truncated,
        Defect::Wheel => sensors.speed_gain = gain,
        Defect::TruncatedWheel => (sensors.speed, sensors.speed_gain) = (SpeedReading::Truncated, gain),
        Defect::LostSeconds => return Sensors { lost_second_every_s: 106.0, ..Clean::Odometer.sensors() },
        Defect::HiddenSeconds => (sensors.lost_second_every_s, sensors.speed_gain) = (106.0, 107.0 / 106.0),
        Defect::LateEffort => sensors.effort_lag_s = 5.0,
        Defect::SmoothedSpeed => sensors.speed_quantum_kmh = 0.1,
        Defect::EffortSteps => sensors.effort_step_n_per_kg = EFFORT_STEP_N_PER_KG,
        Defect::Midnight => sensors.day_clock_s = Some([85_800.0; 2]),
        Defect::NoStandstill => sensors.standing_rows = false,
        _ => {}
    }
    sensors
}

fn recorded(defect: Defect, sensors: &Sensors, seed: u64, lags_s: &[f64]) -> Result<Vec<Recording>, DriveError> {
    match defect {
        Defect::OtherChainage | Defect::NearChainage => on_stations(&SERVICES, sensors, seed),
        // Two ends look alike from both sides.
        Defect::TurnedChainage => on_stations(&SERVICES[1..], sensors, seed),
        Defect::OdometerWheel
        | Defect::HalfEffort
        | Defect::FrozenEffort
        | Defect::UnsignedBrake
        | Defect::SmoothedSpeed => on_stations(&[SUBURBAN], sensors, seed),
        Defect::StuckCoasting => on_stations(&[COASTING], sensors, seed),
        _ => simulated(sensors, seed, lags_s),
    }
}

/// A defect with its true figures.
struct Injected {
    defect: Defect,
    /// Of what was done to rows.
    size: f64,
    /// Of a wheel.
    gain: f64,
    /// Of each run, where its speed is old.
    lags_s: Vec<f64>,
}

impl Injected {
    /// The figures of the findings beside their truth.
    fn known(&self, found: &[&Finding], check: &Check) -> Vec<KnownFigure> {
        if found.is_empty() {
            return Vec::new();
        }
        let of_recorder = &check.recorders[0];
        let percent = |scale: Figure| Figure { value: 100.0 * scale.value, sd: 100.0 * scale.sd };
        let each = |truth: f64| found.iter().map(|one| KnownFigure { truth, found: one.figure }).collect();
        let one =
            |truth: f64, found: Option<Figure>| found.map(|found| KnownFigure { truth, found }).into_iter().collect();
        match self.defect {
            Defect::Truncated => one(0.5, of_recorder.offset_kmh),
            Defect::Wheel | Defect::TruncatedWheel => one(100.0 * self.gain, of_recorder.scale.map(percent)),
            Defect::Skew => {
                let runs = check.runs.iter().zip(&self.lags_s);
                runs.filter_map(|(run, lag_s)| Some(KnownFigure { truth: *lag_s, found: run.skew_s? })).collect()
            }
            // Every run shows it, and its own figure is nothing that was chosen.
            Defect::LostSeconds | Defect::HiddenSeconds => each(100.0 / 106.0),
            Defect::LateEffort => each(5.0),
            Defect::EffortSteps => each(EFFORT_STEP_N_PER_KG),
            Defect::OdometerWheel => {
                let known = |one: &&Finding| KnownFigure { truth: 100.0 * self.size, found: percent(one.figure) };
                found.iter().map(known).collect()
            }
            Defect::Midnight => each(86_400.0),
            Defect::NoStandstill => Vec::new(),
            _ => one(self.size, Some(found[0].figure)),
        }
    }
}

impl CheckBench {
    /// As in `docs/check.md`.
    pub fn table(&self) -> String {
        let mut text = String::from(
            "| injected | found | error of the figure, median and largest | 95 % intervals that hold | accused of more |\n|---|---|---|---|---|\n",
        );
        for row in &self.rows {
            let error = row.error.zip(row.largest_error).map_or_else(
                || "-".to_owned(),
                |(median, largest)| format!("{}, {} {}", digits(median), digits(largest), row.unit),
            );
            let [all, hold] = row.intervals;
            let intervals = if all == 0 { "-".to_owned() } else { format!("{hold} of {all}") };
            let DefectRow { what, found, sets, accused, .. } = row;
            let of: Vec<String> = row.accused_of.iter().map(|kind| format!(": {}", kind.words())).collect();
            let of = of.concat();
            text += &format!("| {what} | {found} of {sets} | {error} | {intervals} | {accused}{of} |\n");
        }
        text + &format!("\nClean sets that are accused of anything: {} of {}.\n", self.accused.len(), self.clean)
    }
}

/// Two digits that count.
fn digits(value: f64) -> String {
    if value == 0.0 {
        return "0".to_owned();
    }
    let decimals = (1.0 - value.abs().log10().floor()).clamp(0.0, 6.0) as usize;
    format!("{value:.decimals$}")
}

#[cfg(test)]
mod tests {
    use super::*;
    use rundown_check::finding::Done;

    /// The first four of eight runs, those of another unit, are off by 2.3 km: what is found of each run, as the
    /// described stops say.
    fn half_off(seed: u64, stops_m: &[f64]) -> Vec<Option<Done>> {
        let mut recordings = on_stations(&["suburban"], &Clean::Satellites.sensors(), seed).unwrap();
        for (i, recording) in recordings.iter_mut().enumerate() {
            recording.unit = if i < 4 { "a" } else { "b" }.to_owned();
            let by_m = if i < 4 { 2300.0 } else { 0.0 };
            recording.rows.iter_mut().for_each(|row| row.location_m = row.location_m.map(|m| m + by_m));
        }
        let found = check_beside(&mut recordings, &Known { stops_m: stops_m.to_vec(), ..Known::default() });
        let of_run = |run: &rundown_check::RunCheck| {
            let finding = run.findings.iter().find(|finding| finding.kind == Kind::OtherChainage);
            finding.inspect(|finding| {
                assert!((finding.figure.value.abs() - 2300.0).abs() < 30.0, "{}", run.said(finding));
            });
            finding.map(|finding| finding.done)
        };
        found.runs.iter().map(of_run).collect()
    }

    #[test]
    fn of_as_many_runs_on_two_chainages_the_described_stops_decide() {
        for seed in 600..604 {
            let undecided = half_off(seed, &[]);
            let said = undecided.iter().filter(|done| **done == Some(Done::Said)).count();
            assert!(said == 4 && undecided.iter().flatten().count() == 4, "{seed}: {undecided:?}");
            let line = service("suburban", &Clean::Satellites.sensors(), seed).line;
            let decided = half_off(seed, line.calls_m());
            assert_eq!(decided, [[Some(Done::Refused); 4], [None; 4]].concat(), "{seed}");
        }
    }

    /// Fewer sets than in the documents, and the same figures within what chance allows.
    #[test]
    fn defects_are_found_and_clean_logs_are_not_accused() {
        let bench = bench(&Defect::ALL, 5, 77, || ()).unwrap();
        let text = bench.table();
        println!("{text}\n{:?}", bench.accused);
        // Speeds that are held show where the speed changes fast: hardly in intercity runs; means of eight short runs
        // are near the noise.
        let held = [Defect::Held, Defect::HeldPieces, Defect::SmoothedSpeed].map(|defect| defect.words().0);
        for row in &bench.rows {
            let missed = if held.contains(&row.what) { 2 } else { 1 };
            assert!(row.found + missed >= row.sets, "{}: {} of {}\n{text}", row.what, row.found, row.sets);
        }
        assert!(bench.accused.len() <= 1, "{:?}", bench.accused);
        let error = |what: Defect| {
            let row = bench.rows.iter().find(|row| row.what == what.words().0);
            row.and_then(|row| row.error).unwrap_or(f64::INFINITY)
        };
        assert!(error(Defect::Truncated) < 0.05, "{text}");
        assert!(error(Defect::Wheel) < 0.1 && error(Defect::TruncatedWheel) < 0.1, "{text}");
        assert!(error(Defect::Skew) < 0.2, "{text}");
        assert!(error(Defect::LostSeconds) < 0.15 && error(Defect::HiddenSeconds) < 0.15, "{text}");
        assert!(error(Defect::WheelOnTheWay) < 2e-3 && error(Defect::WheelTurned) < 2e-3, "{text}");
        assert!(error(Defect::LateEffort) < 1.0, "{text}");
        let [all, hold] = bench.rows.iter().fold([0, 0], |[a, h], row| [a + row.intervals[0], h + row.intervals[1]]);
        assert!(100 * hold >= 80 * all, "{text}");
        for what in [Defect::Truncated, Defect::Wheel, Defect::TruncatedWheel] {
            let row = bench.rows.iter().find(|row| row.what == what.words().0).unwrap();
            assert!(row.intervals[1] + 1 >= row.intervals[0], "{}: {:?}", row.what, row.intervals);
        }
        for row in &bench.rows {
            assert!(row.accused <= 1, "{} is also called something else\n{text}", row.what);
        }
    }
}
