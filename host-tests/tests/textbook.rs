//! Is `rundown::filter::ukf` the filter that is printed? The reference implementation is `host_tests::textbook`, Eq.
//! (7)-(18) word for word.
//!
//! With α = 1 both forms round to the last digits and must agree to 1e-9 standard deviations. With α = 0.001 the
//! reference has weights near 1.7e6: it subtracts numbers that agree to six digits or more, so what remains of sixteen
//! digits bounds the comparison, not `rundown` (`reference.rs` shows that against 50 digits).

use host_tests::accuracy::{NOMINAL, train};
use host_tests::prelude::*;
use host_tests::textbook::{self, PlainSpread, Points, Read};
use nalgebra::{SMatrix, SVector};
use proptest::prelude::{ProptestConfig, any, prop_assert, proptest};
use rundown::filter::elimination::FactorColumn;
use rundown::filter::general::{GeneralUkf, System};
use rundown::filter::ukf::{MeasurementModel, Pair, Process, Spread, Ukf};
use rundown::model::line::Line;
use rundown::model::motion::Motion;
use rundown::model::state::SIZE_WITH_GAIN;

const LENGTH_M: f64 = 60_000.0;

/// A new gradient each 130 m, up and down by up to 25 permille.
fn track() -> Track {
    let gradients =
        (0..460_u32).map(|i| Gradient { from_m: 130.0 * f64::from(i), permille: 25.0 * (f64::from(i) * 1.7).sin() });
    Track::try_new(LENGTH_M, gradients).unwrap()
}

/// What differs from run to run of the comparison.
#[derive(Clone, Copy, Debug)]
struct Case {
    shape: PlainSpread,
    /// Acceleration noise, m/s².
    noise_mps2: f64,
    reuse_points: bool,
    direction: Direction,
    evaluate: Evaluate,
    /// Leaves out each 3rd location, each 4th speed and now and then both.
    gaps: bool,
    /// The reference begins each step from our belief, not from its own: no error of its own is carried on.
    each_step_from_ours: bool,
    /// Initial standard deviations.
    sd: [f64; SIZE],
}

const WIDE: PlainSpread = PlainSpread { alpha: 1.0, beta: 2.0, kappa: -2.0 };
/// Uncertain enough to make speed, resistance and gradient curve within the points.
const UNCERTAIN: [f64; SIZE] = [20.0, 0.5, 1e-3, 3e-5, 4e-6];
const CASE: Case = Case {
    shape: WIDE,
    noise_mps2: 0.0,
    reuse_points: false,
    direction: Direction::Up,
    evaluate: Evaluate::Beginning,
    gaps: false,
    each_step_from_ours: false,
    sd: UNCERTAIN,
};

/// Largest differences over a run, in posterior standard deviations: mean, covariance, innovation.
#[derive(Clone, Copy, Debug, Default)]
struct Difference {
    mean: f64,
    covariance: f64,
    innovation: f64,
}

impl Difference {
    fn largest(self) -> f64 {
        self.mean.max(self.covariance).max(self.innovation)
    }

    fn add<const N: usize>(&mut self, ours: &Gaussian<N>, reference: &Gaussian<N>) {
        for i in 0..N {
            let error = (ours.mean[i] - reference.mean[i]).abs() / reference.sd(i);
            self.mean = worst(self.mean, error);
            for j in 0..N {
                let error = ours.covariance[(i, j)] - reference.covariance[(i, j)];
                let error = error.abs() / (reference.sd(i) * reference.sd(j));
                self.covariance = worst(self.covariance, error);
            }
        }
    }
}

/// As `max`, but NaN wins.
fn worst(a: f64, b: f64) -> f64 {
    if b > a || b.is_nan() { b } else { a }
}

