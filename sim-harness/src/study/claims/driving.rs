//! Claims on how trains are driven: sections 4.1, 4.3, 4.4.

use super::{Claim, alone, claim, from_to, mean, near, percent, three};
use crate::study::gather::Gathered;
use crate::study::moments::Moments;
use crate::study::tallies::Tallies;
use crate::study::view::CLOUDS_KMH;
use rundown::model::train::Train;
use rundown_pages::numbers::{NOTHING, number};

/// The paper's bound of cruising, m/s² (section 3.2), and its time between readings, s.
const CRUISE_MPS2: f64 = 0.06;
const INTERVAL_S: f64 = 10.0;
/// Variation of the largest power that readings in whole km/h make where the true one is the same in all runs: measured at 3.6 %.
const READING_CV: f64 = 0.05;
/// Fewer samples say nothing of an ATB-EG step.
const FEWEST_OF_A_STEP: u64 = 10;

/// What follows from the description alone.
pub(super) fn setting(train: &Train) -> [Claim; 3] {
    let d = train.description();
    let transition_kmh = 3.6 * d.max_power_w / d.max_tractive_effort_n;
    let band = 0.025 * train.rotating_mass_kg() / d.max_tractive_effort_n;
    let change_kmh = 3.6 * CRUISE_MPS2 * INTERVAL_S;
    [
        claim(
            "4.1",
            "largest effort and largest power meet around 38 km/h",
            alone(Some(format!("{} km/h", number(transition_kmh, 1)))),
            Some((transition_kmh - 38.0).abs() < 1.0),
            "of the train's description alone; within 1 km/h",
        ),
        claim(
            "3.2",
            "the coasting band of \u{b1}0.025 N/kg is approximately 5 % of the largest effort",
            alone(percent(Some(band))),
            Some((band - 0.05).abs() < 0.005),
            "of the train's description alone; within half a point",
        ),
        claim(
            "3.2",
            "the bound of \u{b1}0.06 m/s\u{b2} neglects changes of speed up to 2 km/h between readings",
            alone(Some(format!("{} km/h", number(change_kmh, 1)))),
            Some((change_kmh - 2.0).abs() < 0.5),
            "of the paper's numbers alone, at 10 s; to the whole km/h of a reading",
        ),
    ]
}

/// What was recorded.
pub(super) fn runs(gathered: &Gathered) -> Claim {
    let runs = gathered.top_kmh.count;
    let (travelled_m, interval_s) = (gathered.travelled_m.mean(), gathered.interval_s.mean());
    let words = |(m, s)| format!("{runs} runs of {} m, a reading every {} s", number(m, 0), number(s, 1));
    let length = near(travelled_m, 32_103.0, 50.0);
    let interval = near(interval_s, INTERVAL_S, 0.1);
    claim(
        "4.1",
        "67 speed profiles on a track of 32 103 m, sampled every 10 s",
        alone(travelled_m.zip(interval_s).map(words)),
        length.zip(interval).map(|(a, b)| a && b && runs == 67),
        "mean from the first to the last location within 50 m, mean time between readings within 0.1 s. Simulated runs are made so",
    )
}

/// Share of the runs with a reading above 140 km/h.
fn over(gathered: &Gathered) -> Option<f64> {
    let runs = gathered.top_kmh.count;
    (runs > 0).then(|| gathered.over_limit as f64 / runs as f64)
}

/// Share of the runs whose true speed was above 140 km/h.
fn truly_over(gathered: &Gathered) -> Option<f64> {
    let runs = gathered.truth.runs;
    (runs > 0).then(|| gathered.truly_over_limit as f64 / runs as f64)
}

pub(super) fn profiles(gathered: &Gathered) -> [Claim; 2] {
    let over = over(gathered);
    let of_runs = |share| percent(share).map(|share| share + " of the runs");
    let coast = |t: &Tallies| t.coast_mps2.variation();
    let brakes = |t: &Tallies| t.brake_steps.iter().filter_map(Moments::variation).reduce(f64::min);
    [
        claim(
            "2",
            "some trains run faster than the 140 km/h of the line",
            [of_runs(over), None, of_runs(truly_over(gathered))],
            over.map(|over| over > 0.0 && over < 0.5),
            "a measured speed above 140 km/h in some runs and in less than half of them",
        ),
        claim(
            "2",
            "decelerations when coasting are significantly similar for all speed profiles",
            three(gathered, |t| percent(coast(t))),
            coast(&gathered.paper).zip(brakes(&gathered.paper)).map(|(coast, brake)| coast < brake),
            "coefficient of variation between runs of the mean deceleration while coasting at 100 to 120 km/h; smaller than that of the brake rates in every step",
        ),
    ]
}

