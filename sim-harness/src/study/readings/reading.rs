//! What is compared: readings of the text, and recorders that the text does not exclude.

use rundown::filter::ukf::Spread;
use rundown::model::state::SIZE;
use rundown::model::train::{Train, TrainDescription};
use rundown::tick::paper::{Difference, PaperConfig};
use rundown_truth::sensors::{Sensors, SpeedReading};

/// How much older than the location the speed is, s; below zero it is newer. Ten seconds are one row.
pub const SKEWS_S: [f64; 7] = [-8.0, -4.0, 0.0, 3.0, 5.0, 8.0, 10.0];
/// At these gradient and Table 1 are read in every way: none, the first that has most remarks, and a row.
const CROSSED_S: [f64; 3] = [0.0, 8.0, 10.0];
/// At these the spread of the points is compared, too.
const CONTRASTED_S: [f64; 2] = [0.0, 8.0];
/// Table 1's α and κ, and no knowledge of the distribution.
const PLAIN: Spread<SIZE> = Spread::new(1e-3, 0.0, -2.0);
const EFFORTS: [Difference; 2] = [Difference::Backward, Difference::Forward];
/// A train so short has the gradient of a point, m.
const POINT_M: f64 = 1.0;

/// Where the gradient is taken.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Gradient {
    /// The mean under the train, as section 4.1 says.
    UnderTrain,
    /// That of its front.
    Point,
}

/// What the initial values of Table 1 are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Initial {
    /// Standard deviations, as its caption says.
    Deviations,
    /// Variances in SI units, as the symbol of section 4.2's remark may mean.
    Variances,
}

/// α, β and κ.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SigmaPoints {
    /// As Table 1 has them.
    Printed,
    /// The points reach as far as the deviations (α = 1).
    Wide,
    /// Without knowledge of the distribution (β = 0).
    Plain,
}

/// A reading of the text.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Reading {
    pub difference: Difference,
    pub gradient: Gradient,
    pub initial: Initial,
    pub points: SigmaPoints,
}

/// How the runs were recorded.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Recorder {
    /// Age of the speed less age of the location, s.
    pub skew_s: f64,
    pub speed: SpeedReading,
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Combination {
    pub reading: Reading,
    pub recorder: Recorder,
}

impl Reading {
    /// As the text says, but for the effort, of which it says less.
    pub fn of(difference: Difference) -> Self {
        Self { difference, gradient: Gradient::UnderTrain, initial: Initial::Deviations, points: SigmaPoints::Printed }
    }

    /// Every reading of gradient and Table 1; the first is as the text says.
    fn crossed(difference: Difference) -> [Self; 4] {
        use {Gradient::*, Initial::*};
        [(UnderTrain, Deviations), (Point, Deviations), (UnderTrain, Variances), (Point, Variances)]
            .map(|(gradient, initial)| Self { gradient, initial, ..Self::of(difference) })
    }

    /// The same with points that are not spread as Table 1 says.
    fn spread(self) -> [Self; 2] {
        [SigmaPoints::Wide, SigmaPoints::Plain].map(|points| Self { points, ..self })
    }

    pub fn config(self) -> PaperConfig {
        let spread = match self.points {
            SigmaPoints::Printed => Spread::PAPER,
            SigmaPoints::Wide => Spread::WIDE,
            SigmaPoints::Plain => PLAIN,
        };
        let printed = PaperConfig { difference: self.difference, spread, ..PaperConfig::default() };
        match self.initial {
            Initial::Deviations => printed,
            Initial::Variances => PaperConfig {
                initial_location_sd_m: printed.initial_location_sd_m.sqrt(),
                initial_speed_sd_kmh: 3.6 * (printed.initial_speed_sd_kmh / 3.6).sqrt(),
                initial_davis_sd: printed.initial_davis_sd.map(f64::sqrt),
                ..printed
            },
        }
    }

    /// The train whose gradient is taken so; `None` where the description is no train.
    pub fn train(self, described: &Train) -> Option<Train> {
        match self.gradient {
            Gradient::UnderTrain => Some(*described),
            Gradient::Point => Train::try_new(TrainDescription { length_m: POINT_M, ..*described.description() }).ok(),
        }
    }