/// One step of the reference with the readings that are there.
fn reference_step<const N: usize>(
    case: &Case,
    belief: &Gaussian<N>,
    f: impl Fn(&SVector<f64, N>) -> SVector<f64, N>,
    q: &SMatrix<f64, N, N>,
    z: [Option<f64>; 2],
    variance: [f64; 2],
) -> (Gaussian<N>, [f64; 2]) {
    let read =
        |component: usize| Read { component, value: z[component].unwrap_or(f64::NAN), variance: variance[component] };
    let reuse = case.reuse_points;
    match z {
        [Some(_), Some(_)] => {
            let step = textbook::step(case.shape, belief, f, q, reuse, &[read(0), read(1)]).unwrap();
            (step.posterior, step.innovation.into())
        }
        [None, None] => {
            let step = textbook::step::<N, 0>(case.shape, belief, f, q, reuse, &[]).unwrap();
            (step.posterior, [0.0; 2])
        }
        [location, _] => {
            let component = if location.is_some() { LOCATION } else { SPEED };
            let step = textbook::step(case.shape, belief, f, q, reuse, &[read(component)]).unwrap();
            let mut innovation = [0.0; 2];
            innovation[component] = step.innovation[0];
            (step.posterior, innovation)
        }
    }
}

/// Both filters over 90 steps.
fn compare<const N: usize>(case: &Case, begin: Gaussian<N>) -> Difference {
    let (train, track) = (train(), track());
    let line = Line { train: &train, track: &track, direction: case.direction };
    let PlainSpread { alpha, beta, kappa } = case.shape;
    let ukf =
        Ukf { spread: Spread::try_new(alpha, beta, kappa).unwrap(), gate: [None; 2], reuse_points: case.reuse_points };
    let variance = [16.0, 1.0 / (3.6 * 3.6)];
    let observation = LocationAndSpeed { location_variance: variance[0], speed_variance: variance[1] };
    let mut rng = rand_chacha::ChaCha8Rng::seed_from_u64(7);
    let mut truth = begin.mean;
    let (mut ours, mut theirs) = (begin, begin);
    let mut difference = Difference::default();
    for k in 0..90 {
        // Speeds up, holds, coasts, brakes; not the same time at each step.
        let dt_s = [10.0, 10.0, 7.0, 12.0][k % 4];
        let effort = [0.15, 0.05, 0.0, -0.1][k / 5 % 4];
        truth = textbook::Motion::new(line, &truth, effort, dt_s, case.evaluate).advance(&truth);
        truth[SPEED] = truth[SPEED].max(5.0);
        let noisy = |x: f64, sd: f64, rng: &mut rand_chacha::ChaCha8Rng| Some(x + sd * rng.random_range(-1.7..1.7));
        let mut z = [noisy(truth[LOCATION], 4.0, &mut rng), noisy(truth[SPEED], 0.28, &mut rng)];
        if case.gaps {
            z[0] = z[0].filter(|_| k % 3 != 0);
            z[1] = z[1].filter(|_| k % 4 != 0);
        }
        let motion = Motion::new(&line, &ours.mean, effort, dt_s, case.evaluate).with_noise(case.noise_mps2);
        if case.each_step_from_ours {
            theirs = ours;
        }
        let found = ukf.step(&mut ours, &motion, &observation, &z).unwrap();
        // Whole metres: taking them off and putting them back costs no digit.
        let origin_m = theirs.mean[LOCATION].round();
        let motion = textbook::Motion::new(line, &theirs.mean, effort, dt_s, case.evaluate).seen_from(origin_m);
        let q = motion.noise(case.noise_mps2);
        theirs.mean[LOCATION] -= origin_m;
        let z = [z[0].map(|m| m - origin_m), z[1]];
        let (next, innovation) = reference_step(case, &theirs, |x| motion.advance(x), &q, z, variance);
        theirs = next;
        theirs.mean[LOCATION] += origin_m;
        difference.add(&ours, &theirs);
        for i in 0..2 {
            let error = (found.value[i] - innovation[i]).abs() / variance[i].sqrt();
            difference.innovation = worst(difference.innovation, error);
        }
    }
    difference
}