pub(super) fn regimes(gathered: &Gathered) -> [Claim; 2] {
    let shares = |t: &Tallies| {
        let shares: Vec<f64> = t.shares.iter().filter_map(Moments::mean).collect();
        <[f64; 4]>::try_from(shares).ok()
    };
    let words = |shares: [f64; 4]| shares.map(|share| number(100.0 * share, 1)).join(" / ") + "\u{a0}%";
    let columns = || three(gathered, |t| shares(t).map(words));
    let found = shares(&gathered.paper);
    let is_near = |found: [f64; 4]| {
        found.iter().zip([0.164, 0.17, 0.57, 0.093]).all(|(found, paper)| (found - paper).abs() <= 0.10)
    };
    [
        claim(
            "6",
            "one run: traction 16.4 %, cruise 17 %, coast 57 %, brake 9.3 % of the time",
            columns(),
            found.map(is_near),
            "mean over all runs; each within 10 points of the paper's run",
        ),
        claim(
            "6",
            "coasting is the longest phase",
            columns(),
            found.map(|[traction, cruise, coast, brake]| coast > traction.max(cruise).max(brake)),
            "largest mean share. The paper's band of effort also holds steady running below about 81 km/h: the approach at 40 km/h reads as coasting",
        ),
    ]
}

pub(super) fn style(gathered: &Gathered) -> [Claim; 6] {
    let claim = |statement, columns, holds, why| claim("7", statement, columns, holds, why);
    let paper = &gathered.paper;
    let cruise_over = |t: &Tallies| {
        let share = t.cruise_over_limit as f64 / t.cruise_kmh.count as f64;
        percent(Some(share).filter(|share| share.is_finite())).map(|share| format!("cruise above: {share}"))
    };
    let above = |words: &str, share: Option<f64>, cruise: Option<String>| match percent(share) {
        Some(share) => Some(format!("{words} {share}; {}", cruise.as_deref().unwrap_or(NOTHING))),
        None => cruise,
    };
    let [cruise_paper, cruise_gated, cruise_truth] = three(gathered, cruise_over);
    [
        claim(
            "cruise speeds are skewed towards 140 km/h",
            three(gathered, |t| {
                let skewness = number(t.cruise_kmh.skewness(), 2);
                mean(&t.cruise_kmh, 1).map(|mean| format!("mean {mean} km/h, skewness {skewness}"))
            }),
            paper.cruise_kmh.skewness().map(|skewness| skewness < 0.0 && paper.cruise_kmh.mean() > Some(130.0)),
            "negative skewness and a mean above 130 km/h",
        ),
        claim(
            "140 km/h is exceeded in 12 % of the speed profiles",
            [
                above("read above:", over(gathered), cruise_paper),
                cruise_gated,
                above("was above:", truly_over(gathered), cruise_truth),
            ],
            near(over(gathered), 0.12, 0.08),
            "runs with a reading above 140 km/h, within 8 points, the 95 % interval of a share of 67 runs. Read of cruise speeds instead, the share beside it would be meant",
        ),
        claim(
            "the final coast takes 2.5 to 10 min",
            three(gathered, |t| from_to(&t.coast_s, 60.0, 1).map(|text| text + " min")),
            (paper.coast_s.count > 0).then_some(paper.coast_s.least >= 120.0 && paper.coast_s.largest <= 630.0),
            "from 2.0 to 10.5 min in the paper's mode",
        ),
        claim(
            "lengths of the final coast vary by 30 %",
            three(gathered, |t| percent(t.coast_s.variation())),
            near(paper.coast_s.variation(), 0.30, 0.08),
            "coefficient of variation, within 8 points",
        ),
        claim(
            "lengths of the final brake vary by 20 %",
            three(gathered, |t| percent(t.brake_s.variation())),
            near(paper.brake_s.variation(), 0.20, 0.06),
            "coefficient of variation, within 6 points",
        ),
        claim(
            "the final brake is considerably shorter than the coast",
            three(gathered, |t| Some(format!("{} s, coast {} s", mean(&t.brake_s, 0)?, mean(&t.coast_s, 0)?))),
            paper.brake_s.mean().zip(paper.coast_s.mean()).map(|(brake, coast)| brake < 0.5 * coast),
            "mean brake below half of the mean coast",
        ),
    ]
}

