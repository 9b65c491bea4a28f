//! The thresholds and priors by which the workflow decides: a name, a unit, a source, and a value that a file may
//! change.
//!
//! Each line of documentation ends with where the value comes from: `Measured` on data with a known answer, `Derived`
//! from the formulation, or `Judgement`. Sizes that an effect must have, and the shapes that are tried, belong to the
//! effect: they stand in its file below `candidates/` and can be set as `[prior.<name>]`.
//!
//! What only says how finely something is computed (points along a path, steps of an integration, rounds of an
//! iteration), or which words a refusal has, is a constant where it is used. What recorders did to the logs is found
//! before, while logs are read, by [`rundown_check`] and `data/load.rs`: these thresholds are constants there, and are
//! not set here.

use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// What is believed of an effect before the data, as far as a file says otherwise than its candidate does.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct PriorChange {
    /// Smallest size that matters.
    pub least: Option<f64>,
    /// Largest size that is possible.
    pub most: Option<f64>,
    /// Shapes that are tried first.
    pub shapes: Option<Vec<f64>>,
}

/// Defines the sections with their defaults, and keeps the documentation for [`GapConfig::commented`].
macro_rules! settings {
    ($($(#[doc = $what:literal])+ $section:ident: $name:ident {
        $($field:ident: $type:ty = $default:expr, $(#[doc = $doc:literal])+)+
    })+) => {
        /// All settings, by stage.
        #[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
        #[serde(default, deny_unknown_fields)]
        pub struct GapConfig {
            $($(#[doc = $what])+ pub $section: $name,)+
            /// Sizes and shapes of single effects, by their names.
            pub prior: BTreeMap<String, PriorChange>,
        }

        $(
            $(#[doc = $what])+
            #[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
            #[serde(default, deny_unknown_fields)]
            pub struct $name { $($(#[doc = $doc])+ pub $field: $type,)+ }

            impl Default for $name {
                fn default() -> Self { Self { $($field: $default),+ } }
            }
        )+

        impl GapConfig {
            /// As a file, each value below what it is, its unit and its source.
            pub fn commented(&self) -> String {
                let mut text = String::new();
                $(
                    text.push_str(concat!($("#", $what, "\n",)+ "[", stringify!($section), "]\n"));
                    $(
                        text.push_str(concat!($("#", $doc, "\n"),+));
                        text.push_str(&line(stringify!($field), &self.$section.$field));
                    )+
                    text.push('\n');
                )+
                text
            }
        }
    };
}

/// `name = value`. Numbers and lists of numbers always have a form in TOML.
fn line(name: &str, value: &impl Serialize) -> String {
    toml::Value::try_from(value).map_or_else(|_| String::new(), |value| format!("{name} = {value}\n"))
}

settings! {
    /// Runs cut into intervals, and which of them count.
    interval: IntervalConfig {
        length_s: f64 = 10.0, /// Wanted length, s. Judgement: within less the rounding of the speed hides everything.
        start_length_s: f64 = 3.0, /// Wanted length in the first seconds after a start, where an effort column shows them, s. Judgement: within 10 s a train that starts is beyond what starting asks for.
        start_s: f64 = 12.0, /// How long these seconds are, from the first row that counts, s. Judgement: a train of 0.8 m/s² is then at 40 km/h.
        start_mps: f64 = 7.0, /// A speed in the middle of them, m/s. Derived: 0.8 m/s² for 8 s.
        gap: f64 = 2.5, /// Samples further apart than so many usual ones are a gap, and nothing is concluded across it. Judgement.
        reading_s: f64 = 2.5, /// Half the window over which the speed of a fast log is read, s. Judgement.
        located_s: f64 = 45.0, /// Half the window whose locations place a reading, s. Judgement: many readings, yet less than a lag changes in.
        departed_mps: f64 = 0.5, /// A train faster than this has departed, m/s. Judgement.
        braked_n_per_kg: f64 = -0.05, /// A measured effort below this is a brake application, N/kg. Judgement.
        brake_test_n_per_kg: f64 = 0.12, /// What a brake test takes off the mean effort of 10 s at least, N/kg. Derived: 10 km/h less in the middle of an acceleration is 0.3.
        by_power_mps: f64 = 5.0, /// Above this speed constant power, not constant effort, lies between two readings, m/s. Judgement.
        held_mps: f64 = 0.35, /// A speed that changes by less over an interval is held, m/s. Derived: a third of a step of 1 km/h more than none.
        held_share: f64 = 0.6, /// A driver who holds the speed follows a steeper gradient with the effort, within this share of it. Judgement.
        held_least_n_per_kg: f64 = 0.004, /// A gradient that changes by less is followed in any case, N/kg. Judgement: 0.4 permille.
        slowest_mps: f64 = 2.0, /// Slower intervals count for nothing: readings of zero, creeping, the last metres, m/s. Judgement.
        beyond_m: f64 = 300.0, /// A location may be this far beyond an end of the line, m. Judgement: half a train, and the noise of a receiver.
        coasting_n_per_kg: f64 = 0.01, /// A smaller effort is that of a coasting train, N/kg. Judgement: the noise of a sensor.
        least_coast: usize = 3, /// Intervals of coasting in one piece that show by their median what all of them have. Judgement: one of three may be off.
        most_change_n_per_kg: f64 = 0.03, /// An effort that changes by more within an interval has no mean that is known well enough, N/kg. Measured: a switch of the regime, a brake being applied.
    }
    /// The track, as far as it can be doubted.
    track: TrackConfig {
        most_gradient_sd_permille: f64 = 1.0, /// Gradients that are less certain are taken for effects, and nothing is analysed, permille. Derived: 1 permille is a third of the resistance at 100 km/h.
        most_slope_factor: f64 = 1.5, /// Slopes further off than this factor from those that the motion needs, or of the other sign, are of another line. Judgement: surveys are within 20 %, and twice as steep is no survey.
        slope_sure: f64 = 4.0, /// So many standard deviations beyond it, by what parts of the line say. Judgement: a gradient that is wrong at one place is an effect.
        most_leap_m: f64 = 100.0, /// Locations that leap by more at one place are on another chainage behind it, and nothing is analysed, m. Judgement: receivers are within tens of metres.
        leap_apart: f64 = 0.25, /// Leaps of one place differ by a smaller share. Judgement: the noise of two locations.
        leap_share: f64 = 0.6, /// Share of the runs that have it. Judgement: some are lost between two readings, or stop there.
        most_off_share: f64 = 0.2, /// With a larger share of the locations of moving trains off the described track nothing is analysed. Judgement: nothing is known of gradients there, and they would be named.
        level_rows: usize = 5, /// Rows that show the slope of a place on a line that is described as level. Judgement.
        level_places: usize = 5, /// Places that show what such a line is like. Judgement.
        level_sure: f64 = 3.0, /// Standard deviations of its mean by which the middle one of the places must differ from level. Judgement.
    }
    /// Speed against location: what the diagnosis of the logs says, and what of it has a name.
    kinematics: KinematicsConfig {
        sure: f64 = 5.0, /// How often a lag must exceed its standard deviation before it is believed. Judgement.
        least_lag_s: f64 = 1.2, /// A lag below this is what receivers have, s. Judgement.
        scale_sd: f64 = 3e-4, /// What the path between two readings does to a scale, a standard deviation. Measured.
        lag_sd_s: f64 = 0.02, /// The same of a lag, s. Measured.
    }
    /// The wheel of a single train.
    wheel: WheelConfig {
        least: f64 = 0.004, /// A wheel nearer to the others is within what wheels are allowed. Judgement.
        most: f64 = 0.045, /// A wheel is not further off; what is, are lost readings. Judgement.
        sure: f64 = 6.0, /// How often it must exceed what the other runs scatter, and its own standard deviation. Judgement.
        beyond: f64 = 1.5, /// And so many times what the furthest of the others is off: on and off power between two readings has long tails. Judgement.
        least_scatter: f64 = 3e-4, /// Runs scatter by no less, from the places where drivers stop. Measured.
        least_runs: usize = 5, /// Fewer runs are no company. Judgement.
        most_share: f64 = 0.34, /// More than this share of the runs is no exception. Judgement.
        same: f64 = 0.002, /// Wheels nearer to each other are one. Judgement.
        standing_mps: f64 = 1.0, /// Slower is standing, m/s. Judgement.
        near_m: f64 = 60.0, /// Stops nearer to the next one are at one place, m. Judgement.
        least_stops: usize = 3, /// Least runs that make a place of their stops, and a third of all; and that make a wheel by a single distance each. Judgement.
        stop_m: f64 = 60.0, /// How far a stop may be from its place, m. Judgement: drivers, and the noise of a receiver.
        agreeing_share: f64 = 0.75, /// Share of a run's distances between known places that must agree on its wheel. Judgement: a stop at a signal may lie near a platform.
        beyond_m: f64 = 400.0, /// A stop may be so far beyond where the other runs stop, and no wheel, m. Judgement: a weak brake or a signal behind the platform.
        agreeing: f64 = 3.0, /// Wheels that rest on a single distance each agree within so many times what runs scatter, or their own standard deviation. Judgement: three that stop anywhere within 700 m of one place agree by chance in one of 60 cases.
        elsewhere_odds: f64 = 1.0, /// Odds that it is then a place where these runs stop, and the others do not. Judgement: a signal is as common as a wheel in some runs alone.
        stop_sd_m: f64 = 10.0, /// Standard deviation of a stop, m. Judgement.
        platform_sd_m: f64 = 50.0, /// How far a platform is from where it is described, standard deviation, m. Judgement: half a train, or the middle of a station.
        sure_of_platforms: f64 = 3.0, /// How often a wheel of all runs must exceed what that makes of it. Judgement.
        least_distance_m: f64 = 1_500.0, /// Shorter distances show nothing, m. Derived: 60 m are 4 % of them.
    }
    /// What is wrong with the readings of all runs alike, and no effect: always in, with a normal prior around none.
    nuisance: NuisanceConfig {
        effort_gain_sd: f64 = 0.05, /// Gain of the effort column less 1, standard deviation. Judgement: efforts are calculated from currents and voltages, and masses from tables.
        starting_gain_sd: f64 = 0.005, /// The same of the efforts in the first seconds after a start beside the others, at all speeds and by the speed. Measured: up to 0.004 of trams of another simulator.
        brake_gain_sd: f64 = 0.05, /// The same of braking efforts beside the others, standard deviation. Judgement: brake forces are calculated from pressures, with a friction that is from tables.
        brake_n_per_kg: f64 = 0.01, /// A measured effort below minus this is set aside where the readings of the brake are not those of the brake, N/kg. Judgement: above the noise of efforts of none.
        effort_delay_sd_s: f64 = 3.0, /// Age of an effort at its time stamp, standard deviation, s. Judgement: buses and loggers; a sample of 10 s is then possible, and a minute is not.
        location_offset_sd_m: f64 = 50.0, /// Shown less true location along the line in all runs, standard deviation, m. Judgement: another zero of the chainage, an antenna at the other end of a train.
        most_sd: f64 = 5.0, /// A nuisance is not further off, in standard deviations of its prior. Judgement.
        sure: f64 = 3.0, /// What is so many of its own standard deviations off is reported. Judgement.
        least_gain: f64 = 0.01, /// A gain nearer to 1 is not reported: a sensor is off by about so much. Judgement.
        least_delay_s: f64 = 0.7, /// A shorter delay is put right and not reported, s. Judgement: what a mean over a second before is late by.
        least_offset_m: f64 = 10.0, /// A smaller offset is left as it is, m. Judgement: receivers.
        most_between: f64 = 0.7, /// Offsets of single runs that differ by more than this share of that of all are none of all. Derived: of half of the runs alone they differ by the whole of the mean.
        gain_sd: f64 = 0.002, /// Standard deviation of a gain at least: efforts between two readings, as a share. Judgement.
        most_early_s: f64 = 2.0, /// A mean that is earlier than this is a momentary value, half a sample later, s. Judgement: efforts are early where the speed is late, by what smooths it.
        delay_step_s: f64 = 0.5, /// Delays are tried so far apart, and are certain to a half of that, s. Judgement: the time it takes.
        offset_step_m: f64 = 10.0, /// Offsets are tried so far apart, m. Judgement: less than the length of a train.
        places: usize = 16, /// Parts of the line whose agreement says how certain an offset is: a gradient may begin elsewhere than described. Judgement.
    }
    /// Small errors of the described gradients at most places of the line.
    gradients: GradientsConfig {
        step_m: f64 = 500.0, /// Errors are straight between points so far apart, m. Judgement: less than they are alike over.
        most_steps: usize = 120, /// Points along the line at most. Judgement: the time it takes.
        alike_m: f64 = 2_000.0, /// Over this distance errors become a third as alike, m. Judgement: surveys, and slopes rounded to one figure for each kilometre or two.
        place_m: f64 = 1_000.0, /// Length of a place, m. Judgement.
        other_way: f64 = 0.2, /// From this share of rows of the rarer direction on what a place has in both is no error of its gradient. Judgement.
        least_places: usize = 10, /// Fewer places do not show what most are like. Judgement: a wrong gradient over 2 km is a quarter of them.
        least_places_one_way: usize = 20, /// The same where all trains go in one direction, and a resistance at a place looks like its gradient. Measured: of 16 a tunnel of 3.4 km was taken for errors of 0.6 permille everywhere.
        typical_permille: f64 = 0.3, /// Errors of this standard deviation, permille, of which a place must show the following share to say something, and beside which a name is tried where none are sure. Judgement.
        effect: f64 = 3.0, /// A place that is so many standard deviations further off than most has an effect. Derived: of normal errors one in 370.
        known_share: f64 = 0.5, /// Share of the variance of such an error. Judgement.
        sure: f64 = 3.0, /// Log-likelihood by which they must explain the places, those with effects set aside, better than none. Derived: odds of 20.
        least_permille: f64 = 0.1, /// Smaller errors are none, permille. Derived: gradients are described to a tenth of a permille.
        most_permille: f64 = 1.0, /// No error that is not an effect is larger, permille. Judgement: a third of the resistance at 100 km/h.
    }
    /// The effort column, or the effort calculated from the change of speed.
    effort: EffortConfig {
        most_factor: f64 = 1.5, /// A column further off than this factor from the effort that the motion needs, or of the other sign, is refused. Judgement: masses from tables are within 20 %, other units beyond 3.
        measured_share: f64 = 0.7, /// Share of moving samples with an effort above which the effort counts as measured. Judgement.
        moving_mps: f64 = 1.0, /// A faster train moves, m/s. Judgement.
        telling_change_n_per_kg: f64 = 0.03, /// Intervals whose effort changes by more show how the column is to be read, N/kg. Judgement.
        mean_share: f64 = 0.9, /// Residuals below this share of those of momentary readings, each at its own delay, make it a mean since the sample before. Measured: where one is as good as the other they differ by 2 %.
        steady_n_per_kg: f64 = 0.05, /// An effort that changes by more is no ground for judging the traction, N/kg. Judgement.
        disturbed_n_per_kg: f64 = 0.005, /// What a calculated effort has beyond the rounding of the speeds, standard deviation at first, N/kg. Measured.
        least_sd_n_per_kg: f64 = 0.003, /// The least standard deviation of a calculated effort that is believed, N/kg. Judgement.
        most_sd_n_per_kg: f64 = 0.03, /// The largest, N/kg. Judgement.
        fast_s: f64 = 3.0, /// Logs with less between samples are fast, s. Judgement.
        fast_share: f64 = 0.7, /// Rounding that is left of a speed of a fast log, as a share. Derived: a line through several readings.
        few_slow: usize = 20, /// So many slow intervals show nothing, and it is said below which speed there are no more. Judgement.
        slow_kmh: f64 = 12.0, /// From this speed on, km/h. Judgement: what a starting resistance acts below.
    }
    /// Coasting, recognised in logs without an effort column.
    coasting: CoastingConfig {
        uncertain: Vec<f64> = vec![0.3, 0.15, 0.1], /// Deviation of the resistance from its description, as a share of it, round by round. Judgement: wide at first.
        changes: Vec<f64> = vec![0.08, 0.15, 0.25, 0.4], /// Chances that a regime changes from one interval to the next: the likeliest is taken. Judgement.
        enough: f64 = 0.85, /// Coasting is believed above this probability. Judgement.
        over_held: f64 = 1.0, /// A stretch must be coasting rather than a held speed by so much, log of the ratio. Judgement.
        around: usize = 2, /// So many neighbours on both sides are looked at together. Judgement.
        held_around: f64 = 2.0, /// They must not together be a held speed by so much, log of the ratio. Judgement.
        clear: f64 = 6.0, /// The effort beside a change is clear if it is so many times its noise. Judgement.
        part_from: f64 = -0.1, /// An interval with a part of the effort before or after it from this on has the change in itself. Derived: the change may lie anywhere in it.
        part_to: f64 = 0.7, /// Up to this; with more, the change may lie in the next. Derived.
        tail: f64 = 1e-5, /// Density of coasting far from what it should be, over that of its middle. Measured: power between two coasts must cost more than to change twice.
        most_extra_n_per_kg: f64 = 0.03, /// What the model has beyond the description counts up to this, N/kg. Judgement: 3 permille.
        slowest_mps: f64 = 1.5, /// A slower train is stopping or starting, m/s. Judgement.
        held_wide_share: f64 = 0.3, /// Share of the wide part of the density of a held speed. Measured on drivers of the simulator.
        held_narrow: f64 = 1.3, /// Width of its narrow part, in standard deviations of the effort. Measured.
        held_wide: f64 = 3.0, /// Width of its wide part. Measured.
        power_from: f64 = 0.15, /// Powering: from this share of the largest effort. Judgement.
        power_to: f64 = 1.1, /// Powering: usually to this share; more is no coasting either. Judgement.
        brake_from_n_per_kg: f64 = -0.8, /// Braking: usually from, N/kg; what is harder is no coasting either. Judgement.
        brake_to_n_per_kg: f64 = -0.1, /// Braking: to, N/kg. Judgement.
        change_from_n_per_kg: f64 = -0.5, /// Changing: from, N/kg. Judgement.
        change_to: f64 = 1.05, /// Changing: to this share of the largest effort. Judgement.
        change_weight: f64 = 0.7, /// Weight of changing against the other regimes. Judgement.
    }
    /// The noise of the residuals.
    noise: NoiseConfig {
        outlier: f64 = 3.5, /// Beyond so many standard deviations a row is an outlier, and given a wider spread. Judgement.
        restricted_from: f64 = 1.05, /// Rows over rows less freedom of the flexible model, above which the restricted likelihood is taken. Measured: there its freedom hides what differs between runs.
        least_knots: usize = 5, /// Least knots of the flexible model along the location. Judgement.
        most_knots: usize = 30, /// Most of them. Judgement.
        rows_a_knot: usize = 20, /// Rows for each. Judgement.
        alike_m: f64 = 50.0, /// Readings of two runs within such a stretch are at one place, m. Judgement: on it a coasting train changes its speed by a fifth of a km/h.
        alike_over_m: f64 = 1000.0, /// How alike runs are is asked over such a stretch, m. Judgement.
        alike_rows: f64 = 0.25, /// Runs are driven alike where more than this share of the rows is. Measured: 0.41 to 0.89 of 22 sets of automatic trains, 0 to 0.07 of 18 with drivers.
        alike_steps: f64 = 2.0, /// Apart from where the speed changes by more steps from reading to reading. Judgement: a train that coasts changes it by less.
        alike_pairs: u32 = 20, /// Fewer pairs of readings do not say it. Judgement.
        alike_share: f64 = 0.25, /// Of the way over which the same speed is read one error of rounding holds for this share. Derived: the error goes from half a step to minus half a step on the way, and is none in the mean.
        alike_most_m: f64 = 500.0, /// And for no longer way, m. Judgement: a train that holds its speed changes it a little with each slope.
        least_alike: f64 = 0.3, /// Errors of rounding with a smaller correlation count as independent. Judgement: four in five readings are equal there.
        knots: usize = 6, /// Knots along the time and along the speed. Judgement.
        run_knots: usize = 4, /// Knots along temperature and day. Judgement.
        most_off: f64 = 1.5, /// Standardised residuals of a regime that are so many times larger than 1, or smaller, are said: the noise does not fit there. Judgement.
        most_neighbours: f64 = 0.25, /// The same of the correlation of neighbouring residuals. Judgement.
        reading_mps: f64 = 0.08, /// Error of a speed reading to begin with, m/s. Judgement.
        most_reading_mps: f64 = 1.0, /// Its largest value, m/s. Judgement.
        acceleration_mps2: f64 = 0.003, /// Disturbance of the acceleration to begin with, m/s². Judgement.
        most_acceleration_mps2: f64 = 0.2, /// Its largest value, m/s². Judgement.
        change_share: f64 = 0.3, /// Share of a change of the effort by which its mean is uncertain, to begin with. Judgement.
        most_change_share: f64 = 2.0, /// Its largest value. Judgement.
        constant_n_per_kg: f64 = 5e-4, /// Constant resistance of each run to begin with, N/kg. Judgement.
        most_constant_n_per_kg: f64 = 0.05, /// Its largest value, N/kg: with an effort column that is its zero, too. Judgement.
        most_coasting_constant_n_per_kg: f64 = 1e-3, /// The same without an effort column. Derived: in coasting a wind looks like a constant and a mass together, larger ones than runs of one train have.
        wind_mps: f64 = 0.5, /// Wind of each run to begin with, m/s. Judgement.
        most_wind_mps: f64 = 20.0, /// Its largest value, m/s. Judgement.
        mass: f64 = 5e-3, /// Mass of each run, or gain of its effort, to begin with, as a share. Judgement.
        most_mass: f64 = 0.2, /// Its largest value: with an effort column that is its gain, too. Judgement.
        most_coasting_mass: f64 = 0.04, /// The same without an effort column. Derived as the constant's.
        least_share: f64 = 0.1, /// A standard deviation between runs below this share of where it began is none. Judgement.
    }
    /// Winds and dragging brakes: what differs between runs.
    between_runs: BetweenRunsConfig {
        wind_gain: f64 = 4.5, /// Gain of log-likelihood above which runs have a wind of their own, over other differences between runs. Judgement.
        wind_or_drag_gain: f64 = 9.0, /// Below this gain it may as well be a brake that drags in some of them. Measured.
        wind_sd: f64 = 1.3, /// The spread of winds is that much less certain than that of as many known values. Measured.
        least_wind_mps: f64 = 0.8, /// The least spread of winds that matters, m/s. Judgement.
        drag_gain: f64 = 8.0, /// What dragging brakes must explain better than winds and constants, log-likelihood. Judgement: two coefficients, and what makes it sure.
        least_drag_n_per_kg: f64 = 1e-3, /// Smallest drag that is looked for, N/kg. Judgement.
        most_drag_n_per_kg: f64 = 0.05, /// Largest, N/kg. Judgement.
        most_dragging: f64 = 0.6, /// More than this share of the runs does not drag: it is the train. Judgement.
        drags: f64 = 1.0, /// A run drags if the data are more likely by so much, log-likelihood. Judgement.
        least_with_term: f64 = 0.15, /// Least share of the runs in which another length acts that has not all: fewer may be locations that are far off. Judgement: a shift is straight within a train's length.
        least_effort: f64 = 0.02, /// Units that need efforts nearer to those of the others are not reported, a share. Judgement: loads and sensors differ by about half of it.
        most_with_term: f64 = 0.9, /// Largest such share that is tried: in more of the runs it acts in all. Judgement.
    }
    /// What freedom costs, in log-likelihood: the same for resistance, traction and readings.
    penalty: PenaltyConfig {
        coefficient: f64 = 2.1, /// A free coefficient. Derived: half the logarithm of about 67 runs.
        coefficient_runs: usize = 67, /// Of more runs than these it is so much dearer as their logarithm is larger; of fewer it is no cheaper, for they show less. Derived.
        section: f64 = 5.0, /// The choice of a section. Derived: about the logarithm of the sections that differ.
        shape: f64 = 1.5, /// The choice of a time constant, or another number that is a shape. Judgement.
        unnamed: f64 = 4.0, /// What an unnamed term must be better by than a named one. Judgement.
        unnamed_law: f64 = 1.0, /// An unnamed law beyond its coefficient: one law instead of three coefficients, a little dearer than one of them. Judgement.
        shift: f64 = 4.0, /// What another length must be better by. Judgement: locations that are off by some metres look like it.
        bad_days: f64 = 6.0, /// The choice of the runs with low adhesion. Judgement.
        caution: f64 = 6.0, /// What it takes to believe that it is not all drivers who are cautious. Judgement.
    }
    /// Which terms of the resistance are missing.
    search: SearchConfig {
        enough: f64 = 5.0, /// A gain less penalty below this is chance. Derived: with some fifteen families a data set without an effect reaches it once in about a hundred.
        shadow: f64 = 0.003, /// A term that brings less than this share of what the model has brought already may be its law being a little different. Derived: an effect of a twentieth of the size.
        most_terms: usize = 4, /// Most terms in a model. Judgement.
        starts: usize = 3, /// Terms with which a model may begin. Judgement.
        better: f64 = 0.5, /// What another term in the place of one must be better by, log-likelihood. Judgement.
        few_rows: usize = 80, /// Fewer rows are no ground for a term. Judgement.
        least_rows: usize = 30, /// With fewer nothing is calibrated. Judgement.
        most_share: f64 = 1.5, /// Largest extra resistance over the believed one, Röckl's of the described curves included: more is too few rows for so many coefficients. Judgement.
        most_beyond_n_per_kg: f64 = 0.01, /// Beyond that share, N/kg. Judgement.
        least_n_per_kg: f64 = 3e-4, /// What acts always must be as large as this in more than a fifth of the rows, N/kg. Derived: 1 % of a train's resistance at 100 km/h.
        least_in_section_n_per_kg: f64 = 2e-3, /// Least size in a section of the line, N/kg. Derived: 0.2 permille.
        edge_m: f64 = 100.0, /// Spacing of the edges of sections that are tried, m. Judgement.
        most_edges: f64 = 400.0, /// Most edges. Judgement: the time it takes.
        shortest_m: f64 = 300.0, /// Shortest section, m. Judgement.
        most_tunnel: f64 = 4.0, /// Largest extra air drag of a tunnel, over that of the open line. Judgement: in narrow single-track tunnels trains meet two to three times the air drag of the open line.
        least_in_section: usize = 5, /// Intervals whose middle lies in a section of which something is said. Judgement.
        longest_share: f64 = 0.4, /// Longest section, as a share of the line. Judgement: more is no matter of place.
        against: f64 = -3.0, /// A part of the rows in which a term makes the fit worse by more contradicts it, log-likelihood. Derived: with a true effect, about one part in a hundred.
        least_part: f64 = 0.05, /// A part with a smaller share of the information on a term does not contradict it. Judgement: what the noise model lacks is as large there.
        braking_n_per_kg: f64 = -0.02, /// A part contradicts, or supports, by rows with a measured effort above this: drivers brake at the same places in each run, N/kg. Judgement.
        descends_n_per_kg: f64 = 2e-3, /// A line descends where its described slope, mean under the path of an interval, takes more than this off the load, N/kg. Derived: 0.2 permille, the least that is named in a section.
        acting: f64 = 0.1, /// A term acts where it adds more than this share of the most that it adds. Judgement.
        held_mps2: f64 = 0.02, /// A speed that changes by less is held, m/s². Judgement.
    }
    /// How sure a name and its values are.
    certainty: CertaintyConfig {
        chance: f64 = 0.03, /// A term of which chance makes as much more often has no name. Derived: false names in at most 3 of 100 sets that hide nothing.
        halves: f64 = 3.0, /// Halves of the runs that differ by more standard deviations do not show the same. Judgement.
        halves_apart: f64 = 0.5, /// Halves that differ by no more than this share of the effect show the same, however sure they are. Judgement: a law that is not quite the true one, readings that differ by direction.
        at_once: f64 = 0.3, /// The share of a section that acts as soon as the front is inside, below which nothing is said of it. Judgement.
        telling_half: f64 = 0.5, /// A half whose standard deviation is a smaller share of the effect could show it. Judgement.
        law: f64 = 0.01, /// A law is as good as this share of its coefficient, whatever the noise. Measured: means over 10 s, the path between readings.
        chosen: f64 = 0.05, /// How much further the limits of another length reach where only some runs have it, share of the difference. Measured.
        chosen_one_way: f64 = 0.15, /// The same where all runs go in one direction, and locations that are off look like a part of it. Measured: an error of 0.14 of it beside locations that were 60 m off.
        described: f64 = 0.1, /// How well a Davis coefficient is described that is left as it is, as a share of it. Judgement.
        nothing_n_per_kg: f64 = 1e-4, /// A dependence up to this is none: what rounding and the reading of the sensors leave, N/kg. Measured.
        rival_within: f64 = 3.0, /// A rival within this log-likelihood is not distinguishable. Derived: odds of 20.
        rival_most: f64 = 10.0, /// A rival that is worse by more has no odds. Derived: odds of 22 000.
        ruled_out: f64 = 6.9, /// A rival that is worse by more is ruled out. Derived: odds of 1000.
        confounded: f64 = 0.5, /// Odds that one effect is two others together which no search over single ones compares, where both fit: other Davis coefficients in one direction and a steady wind, beside a wrong gain and another mass; a limit of a section on a line described as level and a climb; or that a weak traction is drivers who never ask for all of it. Judgement.
        most_wind_mps: f64 = 10.0, /// No wind is stronger in all runs alike, nor its standard deviation between runs, m/s. Judgement.
        same_force: f64 = 0.03, /// Share of the traction within which a limit that the effort column shows as described is one and the same with the column's gain: what is off may be the mass. Judgement.
        same: f64 = 1.5, /// A tunnel and a gradient this near take the name that the track describes, log-likelihood. Judgement.
        described_m: f64 = 600.0, /// A described section whose edges are this near to those found takes their place, m. Judgement.
        overlap: f64 = 0.4, /// Sections overlap from this share of both together. Judgement.
        unforeseen: f64 = 0.1, /// Odds that a limit of the traction, or a wheel of single runs, is what drivers and recorders do besides, which no trial by chance shows. Measured: of names with 0.99 on sets of another simulator a third was wrong, and a tenth once their causes were mended.
        most_gain: f64 = 30.0, /// Confidence counts a gain of log-likelihood up to this. Judgement.
        limit: f64 = 0.006, /// What rounding, and efforts that rise within a reading, do to the factor of a limit, as a share of it. Measured.
        below_kmh: f64 = 3.0, /// What a speed changes between two readings of an accelerating train, km/h. Derived: 10 s at 0.08 m/s².
        little_less: f64 = 0.85, /// Above this factor what a section lacks in power may as well be a resistance in it, where the effort is calculated. Judgement.
        coasted_rows: usize = 10, /// Intervals that must coast in a section for its resistance to be known there. Judgement.
        unshared: f64 = 0.7, /// Odds that a name which the runs that are not held out do not give by themselves is another. Measured: of 21 such names on sets of two other simulators 10 were right, and 4 shared with the right one.
        denied: f64 = 1.0, /// Odds that names which the hold-out runs deny are others. Measured: 4 of 5 such sets had a false name, each beside a right one or another false one.
        as_described: f64 = 0.25, /// Of two units or drivers one is as described where it differs by less than this share of what the two differ by. Judgement.
        alone: f64 = 4.0, /// Odds that coefficients which all runs seem to have wrong are then those of the other alone. Judgement.
        few_dragging: usize = 2, /// In no more runs than this a brake that drags may be one that was released late, or another load or wind. Judgement.
        coasted_drag: f64 = 0.5, /// These intervals deny a resistance where they show less than this share of it, with 95 %. Judgement.
        same_mass: f64 = 0.5, /// Masses by air drag and by power agree within this share of the first. Judgement.
        same_mass_at_least: f64 = 0.02, /// And this share of the train. Judgement.
    }
    /// Limits of the traction.
    traction: TractionConfig {
        least_share: f64 = 0.4, /// The least share of the nominal that drivers demand. Judgement.
        stray: f64 = 0.1, /// Probability that an interval is not steady power after all. Judgement.
        moved_between: f64 = 0.5, /// Probability that a driver has moved the handle between two powering phases, or where the power limits instead of the effort. Judgement: the same share or another, as likely.
        by_power: f64 = 1.001, /// Effort limit over power limit above which the power limits. Derived: 1 but for rounding.
        corner: f64 = 1.35, /// The same up to which the corner reaches, near which neither share limits. Judgement.
        sensor: f64 = 0.008, /// What the effort sensor differs by from run to run and within one, as a share. Measured.
        slowest_mps: f64 = 1.5, /// A slower train is starting, m/s. Judgement.
        least_acceleration_mps2: f64 = 0.03, /// Least acceleration of a powering train, m/s². Judgement.
        least_gain_mps: f64 = 4.0, /// Speed that a powering phase must gain to count, m/s. Judgement: less holds a speed.
        apart_s: f64 = 25.0, /// Without power for so long, the next power is another phase, s. Judgement.
        decision_s: f64 = 10.0, /// A driver leaves the handle where it is for about so long, s. Judgement.
        alike: f64 = 0.02, /// Neighbours differ by less, as a share of the limit, beyond what is known of them. Judgement.
        alike_sd: f64 = 2.5, /// And by so many standard deviations. Judgement.
        speed_sd_mps: f64 = 0.06, /// Standard deviation of a speed where the power limits, m/s: of an interval. Derived from rounding.
        rounding_mps: f64 = 0.3, /// A rounded speed shows no gain below it, m/s. Derived: a step of 1 km/h.
        sampled_speed_sd_mps: f64 = 0.08, /// The same of a sample, m/s. Derived.
        starting_speed_sd_mps: f64 = 0.03, /// The same where the effort limits and only its rise counts, m/s. Derived.
        left_mps: f64 = 2.0, /// Near the speed that is wanted, m/s. Judgement.
        taken_back: f64 = 0.85, /// There less than this share of what was demanded before is power taken back. Judgement.
        floating: f64 = 0.015, /// The power stays within this share of the limit while the speed floats. Judgement.
        floating_s: f64 = 50.0, /// For so long, s. Judgement.
        floating_mps: f64 = 0.8, /// Meanwhile the speed differs by this much, m/s. Derived: more than rounding and a driver who corrects it.
        least_s: f64 = 3.0, /// Samples nearer than this say the same, s. Judgement.
        neighbour_s: f64 = 8.0, /// Neighbours are at least so far, s. Derived: a full acceleration moves the rounded speed by more than its step.
        rise_s: f64 = 6.0, /// So long after the power is raised it may still rise, s. Judgement.
        least_runs: usize = 3, /// Least runs with powering phases. Judgement.
        least_scale: f64 = 0.03, /// A scale nearer to 1 is no finding. Judgement.
        edge_m: f64 = 250.0, /// Edges of sections lie on this grid before they are refined, m. Judgement.
        factors: usize = 14, /// Factors that are tried. Judgement: the time it takes.
        starts: usize = 3, /// Sections that are refined. Judgement: the time it takes.
        shared: f64 = 0.25, /// Weight of a part in the search: what the parts of a phase share counts once. Judgement.
        same_loss: f64 = 0.3, /// A loss of log-likelihood that is none, where an edge is put. Judgement.
        most_inside: f64 = 0.9, /// A section that holds more than this share of what is powered at the limit of the power is no matter of place but of the train. Judgement.
        step_m: f64 = 50.0, /// Nearer phases are not tried one by one, m. Judgement.
        soon_m: f64 = 500.0, /// How far beyond the last phase an edge is put at most, m. Judgement.
        above: f64 = 1.1, /// A ratio above a limit by less is the sensor, or a reading of the speed. Judgement.
        sure: f64 = 4.0, /// So many standard deviations below a calculated effort the true one never is. Judgement.
        few_runs: usize = 3, /// Fewer runs that exceed a limit are strays. Judgement.
        few_share: f64 = 0.1, /// And fewer than this share of those that power there. Judgement.
        left_share: f64 = 0.5, /// A section of which less is left is none. Judgement.
        before_m: f64 = 50.0, /// The readings that exceed a limit show where it begins: just before, m. Judgement.
        beyond_m: f64 = 500.0, /// Or as far on as a train goes between two readings, m. Derived: 10 s at 180 km/h.
        own_decisions: f64 = 5.0, /// What the demands of all runs weigh beside those of one, in decisions of its driver. Judgement.
        moves_at_first: f64 = 0.1, /// Probability that the handle is moved from one interval to the next, to begin with. Judgement.
        beside_kmh: f64 = 3.0, /// So near to the speed below which adhesion is less an interval may be partly above, km/h. Derived: 10 s at 0.08 m/s².
        slippery_gain: f64 = 0.5, /// Gain of log-likelihood below which a run says nothing of bad days. Judgement.
        least_factor_sd: f64 = 0.005, /// Standard deviation of a factor of adhesion, at least. Judgement: half of what the sensor differs by.
        low_kmh: f64 = 75.0, /// What may as well act above this speed is no matter of starting, km/h. Judgement.
        less_power: f64 = 0.05, /// Less than the described power by this share, beside all of the effort, is reported. Judgement: shares differ by 0.01 where nothing is wrong.
        largest: f64 = 0.95, /// Quantile of the shares that counts for the largest. Judgement: few are strays.
        shown_intervals: usize = 20, /// Least intervals that show it. Judgement.
        shown_runs: usize = 5, /// And runs. Judgement: a few drivers are not all.
        most_slippery: f64 = 0.6, /// More than this share of the runs are no bad days but the train. Judgement.
    }
    /// Is there a gap at all?
    evidence: EvidenceConfig {
        flips: usize = 999, /// Sign flips of whole runs. Derived: the least p-value is 0.001.
        steady_n_per_kg: f64 = 0.01, /// An effort that changes by more within an interval is no evidence, N/kg. Measured: its mean is wrong in the same way in all runs.
        unsteady_wider: f64 = 30.0, /// How many times wider such an interval is taken to scatter. Judgement: it is no evidence, and what is fitted beside does not rest on it.
        coast_n_per_kg: f64 = 0.005, /// An effort up to this is coasting, N/kg. Judgement.
        location_knots: usize = 24, /// Knots along the location. Judgement.
        knots: usize = 7, /// Knots along speed and time. Judgement.
        run_knots: usize = 5, /// Knots along temperature and day. Judgement.
        least_rows: usize = 30, /// From fewer rows their scatter is not known. Judgement.
        powering_habit: f64 = 0.15, /// What all drivers do alike between two readings while powering, as a share of the scatter beyond that of coasting. Judgement: most intervals have no change, a few a large one.
        braking_habit: f64 = 1.0, /// The same while braking. Judgement: what happens between two readings there happens in most intervals.
        least_runs: usize = 3, /// Least runs of a probe. Derived: fewer signs cannot be flipped.
        significant: f64 = 0.05, /// A p-value below this is evidence of a gap. Judgement: convention.
        sure: f64 = 0.0015, /// Below this p-value there is a gap, named or not. Derived: that of fewer than one in a thousand flips of signs.
    }
    /// The repaired model on hold-out runs.
    holdout: HoldoutConfig {
        one_in: usize = 5, /// One run in so many is held out unless the caller says how many. Judgement.
        least_training: usize = 5, /// Fewer runs are no ground to find an effect in. Judgement.
        few_runs: usize = 10, /// With fewer runs a name rests on little. Judgement.
        least_flipped: usize = 8, /// With fewer hold-out runs signs can be flipped in too few combinations to exclude chance. Derived: 128 combinations.
        window_s: f64 = 120.0, /// Length of a window that begins at a measured speed, s. Judgement.
        stalled_mps: f64 = 0.5, /// A simulated train slower than this does not arrive, m/s. Judgement.
        most_time: f64 = 3.0, /// Nor one that takes so many times as long as was measured. Judgement.
        piece_s: f64 = 9.5, /// Pieces from which the noise of the locations is taken, s. Judgement.
        touches: f64 = 0.1, /// An effect touches a speed that it moves by more than this share of what a perfect model would leave. Judgement.
        least_sd_mps: f64 = 0.01, /// No speed weighs as if it were known better, m/s. Judgement: a run whose locations are its summed speeds would outweigh all others.
        least_touched: usize = 30, /// Fewer speeds show nothing. Judgement.
        least_removable: f64 = 0.02, /// A gap above the noise floor by a smaller share of it is none, in mean squares. Judgement.
        least_resampled: usize = 5, /// With fewer runs a bootstrap says nothing. Judgement.
        resamples: usize = 999, /// Bootstrap samples. Derived: 25 beyond each end of the interval.
        most_without: f64 = 0.05, /// Where more than this share of them has nothing to remove, there is no interval. Derived: 5 % lie outside.
        foreseen: f64 = 1.4, /// What is there between this many times as much as the effects foresee, and as many times less, is what they foresee. Judgement.
        denied: f64 = 0.8, /// The hold-out runs deny names where they have less than this multiple of what these foresee, with 97.5 %. Measured: so of 1 of 153 sets of another simulator without a false name, and of 4 of 29 with one.
        explained: f64 = 0.7, /// A gap of which less was removed is explained only in part. Judgement.
        still_there: f64 = 2.0, /// A gap of which less was removed than that, and which is so many times what a perfect model would leave, is there whatever the p-value says. Judgement.
        worse: f64 = 1.001, /// The repaired model is worse if it is off by so many times as much. Judgement.
        free_share: f64 = 0.01, /// A limit within this share of the described one holds nobody back: what a driver gives there is what he demands. Judgement.
        free_sd: f64 = 2.0, /// Nor does a limit that is so many standard deviations above the effort. Judgement.
        one_sided: f64 = 1.64, /// Standard deviations above the floor of running times and energies that chance reaches. Derived: 95 % of the normal distribution, one-sided.
    }
}

impl PenaltyConfig {
    /// As it is for a set of so many runs.
    pub(crate) fn of_runs(&self, runs: usize) -> Self {
        let larger = (runs.max(1) as f64).ln() / (self.coefficient_runs.max(2) as f64).ln();
        Self { coefficient: self.coefficient * larger.max(1.0), ..self.clone() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_coefficient_costs_more_in_more_runs_and_no_less_in_fewer() {
        let of = |runs| PenaltyConfig::default().of_runs(runs).coefficient;
        assert_eq!([of(0), of(20), of(67)], [2.1; 3]);
        assert!((of(67 * 67) - 4.2).abs() < 1e-12);
    }

    #[test]
    fn each_setting_says_its_source_and_the_printed_file_is_the_default() {
        let text = GapConfig::default().commented();
        assert_eq!(toml::from_str::<GapConfig>(&text).unwrap(), GapConfig::default());
        let mut documented = false;
        for line in text.lines() {
            if line.starts_with('#') {
                documented = ["Measured", "Derived", "Judgement"].iter().any(|source| line.contains(source));
            } else if line.contains(" = ") {
                assert!(documented, "{line}");
            }
        }
    }

    #[test]
    fn a_name_that_is_none_is_refused() {
        let refused = toml::from_str::<GapConfig>("[search]\nenuogh = 4.0\n").unwrap_err();
        assert!(refused.to_string().contains("enuogh"), "{refused}");
    }
}