fn begin(case: &Case) -> Gaussian<SIZE> {
    let location_m = match case.direction {
        Direction::Up => 500.0,
        Direction::Down => LENGTH_M - 500.0,
    };
    Gaussian::independent([location_m, 20.0, NOMINAL.r0, NOMINAL.r1, NOMINAL.r2], case.sd)
}

fn agrees(case: &Case, tolerance_sd: f64) {
    let difference = compare(case, begin(case));
    println!("{difference:?} {case:?}");
    assert!(difference.largest() < tolerance_sd, "{difference:?} {case:?}");
}

/// Every combination of Q, direction, midway evaluation and missing readings; points redrawn and, with Q = 0, reused.
fn combinations(shape: PlainSpread) -> Vec<Case> {
    let mut cases = Vec::new();
    for (noise_mps2, reuse_points) in [(0.0, true), (0.0, false), (0.02, false), (0.02, true)] {
        for direction in [Direction::Up, Direction::Down] {
            for evaluate in [Evaluate::Beginning, Evaluate::Midway] {
                for gaps in [false, true] {
                    cases.push(Case {
                        shape,
                        noise_mps2,
                        reuse_points,
                        direction,
                        evaluate,
                        gaps,
                        each_step_from_ours: shape.alpha < 0.01,
                        sd: UNCERTAIN,
                    });
                }
            }
        }
    }
    cases
}

#[test]
fn wide_points_agree_to_1e_9_sd() {
    for case in combinations(WIDE) {
        agrees(&case, 1e-9);
    }
}

#[test]
fn alpha_beta_and_kappa_enter_as_printed() {
    for alpha in [0.3, 1.0, 1.5] {
        for beta in [0.0, 2.0] {
            for kappa in [-4.0, -2.0, 0.0, 3.0] {
                let shape = PlainSpread { alpha, beta, kappa };
                agrees(&Case { shape, ..CASE }, 1e-8);
            }
        }
    }
}

/// The reference loses here: it sums numbers x with weights of 1.7e6 that cancel to 1, so a step of it is good to about
/// 1.7e6 · 1.1e-16 · |x| / sd, which is 1e-8 sd for a speed of 30 m/s known to 0.5 m/s, and ten to a hundred times that
/// where few digits of a mean are uncertain. So each step begins from our belief, and locations are counted from near
/// the train: then it reaches 3e-6 sd. What accumulates over a run is compared with 50 digits, by `reference.rs`.
#[test]
fn points_of_table_1_agree_as_far_as_the_reference_reaches() {
    let shape = PlainSpread { alpha: 1e-3, ..WIDE };
    for case in combinations(shape) {
        agrees(&case, 1e-5);
    }
}

/// The standard deviations of Table 1 too: 0.0005 m/s beside 30 m/s, which leaves the reference 1e-4 sd in one step.
#[test]
fn table_1_agrees_as_far_as_the_reference_reaches() {
    let sd = [1.0, 0.0005, 1e-6, 1e-8, 1e-9];
    agrees(&Case { sd, reuse_points: true, ..CASE }, 1e-9);
    let shape = PlainSpread { alpha: 1e-3, ..WIDE };
    agrees(&Case { sd, shape, reuse_points: true, each_step_from_ours: true, ..CASE }, 1e-3);
}

#[test]
fn the_gain_of_a_measured_effort_is_a_constant_like_the_others() {
    for evaluate in [Evaluate::Beginning, Evaluate::Midway] {
        let case = Case { evaluate, ..CASE };
        let mut sd = [0.03; SIZE_WITH_GAIN];
        sd[..SIZE].copy_from_slice(&UNCERTAIN);
        let mean = [500.0, 20.0, NOMINAL.r0, NOMINAL.r1, NOMINAL.r2, 1.0];
        let difference = compare(&case, Gaussian::independent(mean, sd));
        assert!(difference.largest() < 1e-9, "{difference:?}");
    }
}

