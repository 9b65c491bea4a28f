//! What frames say together that none says alone: how much was learned, how well coasts were foreseen, which sensor is
//! to be looked at.
//!
//! In: frames in their order. Out: [`Conclusion`], a part of the state. Nothing is known before its frames have come:
//! then it is `None`.

use super::text::NINETY;
use rundown_wire::{Cause, CoastAhead, CoastOutcome, Estimate, Learned, Parameters, Regime, Status};
use serde::Serialize;

/// Speeds at which it is said what was learned, km/h; those of `parameters.csv`.
pub const SPEEDS_KMH: [f32; 4] = [20.0, 60.0, 100.0, 140.0];
/// A sensor with fewer readings that could not be used is not suspected: every recorder loses some.
const LEAST_DOUBTS: u32 = 3;

/// What is concluded.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Conclusion {
    /// Information on r(v) since this display heard that nothing was learned yet, bits at [`SPEEDS_KMH`]: log2 of the
    /// standard deviation then over that of now.
    pub learned_bits: Option<[f32; SPEEDS_KMH.len()]>,
    /// Coasts whose first prediction could be compared with their last.
    pub coasts: Coasts,
    /// The sensor with the most readings of this run that could not be used.
    pub suspected: Option<Suspected>,
    #[serde(skip)]
    first_sd: Option<[f32; SPEEDS_KMH.len()]>,
    #[serde(skip)]
    coast: Option<Coast>,
    #[serde(skip)]
    regime: Regime,
}

/// Predictions of the speed at the next target, made as a coast began, against the last one before it ended.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Coasts {
    pub count: u32,
    /// Of these, last predictions within the 90 % interval of the first.
    pub within: u32,
    /// Last less first, root mean square, m/s.
    pub rms_mps: f32,
}

/// A sensor, and how often its readings could not be used, the most frequent cause first.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Suspected {
    pub sensor: &'static str,
    pub count: u32,
    pub causes: Vec<(&'static str, u32)>,
}

/// A coast under way: its target, its first prediction and its newest one.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Coast {
    at_m: f32,
    first: [f32; 2],
    last_mps: f32,
    /// One that came before the estimate of its time: the train may have begun to brake there.
    unconfirmed: Option<(f64, f32)>,
    /// When the newest was made, s: a frame that comes again is no further prediction.
    from_time_s: f64,
    predictions: u32,
}

impl Coast {
    /// The train coasts at this time.
    fn confirm(&mut self, time_s: f64) {
        if let Some((from_time_s, speed_mps)) = self.unconfirmed.filter(|(from_time_s, _)| *from_time_s <= time_s) {
            self.last_mps = speed_mps;
            self.from_time_s = from_time_s;
            self.predictions += 1;
            self.unconfirmed = None;
        }
    }
}

impl Conclusion {
    /// What stays when a run ends: the sensor's doubts are of the run.
    pub fn next_run(self) -> Self {
        let mut judged = self;
        judged.end_coast();
        Self { suspected: None, regime: Regime::default(), ..judged }
    }

    pub fn parameters(&mut self, parameters: &Parameters) {
        let sd = SPEEDS_KMH.map(|kmh| parameters.at(kmh / 3.6).sd);
        if parameters.learned == Learned::NotYet && self.first_sd.is_none() {
            self.first_sd = Some(sd);
        }
        self.learned_bits = self.first_sd.map(|first| std::array::from_fn(|i| (first[i] / sd[i]).log2()));
    }

    pub fn estimate(&mut self, estimate: &Estimate) {
        self.regime = estimate.regime;
        if self.regime != Regime::Coast {
            self.end_coast();
        } else if let Some(coast) = &mut self.coast {
            coast.confirm(estimate.time_s);
        }
    }

