//! Traction effort capped at low speed on some days.

use crate::config::{PenaltyConfig, TractionConfig};
use crate::fit::{ANYWHERE, Climb, LOSS_AT_LIMIT, mixed_share};
use crate::traction::habit::{Habit, habits};
use crate::traction::powering::{SteadyPower, least_ratio};
use crate::traction::{limit::FoundLimit, shares::Shares};
use rundown::model::effects::{Effect, LowAdhesion};

/// Probability that a run with this gain is one of a slippery day, where so many are.
fn slippery(gain: f64, share: f64) -> f64 {
    let odds = share * gain.clamp(-50.0, 50.0).exp();
    odds / (odds + 1.0 - share)
}

fn below(power: &SteadyPower, kmh: f64) -> bool {
    3.6 * power.speed_mps < kmh
}

/// Share of the runs on slippery days, by expectation and maximisation, and the log-likelihood of all runs.
fn mixture(gains: &[f64], most_slippery: f64) -> (f64, f64) {
    let share =
        mixed_share(gains.len(), 30, most_slippery, |share| gains.iter().map(|gain| slippery(*gain, share)).sum());
    let total = gains.iter().map(|g| (share * g.clamp(-50.0, 700.0).exp() + 1.0 - share).ln()).sum();
    (share, total)
}

/// The search for a limit of the effort at low speed.
struct Adhesion<'a> {
    runs: &'a [Shares<'a>],
    config: &'a TractionConfig,
}

impl Adhesion<'_> {
    /// What a limit adds to the log-likelihood of each run, beside drivers who move the handle as they do where it does
    /// not act: above its speed, and below in the other runs. Which these are comes of a first look with what is above
    /// alone.
    fn gains(&self, factor: f64, below_kmh: f64) -> Vec<f64> {
        let first = self.gains_beside(factor, below_kmh, |_, power| if below(power, below_kmh) { 0.0 } else { 1.0 });
        let (share, _) = mixture(&first, self.config.most_slippery);
        let others: Vec<f64> = first.iter().map(|gain| 1.0 - slippery(*gain, share)).collect();
        self.gains_beside(factor, below_kmh, |run, power| if below(power, below_kmh) { others[run] } else { 1.0 })
    }

    /// The same beside the demands that are free of it, each as much as `free` says. A run that exceeds the limit is
    /// none of a bad day.
    fn gains_beside(&self, factor: f64, below_kmh: f64, free: impl Fn(usize, &SteadyPower) -> f64) -> Vec<f64> {
        let config = self.config;
        let cap = |power: &SteadyPower| factor * power.effort_over_limit;
        let limit = |power: &SteadyPower| if below(power, below_kmh) { cap(power) } else { 1.0 };
        let exceeds = |power: &SteadyPower| {
            let beyond = power.ratio - cap(power);
            below(power, below_kmh - config.beside_kmh)
                && beyond > config.sure * power.sd
                && beyond > (config.above - 1.0) * cap(power)
        };
        let gain = |(run, habit): (&Shares<'_>, &Habit)| {
            let gain = run.gain_beside(habit, limit);
            if gain > 0.0 && run.powering.iter().any(exceeds) { 0.0 } else { gain }
        };
        self.runs.iter().zip(&habits(self.runs, below_kmh, free, config)).map(gain).collect()
    }

    /// Log-likelihood of all runs.
    fn total(&self, factor: f64, below_kmh: f64) -> f64 {
        mixture(&self.gains(factor, below_kmh), self.config.most_slippery).1
    }

    /// Factor and speed of the likeliest limit, with its log-likelihood.
    fn likeliest(&self) -> Option<([f64; 2], f64)> {
        let mut best: Option<([f64; 2], f64)> = None;
        for below in (3..=12).map(|i| 5.0 * f64::from(i)) {
            for factor in (6..20).map(|i| 0.05 * f64::from(i)) {
                let total = self.total(factor, below);
                if best.is_none_or(|(_, most)| total > most) {
                    best = Some(([factor, below], total));
                }
            }
        }
        let climb = Climb {
            steps: [0.02, 2.0],
            shrink: 0.5,
            rounds: 4,
            least: 0.0,
            better: 0.0,
            first: 1.0,
            both: false,
            range: ANYWHERE,
        };
        Some(climb.from(best?.0, |[factor, below]| Some(self.total(factor, below))))
    }

    /// How often drivers demand about this share where no adhesion limits, each run as much as another: odds that it is
    /// a habit of theirs.
    fn demanded(&self, factor: f64, below_kmh: f64) -> f64 {
        let config = self.config;
        let near = |power: &SteadyPower| (power.ratio - factor).abs() < config.alike + config.alike_sd * power.sd;
        let of_run = |run: &Shares<'_>| {
            let above = || run.powering.iter().filter(|power| !below(power, below_kmh));
            let all: f64 = above().map(|power| power.weight).sum();
            let those: f64 = above().filter(|power| near(power)).map(|power| power.weight).sum();
            (all > 0.0).then(|| those / all)
        };
        let each: Vec<f64> = self.runs.iter().filter_map(of_run).collect();
        // A share of so many runs that may be anything to begin with (Jeffreys).
        (each.iter().sum::<f64>() + 0.5) / (each.len() as f64 + 1.0)
    }
}