/// A pendulum whose length is estimated: nothing enters linearly, and what the pairs see is taken from differences of
/// a.
struct Pendulum {
    dt_s: f64,
    q: f64,
}

impl Process<3, 3> for Pendulum {
    fn drive(&self, x: &SVector<f64, 3>) -> f64 {
        -9.81 / x[2] * x[0].sin() - 0.1 * x[1] * x[1].abs()
    }

    fn slope(&self, _: &SVector<f64, 3>) -> SVector<f64, 3> {
        SVector::zeros()
    }

    fn pair(&self, x: &SVector<f64, 3>, column: &FactorColumn<3, 3>, c: f64) -> Pair {
        let root = (c * column.d).sqrt();
        let (ahead, behind) = (self.drive(&(x + column.l * root)), self.drive(&(x - column.l * root)));
        Pair { odd: (ahead - behind) / (2.0 * root), even: (ahead + behind - 2.0 * self.drive(x)) / (2.0 * c) }
    }

    fn carry(&self, x: &SVector<f64, 3>, a: f64) -> SVector<f64, 3> {
        let rate = x[1] + self.dt_s * a;
        SVector::from([x[0] + self.dt_s * rate, rate, x[2] + 0.01 * x[0]])
    }

    fn noise_variance(&self) -> f64 {
        self.q
    }
}

/// Rate before angle: a reading's number is not its component's.
struct RateAndAngle;

impl MeasurementModel<2> for RateAndAngle {
    const COMPONENTS: [usize; 2] = [1, 0];

    fn variance(&self, i: usize) -> f64 {
        [0.04, 0.01][i]
    }
}

#[test]
fn a_motion_without_constants_is_filtered_as_printed() {
    for (q, reuse_points) in [(0.0, true), (1.0, true), (1.0, false)] {
        let pendulum = Pendulum { dt_s: 0.1, q };
        let b = pendulum.carry(&SVector::zeros(), 1.0);
        let q = b * b.transpose() * q;
        let case = Case { reuse_points, ..CASE };
        let ukf = Ukf::<3, 2> { spread: Spread::WIDE, gate: [None; 2], reuse_points };
        let mut truth = SVector::from([0.8, 0.0, 1.0]);
        let begin = Gaussian::independent([0.7, 0.2, 1.2], [0.1, 0.2, 0.2]);
        let (mut ours, mut theirs) = (begin, begin);
        let mut difference = Difference::default();
        for k in 0..60 {
            truth = pendulum.advance(&truth);
            let z = [(k % 5 != 0).then_some(truth[0]), (k % 3 != 0).then_some(truth[1])];
            ukf.step(&mut ours, &pendulum, &RateAndAngle, &[z[1], z[0]]).unwrap();
            let f = |x: &SVector<f64, 3>| pendulum.advance(x);
            theirs = reference_step(&case, &theirs, f, &q, z, [0.01, 0.04]).0;
            difference.add(&ours, &theirs);
        }
        println!("{difference:?}");
        assert!(difference.largest() < 1e-9, "{difference:?} {case:?}");
    }
}

/// The printed motion of a train with its readings, as a system like any other.
struct Train<'a> {
    motion: textbook::Motion<'a>,
    noise_mps2: f64,
    observation: LocationAndSpeed,
}