pub(super) fn brake(gathered: &Gathered) -> [Claim; 3] {
    let claim = |statement, columns, holds, why| claim("8", statement, columns, holds, why);
    // A step with fewer samples is left out of the verdict.
    let known = |m: &Moments| m.count >= FEWEST_OF_A_STEP;
    let all = |t: &Tallies, of: fn(&Moments) -> Option<f64>| {
        let steps = &t.brake_steps;
        let has = steps.iter().any(known);
        has.then(|| std::array::from_fn(|i| Some(&steps[i]).filter(|m| known(m)).and_then(of)))
    };
    let words = |values: [Option<f64>; 5]| values.map(|v| number(v, 2)).join(" / ") + " m/s\u{b2}";
    let means = |t: &Tallies| all(t, Moments::mean);
    let sds = |t: &Tallies| all(t, Moments::sd);
    // The first and last steps of five: a step between may differ by its own noise.
    let rises = |[a, b, c, d, e]: [Option<f64>; 5]| {
        let above = |high: Option<f64>, low: Option<f64>| Some(high? > low?);
        Some(above(e, b)? && above(d, b)? && above(c, a.or(b))?)
    };
    let alike = |[a, b, c, d, _]: [Option<f64>; 5], sd: [Option<f64>; 5]| {
        let near =
            |x: Option<f64>, y: Option<f64>, sds: [Option<f64>; 2]| Some((x? - y?).abs() < 0.5 * (sds[0]? + sds[1]?));
        let low = near(c, d, [sd[2], sd[3]])?;
        Some(low && near(a, b, [sd[0], sd[1]])?)
    };
    let widest = |sd: [Option<f64>; 5]| {
        let largest = sd.into_iter().flatten().reduce(f64::max)?;
        Some(sd[4]? >= largest)
    };
    let paper = &gathered.paper;
    [
        claim(
            "the lower the speed, the higher the mean brake rate",
            three(gathered, |t| means(t).map(words)),
            means(paper).and_then(rises),
            "means above 130, 130 to 80, 80 to 60, 60 to 40, below 40 km/h; the lower steps above the upper ones; steps of fewer than 10 samples are left out",
        ),
        claim(
            "brake rates vary more at lower speeds, most below 40 km/h",
            three(gathered, |t| sds(t).map(words)),
            sds(paper).and_then(widest),
            "standard deviations of the same steps; the largest below 40 km/h",
        ),
        claim(
            "steps from 40 to 80 km/h are alike, and those above 80 km/h",
            three(gathered, |t| means(t).map(words)),
            means(paper).zip(sds(paper)).and_then(|(m, sd)| alike(m, sd)),
            "means of both pairs nearer than their standard deviation; no data where a step has fewer than 10 samples",
        ),
    ]
}

pub(super) fn power(gathered: &Gathered, train: &Train) -> [Claim; 5] {
    let stated_kw = train.description().max_power_w / 1000.0;
    let claim = |statement, columns, holds, why: String| claim("9", statement, columns, holds, why);
    let paper = &gathered.paper;
    let clouds = |t: &Tallies| t.clouds_kw[0].mean().zip(t.clouds_kw[1].mean());
    let both = |t: &Tallies| {
        let [inside, all] = t.in_both_clouds;
        (all > 0).then(|| inside as f64 / all as f64)
    };
    let varies = |t: &Tallies| t.max_power_kw.variation();
    let largest = |t: &Tallies| (t.max_power_kw.count > 0).then(|| t.max_power_kw.largest / stated_kw);
    let [count_paper, count_gated, _] =
        three(gathered, |t| mean(&t.effort_samples, 1).map(|count| format!("{count} a run")));
    [
        claim(
            "two clouds: below the manufacturer's power up to 115 km/h, above it at higher speeds",
            three(gathered, |t| {
                let (below, above) = clouds(t)?;
                Some(format!("{} kW below {CLOUDS_KMH} km/h, {} kW above", number(below, 0), number(above, 0)))
            }),
            clouds(paper).map(|(below, above)| below < stated_kw && above > stated_kw),
            format!(
                "mean power from 50 km/h on and up to 130 km/h, below and above the manufacturer's {} kW. The paper suspects feeding sections of different power; they appear where the line of these runs has such sections",
                number(stated_kw, 0)
            ),
        ),
        claim(
            "all trajectories have power in both clouds",
            three(gathered, |t| percent(both(t))),
            both(paper).map(|share| share >= 0.95),
            format!("runs with power below the manufacturer's from 50 to {CLOUDS_KMH} km/h and above it from there to 130 km/h; at least 95 %"),
        ),
        claim(
            "the largest power at lower speeds varies much between runs",
            three(gathered, |t| percent(varies(t))),
            varies(paper).map(|cv| cv > READING_CV),
            format!("coefficient of variation of the largest power at 50 to 90 km/h; above the {} % that readings in whole km/h make of one power", number(100.0 * READING_CV, 0)),
        ),
        claim(
            "the manufacturer's power is an accurate upper bound of the largest power at 50 to 90 km/h",
            three(gathered, |t| percent(largest(t))),
            largest(paper).map(|share| (0.95..=1.10).contains(&share)),
            "largest of all runs, as a share of the manufacturer's; 95 to 110 %, for readings in whole km/h add up to 10 %".to_owned(),
        ),
        claim(
            "there are not enough data for the largest tractive effort",
            [count_paper, count_gated, None],
            paper.effort_samples.mean().map(|count| count < 3.0),
            "intervals of continuous acceleration at 10 to 30 km/h; fewer than 3 a run".to_owned(),
        ),
    ]
}