/// A limit of the effort in the runs in which the powering phases at low speed show it.
pub fn adhesion(
    powering: &[&Vec<SteadyPower>],
    config: &TractionConfig,
    penalty: &PenaltyConfig,
) -> Option<FoundLimit> {
    // Who starts with little demands what no one demands later: what counts as powering at all may be a demand.
    let demands = TractionConfig { least_share: least_ratio(config), ..config.clone() };
    let runs: Vec<Shares<'_>> = powering.iter().map(|powering| Shares::new(powering, &demands)).collect();
    let search = Adhesion { runs: &runs, config: &demands };
    let ([factor, below], total) = search.likeliest()?;
    let of_runs = search.gains(factor, below);
    let (share, _) = mixture(&of_runs, config.most_slippery);
    // A run without powering at low speed says nothing, whatever the share of the others.
    let slips = |g: f64| g > config.slippery_gain && slippery(g, share) > 0.5;
    let days = || runs.iter().zip(&of_runs).filter(|(_, g)| slips(**g));
    let of_days: Vec<usize> = days().filter_map(|(run, _)| run.powering.first().map(|p| p.run)).collect();
    if of_days.is_empty() || of_days.len() as f64 > config.most_slippery * runs.len() as f64 {
        return None;
    }
    // As far as the log-likelihood loses no more than a 95 % limit allows.
    let reach = |step: f64, total_at: &dyn Fn(f64) -> f64| {
        let steps = (1..40).map(|i| f64::from(i) * step);
        steps.take_while(|by| total - total_at(*by) < LOSS_AT_LIMIT).last().unwrap_or(0.0)
    };
    let below_kmh = [-1.0, 1.0].map(|step| below + reach(step, &|by| search.total(factor, below + by)));
    if below_kmh[1] > config.low_kmh {
        return None;
    }
    let [up, down] = [0.002, -0.002].map(|step| reach(step, &|by| search.total(factor + by, below)));
    // Without the best tenth of its days, at least two: what rests on a few runs is no limit.
    let mut each: Vec<f64> = days().map(|(_, g)| (share * g.clamp(-50.0, 700.0).exp() + 1.0 - share).ln()).collect();
    each.sort_by(|a, b| b.total_cmp(a));
    let gain = total - each.iter().take((each.len() / 10).max(config.few_runs.saturating_sub(1))).sum::<f64>();
    Some(FoundLimit {
        effect: Effect::LowAdhesion(LowAdhesion { factor, below_kmh: below }),
        factor,
        factor_sd: (0.25 * (up - down)).max(config.least_factor_sd),
        runs: of_days,
        gain,
        value: gain - 2.0 * penalty.coefficient - penalty.shape - penalty.bad_days,
        edges_m: None,
        below_kmh: Some((below_kmh[0], below_kmh[1])),
        demanded: search.demanded(factor, below),
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::config::GapConfig;
    use crate::data::believed::starting_effort_n_per_kg;
    use crate::data::runs::{EffortReading, Recorded, Run};
    use crate::traction::powering::sampled_powering;
    use rand::{RngExt, SeedableRng};
    use rand_chacha::ChaCha8Rng;
    use rand_distr::{Distribution, StandardNormal};
    use rundown::model::direction::Direction;
    use rundown::model::train::{Train, TrainDescription};
    use rundown_files::sample::Sample;

    /// How a driver holds the handle.
    #[derive(Clone, Copy)]
    enum Handle {
        /// One share all the time.
        Still(f64),
        /// Every 10 to 50 s at another of these shares.
        Moved(&'static [f64]),
        /// In half of the starts at 30 to 45 % up to 14 km/h, then at one share.
        Hesitant(f64),
    }

    /// A run of a train that starts four times to 90 km/h, read every second. `cap`: share of the largest effort below
    /// a speed, km/h.
    fn run(rng: &mut ChaCha8Rng, train: &Train, handle: Handle, cap: Option<(f64, f64)>) -> Run {
        let most = starting_effort_n_per_kg(train);
        let (mut samples, mut time_s, mut location_m) = (Vec::new(), 0.0, 0.0);
        for _ in 0..4 {
            let (mut speed_mps, mut effort, mut share, mut moved_s) = (0.0_f64, 0.0_f64, 0.0, time_s);
            let slope = rng.random_range(0.0..0.03);
            let hesitates = rng.random_bool(0.5).then(|| (rng.random_range(0.3..0.45), 14.0));
            while speed_mps < 25.0 {
                if time_s >= moved_s {
                    moved_s = time_s + rng.random_range(10.0..50.0);
                    share = match handle {
                        Handle::Still(share) => share,
                        Handle::Moved(shares) => shares[rng.random_range(0..shares.len())],
                        Handle::Hesitant(share) => share,
                    };
                }
                let gently = matches!(handle, Handle::Hesitant(_));
                let share = match hesitates {
                    Some((first, until_kmh)) if gently && 3.6 * speed_mps < until_kmh => first,
                    _ => share,
                };
                let slips = cap.filter(|(_, below_kmh)| 3.6 * speed_mps < *below_kmh);
                let given = (share * train.max_effort_n_per_kg(speed_mps.max(0.5)))
                    .min(slips.map_or(f64::INFINITY, |(factor, _)| factor * most));
                effort = given.min(effort + 0.15);
                let noise: f64 = StandardNormal.sample(rng);
                samples.push(Sample {
                    time_s,
                    location_m: Some(location_m),
                    speed_mps: Some((36.0 * speed_mps).round() / 36.0),
                    effort_n_per_kg: Some(effort + 0.002 * noise),
                    ..Sample::default()
                });
                speed_mps += effort - slope - train.davis().resistance_n_per_kg(speed_mps);
                location_m += speed_mps;
                time_s += 1.0;
            }
            time_s += 120.0;
        }
        Run { name: String::new(), direction: Direction::Up, day: None, samples, recorded: Recorded::default() }
    }

    /// What 32 such runs show; `of` says how each is driven, and its cap.
    fn found(seed: u64, of: impl Fn(usize) -> (Handle, Option<(f64, f64)>)) -> Option<FoundLimit> {
        let (config, mut rng) = (GapConfig::default(), ChaCha8Rng::seed_from_u64(seed));
        let train = Train::try_new(TrainDescription::CASE_STUDY).unwrap();
        let powering = |index: usize| {
            let (handle, cap) = of(index);
            let run = run(&mut rng, &train, handle, cap);
            sampled_powering(&train, index, &run, EffortReading::Momentary, &config.traction)
        };
        let powering: Vec<Vec<SteadyPower>> = (0..32).map(powering).collect();
        adhesion(&powering.iter().collect::<Vec<_>>(), &config.traction, &config.penalty)
            .filter(|found| found.value > config.search.enough)
    }

    /// A quarter of the drivers holds the handle at 70 % every now and then, also while starting.
    fn restless(run: usize) -> Handle {
        if run.is_multiple_of(4) { Handle::Moved(&[0.98, 0.7]) } else { Handle::Still(0.98) }
    }

    #[test]
    fn drivers_who_hold_a_part_of_the_power_while_starting_do_not_slip() {
        for seed in 0..6 {
            let found = found(seed, |run| (restless(run), None));
            assert!(found.is_none(), "{seed}: {found:?}");
        }
    }

    #[test]
    fn drivers_who_hesitate_while_starting_do_not_slip() {
        for seed in 0..3 {
            let found = found(seed, |_| (Handle::Hesitant(0.95), None));
            assert!(found.is_none(), "{seed}: {found:?}");
        }
    }

    /// Of the effort the drivers demand 1.5 % less than of the power.
    #[test]
    fn effort_and_power_that_are_read_a_little_apart_are_no_bad_day() {
        let config = GapConfig::default().traction;
        let (mut rng, train) = (ChaCha8Rng::seed_from_u64(1), Train::try_new(TrainDescription::CASE_STUDY).unwrap());
        let powering = |index: usize| -> Vec<SteadyPower> {
            let still = 0.93 + 0.005 * (7 * index % 11) as f64;
            let handle = if index.is_multiple_of(4) { Handle::Moved(&[0.98, 0.98, 0.7]) } else { Handle::Still(still) };
            let run = run(&mut rng, &train, handle, None);
            let read = sampled_powering(&train, index, &run, EffortReading::Momentary, &config).into_iter();
            read.map(|p| if p.by_power { SteadyPower { ratio: 1.015 * p.ratio, ..p } } else { p }).collect()
        };
        let powering: Vec<Vec<SteadyPower>> = (0..32).map(powering).collect();
        let found = adhesion(&powering.iter().collect::<Vec<_>>(), &config, &GapConfig::default().penalty);
        assert!(found.as_ref().is_none_or(|found| found.value < 2.0), "{found:?}");
    }

    #[test]
    fn days_on_which_wheels_slip_are_found_among_such_drivers() {
        for seed in 0..3 {
            let slips = |run: usize| run % 4 == 1 || run % 16 == 4;
            let cap = |run: usize| slips(run).then_some((0.55, 30.0));
            let found = found(seed, |run| (restless(run), cap(run))).unwrap();
            let Effect::LowAdhesion(LowAdhesion { factor, below_kmh }) = found.effect else { panic!("{found:?}") };
            assert!((factor - 0.55).abs() < 0.02 && (below_kmh - 30.0).abs() < 4.0, "{found:?}");
            let expected: Vec<usize> = (0..32).filter(|run| slips(*run)).collect();
            let wrong = found.runs.iter().filter(|run| !expected.contains(run)).count();
            assert!(wrong == 0 && found.runs.len() + 1 >= expected.len(), "{found:?}");
        }
    }

    #[test]
    fn one_run_alone_is_no_bad_day() {
        for seed in 0..3 {
            let found = found(seed, |run| (Handle::Still(0.98), (run == 5).then_some((0.55, 30.0))));
            assert!(found.is_none(), "{seed}: {found:?}");
        }
    }
}