impl System<SIZE, 2> for Train<'_> {
    fn next(&self, x: &SVector<f64, SIZE>) -> SVector<f64, SIZE> {
        self.motion.advance(x)
    }

    fn process_noise(&self) -> SMatrix<f64, SIZE, SIZE> {
        self.motion.noise(self.noise_mps2)
    }

    fn expected(&self, x: &SVector<f64, SIZE>) -> SVector<f64, 2> {
        [x[LOCATION], x[SPEED]].into()
    }

    fn reading_noise(&self) -> SMatrix<f64, 2, 2> {
        SMatrix::from_diagonal(&[self.observation.location_variance, self.observation.speed_variance].into())
    }
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]

    /// Both forms stand for any train that moves, in each step of a run.
    #[test]
    fn the_general_filter_and_the_fast_one_are_one(
        alpha in 0.3..1.5,
        beta in 0.0..3.0,
        kappa in -4.0..3.0,
        noise_mps2 in 0.0..0.05,
        speed_mps in 10.0..50.0,
        doubt in 0.1..1.5,
        is_midway in any::<bool>(),
        is_up in any::<bool>(),
        efforts in proptest::collection::vec(-0.05..0.15, 20),
        lost in proptest::collection::vec((any::<bool>(), any::<bool>()), 20),
    ) {
        let (train, track) = (train(), track());
        let direction = if is_up { Direction::Up } else { Direction::Down };
        let evaluate = if is_midway { Evaluate::Midway } else { Evaluate::Beginning };
        let line = Line { train: &train, track: &track, direction };
        let spread = Spread::try_new(alpha, beta, kappa).unwrap();
        let fast = Ukf { spread, gate: [None; 2], reuse_points: false };
        let general = GeneralUkf { spread };
        let observation = LocationAndSpeed { location_variance: 16.0, speed_variance: 1.0 / (3.6 * 3.6) };
        let mut begin = begin(&Case { direction, sd: UNCERTAIN.map(|sd| doubt * sd), ..CASE });
        begin.mean[SPEED] = speed_mps;
        let (mut ours, mut theirs) = (begin, begin);
        let mut difference = Difference::default();
        for (effort, (no_location, no_speed)) in efforts.into_iter().zip(lost) {
            let motion = Motion::new(&line, &ours.mean, effort, 10.0, evaluate).with_noise(noise_mps2);
            let z = [
                (!no_location).then_some(ours.mean[LOCATION] + direction.sign() * 10.0 * ours.mean[SPEED] + 3.0),
                (!no_speed).then_some(speed_mps),
            ];
            let printed = textbook::Motion::new(line, &theirs.mean, effort, 10.0, evaluate);
            let system = Train { motion: printed, noise_mps2, observation };
            let innovation = general.step(&mut theirs, &system, &z).unwrap();
            let found = fast.step(&mut ours, &motion, &observation, &z).unwrap();
            difference.add(&ours, &theirs);
            let [theirs_is, ours_is] = [innovation.log_likelihood(), found.log_likelihood()];
            prop_assert!((theirs_is - ours_is).abs() < 1e-10 * (1.0 + ours_is.abs()), "{theirs_is} {ours_is}");
            // No error of one step is carried on.
            theirs = ours;
        }
        prop_assert!(difference.largest() < 1e-10, "{:?}", difference);
    }
}

/// The reference implementation itself: weights of Eq. (9) for Table 1, and points that give back what they were drawn
/// from.
#[test]
fn the_reference_has_the_weights_of_the_paper() {
    let shape = PlainSpread { alpha: 1e-3, ..WIDE };
    let (lambda, w0_mean, w0_covariance, w) = textbook::weights(shape, SIZE);
    assert!((lambda + 4.999_997).abs() < 1e-12);
    assert!((w0_mean + 1_666_665.67).abs() < 0.01 && (w - 166_666.67).abs() < 0.01);
    let (mean, covariance, others) = Spread::<SIZE>::PAPER.weights();
    let relative = |a: f64, b: f64| (a / b - 1.0).abs();
    // The reference forms L + λ from λ and keeps ten digits of it; `Spread` does not.
    assert!(relative(mean, w0_mean) < 1e-9 && relative(covariance, w0_covariance) < 1e-9);
    assert!(relative(others, w) < 1e-9);

    let begin = begin(&CASE);
    let back = Points::new(WIDE, &begin).unwrap().statistics(WIDE);
    let mut difference = Difference::default();
    difference.add(&back, &begin);
    assert!(difference.largest() < 1e-9, "{difference:?}");
}