    pub fn coast_ahead(&mut self, ahead: &CoastAhead) {
        let (Some(target), CoastOutcome::Arrives(arrival)) = (ahead.target, ahead.outcome) else {
            return;
        };
        if self.regime != Regime::Coast {
            return;
        }
        let speed = arrival.speed_mps;
        match &mut self.coast {
            Some(coast) if coast.at_m == target.at_m => {
                if coast.from_time_s != ahead.from_time_s {
                    coast.unconfirmed = Some((ahead.from_time_s, speed.value));
                }
            }
            _ => {
                self.end_coast();
                let first = [speed.value, speed.sd];
                self.coast = Some(Coast {
                    at_m: target.at_m,
                    first,
                    last_mps: speed.value,
                    unconfirmed: None,
                    from_time_s: ahead.from_time_s,
                    predictions: 1,
                });
            }
        }
    }

    /// A coast with one prediction says nothing.
    fn end_coast(&mut self) {
        let Some(coast) = self.coast.take().filter(|coast| coast.predictions > 1) else {
            return;
        };
        let [first_mps, sd_mps] = coast.first;
        let error_mps = coast.last_mps - first_mps;
        let Coasts { count, within, rms_mps } = self.coasts;
        let squares = count as f32 * rms_mps.powi(2) + error_mps.powi(2);
        self.coasts = Coasts {
            count: count + 1,
            within: within + u32::from(error_mps.abs() <= NINETY * sd_mps),
            rms_mps: (squares / (count + 1) as f32).sqrt(),
        };
    }

    pub fn status(&mut self, status: &Status) {
        let counted = Cause::ALL.into_iter().zip(status.causes).filter(|(_, count)| *count > 0);
        let mut sensors: Vec<Suspected> = Vec::new();
        let mut add = |sensor, word, count| match sensors.iter_mut().find(|one| one.sensor == sensor) {
            Some(one) => {
                one.count += count;
                one.causes.push((word, count));
            }
            None => sensors.push(Suspected { sensor, count, causes: vec![(word, count)] }),
        };
        counted.for_each(|(cause, count)| {
            sensor(cause).into_iter().for_each(|sensor| add(sensor, cause.as_str(), count));
        });
        if status.time_not_increasing > 0 {
            add("clock", "time_not_increasing", status.time_not_increasing);
        }
        // The first of two that are equal stays: the order is fixed.
        let worst = sensors.into_iter().rev().max_by_key(|one| one.count);
        self.suspected = worst.filter(|one| one.count >= LEAST_DOUBTS).map(|mut one| {
            one.causes.sort_by_key(|(_, count)| std::cmp::Reverse(*count));
            one
        });
    }
}