    pub fn effort(self) -> &'static str {
        match self.difference {
            Difference::Backward => "backward",
            Difference::Forward => "forward",
        }
    }

    /// The effort, and what is not as the text says.
    pub fn words(self) -> String {
        let mut words = self.effort().to_owned();
        if self.gradient == Gradient::Point {
            words += ", gradient of the front";
        }
        if self.initial == Initial::Variances {
            words += ", Table 1 as variances";
        }
        if self.points != SigmaPoints::Printed {
            words = format!("{words}, {}", self.points_word());
        }
        words
    }

    pub fn gradient_word(self) -> &'static str {
        match self.gradient {
            Gradient::UnderTrain => "mean",
            Gradient::Point => "point",
        }
    }

    pub fn points_word(self) -> &'static str {
        match self.points {
            SigmaPoints::Printed => "printed",
            SigmaPoints::Wide => "\u{3b1} = 1",
            SigmaPoints::Plain => "\u{3b2} = 0",
        }
    }

    pub fn initial_word(self) -> &'static str {
        match self.initial {
            Initial::Deviations => "deviations",
            Initial::Variances => "variances",
        }
    }
}

impl Recorder {
    pub fn all() -> Vec<Self> {
        let speeds = [SpeedReading::Rounded, SpeedReading::Truncated];
        speeds.into_iter().flat_map(|speed| SKEWS_S.map(|skew_s| Self { skew_s, speed })).collect()
    }

    /// The sensors of the case study, skewed: the older of the two lags behind.
    pub fn sensors(self, plain: &Sensors) -> Sensors {
        Sensors {
            speed: self.speed,
            speed_lag_s: [self.skew_s.max(0.0); 2],
            location_lag_s: (-self.skew_s).max(0.0),
            ..plain.clone()
        }
    }

    pub fn speed_word(self) -> &'static str {
        match self.speed {
            SpeedReading::Rounded => "rounded",
            SpeedReading::Truncated => "truncated",
            SpeedReading::Exact => "exact",
        }
    }
}

impl Combination {
    /// Every reading on what these recorders wrote.
    pub fn of(recorders: impl Iterator<Item = Recorder> + Clone) -> Vec<Self> {
        let of = |difference| [&Reading::crossed(difference)[..], &Reading::of(difference).spread()].concat();
        let readings = EFFORTS.into_iter().flat_map(of);
        readings.flat_map(|reading| recorders.clone().map(move |recorder| Self { reading, recorder })).collect()
    }

    /// Both efforts with every recorder; both gradients and both readings of Table 1 with rounded and truncated speeds,
    /// without and with a skew; other points with truncated speeds, too.
    pub fn all() -> Vec<Self> {
        let crossed: Vec<Recorder> =
            Recorder::all().into_iter().filter(|recorder| CROSSED_S.contains(&recorder.skew_s)).collect();
        let mut all = Vec::new();
        let mut add = |reading, recorders: &[Recorder]| {
            all.extend(recorders.iter().map(|recorder| Self { reading, recorder: *recorder }));
        };
        for difference in EFFORTS {
            let [printed, others @ ..] = Reading::crossed(difference);
            add(printed, &Recorder::all());
            others.into_iter().for_each(|reading| add(reading, &crossed));
            let contrasted = CONTRASTED_S.map(|skew_s| Recorder { skew_s, speed: SpeedReading::Truncated });
            Reading::of(difference).spread().into_iter().for_each(|reading| add(reading, &contrasted));
        }
        all
    }

    /// Whether it is read as printed: what the picture shows.
    pub fn is_printed(&self) -> bool {
        self.reading == Reading::of(self.reading.difference)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_skew_ages_one_of_the_two() {
        let of = |skew_s| Recorder { skew_s, speed: SpeedReading::Truncated }.sensors(&Sensors::default());
        assert_eq!((of(8.0).speed_lag_s, of(8.0).location_lag_s), ([8.0; 2], 0.0));
        assert_eq!((of(-4.0).speed_lag_s, of(-4.0).location_lag_s), ([0.0; 2], 4.0));
    }

    #[test]
    fn every_combination_is_there_once_and_is_a_filter() {
        let all = Combination::all();
        assert_eq!(all.len(), 2 * (2 * SKEWS_S.len() + 3 * 2 * CROSSED_S.len() + 4));
        for (index, one) in all.iter().enumerate() {
            assert!(all[..index].iter().all(|before| before != one));
            let paper = one.reading.config();
            rundown::estimator::config::Config { paper, ..Default::default() }.check().unwrap();
        }
    }

    #[test]
    fn variances_are_wider_where_the_deviation_is_below_one() {
        let reading = Reading { initial: Initial::Variances, ..Reading::of(Difference::Forward) };
        let config = reading.config();
        assert!((config.initial_davis_sd[0] - 1e-3).abs() < 1e-15);
        assert!((config.initial_speed_sd_kmh / 3.6 - 5e-4_f64.sqrt()).abs() < 1e-12);
        assert_eq!(config.initial_location_sd_m, 1.0);
    }
}