/// Whose readings a cause speaks of; none where it does not say.
fn sensor(cause: Cause) -> Option<&'static str> {
    match cause {
        Cause::NoLocation
        | Cause::LocationOutOfRange
        | Cause::LocationJump
        | Cause::StuckLocation
        | Cause::Contradiction => Some("location"),
        Cause::NoSpeed | Cause::SpeedOutOfRange | Cause::SpeedJump | Cause::StuckSpeed => Some("speed"),
        Cause::LongGap => Some("clock"),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::display::tests::MESSAGES;
    use rundown_wire::{Body, CoastArrival, CoastTarget, Downlink, Validity, Value};

    fn parameters(sd: f32, learned: Learned) -> Parameters {
        let term = Value { value: 1e-2, sd };
        Parameters { r0: term, r1: Value::default(), r2: Value::default(), correlation: [0.0; 3], learned, gain: None }
    }

    fn estimate(regime: Regime) -> Estimate {
        let value = Value { value: 1.0, sd: 0.1 };
        Estimate {
            time_s: 0.0,
            dt_s: 10.0,
            location_m: value,
            speed_mps: value,
            regime,
            confirmed: None,
            learning: false,
            validity: Validity::Valid,
            digest: 0,
        }
    }

    fn ahead(from_time_s: f64, at_m: f32, value: f32, sd: f32) -> CoastAhead {
        CoastAhead {
            from_time_s,
            from_location_m: 0.0,
            from_speed_mps: 30.0,
            target: Some(CoastTarget { at_m, limit_mps: None }),
            outcome: CoastOutcome::Arrives(CoastArrival {
                speed_mps: Value { value, sd },
                time_s: 0.0,
                time_sd_s: 1.0,
            }),
        }
    }

    #[test]
    fn half_the_deviation_is_one_bit_and_a_late_joiner_does_not_know() {
        let mut judged = Conclusion::default();
        judged.parameters(&parameters(4e-3, Learned::NotYet));
        assert_eq!(judged.learned_bits, Some([0.0; 4]));
        judged.parameters(&parameters(2e-3, Learned::Learned));
        assert_eq!(judged.learned_bits, Some([1.0; 4]));
        judged = judged.next_run();
        judged.parameters(&parameters(1e-3, Learned::Learned));
        assert_eq!(judged.learned_bits, Some([2.0; 4]), "over the runs");
        let mut late = Conclusion::default();
        late.parameters(&parameters(2e-3, Learned::Learned));
        assert_eq!(late.learned_bits, None);
    }

    #[test]
    fn the_first_prediction_of_a_coast_is_compared_with_its_last() {
        let mut judged = Conclusion::default();
        let mut coast = |predictions: &[(f32, f32)]| {
            judged.estimate(&estimate(Regime::Coast));
            for (i, (mps, sd)) in predictions.iter().enumerate() {
                // The board repeats its newest prediction; each comes before the estimate of its time.
                (0..3).for_each(|_| judged.coast_ahead(&ahead(10.0 * i as f64, 9e3, *mps, *sd)));
                judged.estimate(&Estimate { time_s: 10.0 * i as f64, ..estimate(Regime::Coast) });
            }
            // What is foreseen from the first sample of the brake is not of the coast.
            judged.coast_ahead(&ahead(10.0 * predictions.len() as f64, 9e3, 3.0, 0.1));
            judged.estimate(&Estimate { time_s: 10.0 * predictions.len() as f64, ..estimate(Regime::Brake) });
            judged.coasts
        };
        assert_eq!(coast(&[(20.0, 1.0)]).count, 0, "nothing to compare");
        assert_eq!(coast(&[(20.0, 1.0), (25.0, 0.5), (21.0, 0.2)]), Coasts { count: 1, within: 1, rms_mps: 1.0 });
        let both = coast(&[(20.0, 1.0), (23.0, 0.2)]);
        assert_eq!((both.count, both.within), (2, 1));
        assert!((both.rms_mps - 5_f32.sqrt()).abs() < 1e-6, "{both:?}");
        judged.coast_ahead(&ahead(0.0, 9e3, 1.0, 1.0));
        judged.coast_ahead(&ahead(10.0, 9e3, 2.0, 1.0));
        judged.estimate(&estimate(Regime::Brake));
        assert_eq!(judged.coasts.count, 2, "predictions of a train that does not coast");
    }

    #[test]
    fn the_sensor_with_the_most_doubts_is_suspected() {
        let mut judged = Conclusion::default();
        let status = |message: &Vec<u8>| match Downlink::decode(message).unwrap().body {
            Body::Status(status) => Some(status),
            _ => None,
        };
        let mut status = MESSAGES.iter().find_map(status).unwrap();
        let at = |cause: Cause| Cause::ALL.iter().position(|one| *one == cause).unwrap();
        status.causes = [0; Cause::ALL.len()];
        status.causes[at(Cause::NoSpeed)] = 2;
        judged.status(&status);
        assert_eq!(judged.suspected, None, "two are none");
        status.causes[at(Cause::LocationJump)] = 3;
        status.causes[at(Cause::StuckLocation)] = 7;
        status.causes[at(Cause::Numerics)] = 99;
        judged.status(&status);
        let expected =
            Suspected { sensor: "location", count: 10, causes: vec![("stuck_location", 7), ("location_jump", 3)] };
        assert_eq!(judged.suspected, Some(expected));
        assert_eq!(judged.next_run().suspected, None);
    }
}
