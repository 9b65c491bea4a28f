//! What always holds, whatever comes in.

use host_tests::accuracy::train;
use host_tests::prelude::*;
use host_tests::textbook::{PlainSpread, Points};
use nalgebra::{SMatrix, SVector, Vector2};
use proptest::prelude::*;
use rundown::filter::elimination::FactorColumn;
use rundown::filter::ukf::{Pair, Process, Spread, Ukf};
use rundown::model::line::Line;
use rundown::model::motion::Motion;
use rundown::tick::regime::{PaperRule, Regime};

fn track(steps: &[(f64, f64)]) -> Track {
    let mut from_m = 0.0;
    let gradients = steps.iter().map(|&(length_m, permille)| {
        from_m += length_m;
        Gradient { from_m, permille }
    });
    Track::try_new(20_000.0, gradients.collect::<Vec<_>>()).unwrap()
}

fn steps() -> impl Strategy<Value = Vec<(f64, f64)>> {
    prop::collection::vec((1.0..800.0, -40.0..40.0), 0..40)
}

fn direction() -> impl Strategy<Value = Direction> {
    prop_oneof![Just(Direction::Up), Just(Direction::Down)]
}

/// A A' + a little, with standard deviations near one.
fn covariance<const N: usize>(entries: &[f64]) -> SMatrix<f64, N, N> {
    let a = SMatrix::<f64, N, N>::from_fn(|i, j| entries[i * N + j]);
    a * a.transpose() + SMatrix::identity() * 0.05
}

fn symmetric_and_positive<const N: usize>(p: &SMatrix<f64, N, N>) -> bool {
    // Scaled to ones on the diagonal first: the units of s and r2 are ten decades apart.
    let sd = SVector::<f64, N>::from_fn(|i, _| p[(i, i)].sqrt());
    let correlation = SMatrix::<f64, N, N>::from_fn(|i, j| p[(i, j)] / (sd[i] * sd[j]));
    *p == p.transpose() && host_tests::textbook::cholesky(&(correlation + SMatrix::identity() * 1e-9)).is_some()
}

/// A linear motion without constants: x' = T x + b (g·x + noise).
struct Linear {
    t: SMatrix<f64, 3, 3>,
    b: SVector<f64, 3>,
    g: SVector<f64, 3>,
    q: f64,
}

impl Process<3, 3> for Linear {
    fn drive(&self, x: &SVector<f64, 3>) -> f64 {
        self.g.dot(x)
    }
    /// Not the slope of all of it: the rest is left to the pairs, as a motion may.
    fn slope(&self, _: &SVector<f64, 3>) -> SVector<f64, 3> {
        SVector::from([self.g[0], 0.0, 0.0])
    }
    fn pair(&self, _: &SVector<f64, 3>, column: &FactorColumn<3, 3>, _: f64) -> Pair {
        let odd = self.g[1] * column.l[1] + self.g[2] * column.l[2];
        Pair { odd, even: 0.0 }
    }
    fn carry(&self, x: &SVector<f64, 3>, a: f64) -> SVector<f64, 3> {
        self.t * x + self.b * a
    }
    fn noise_variance(&self) -> f64 {
        self.q
    }
}

fn finite(estimate: &Estimate) -> bool {
    let mut numbers = vec![estimate.time_s, estimate.dt_s, estimate.gradient_n_per_kg];
    numbers.extend(estimate.effort_n_per_kg);
    numbers.extend(estimate.acceleration_mps2);
    if let Some(innovation) = &estimate.innovation {
        numbers.extend(innovation.value.iter().chain(innovation.covariance.iter()));
        numbers.extend([innovation.log_likelihood(), innovation.distance_squared()]);
    }
    estimate.belief.is_finite() && numbers.iter().all(|number| number.is_finite())
}

/// Numbers as a broken recorder sends them, among ordinary ones.
fn hostile(ordinary: std::ops::Range<f64>) -> impl Strategy<Value = Option<f64>> {
    prop_oneof![
        6 => ordinary.prop_map(Some),
        1 => Just(None),
        1 => prop::sample::select(vec![f64::NAN, f64::INFINITY, f64::NEG_INFINITY, 1e300, -1e300, f64::MIN_POSITIVE, -0.0, 0.0]).prop_map(Some),
    ]
}

fn measurement_step() -> impl Strategy<Value = (f64, Measurement)> {
    let dt = prop_oneof![
        8 => 0.5..20.0,
        1 => prop::sample::select(vec![0.0, -5.0, f64::NAN, f64::INFINITY, 1e-9, 1e-300, 599.0, 700.0, 1e6, 1e300]),
    ];
    (dt, hostile(0.0..21_000.0), hostile(0.0..60.0), hostile(-1.0..1.0)).prop_map(
        |(dt_s, location_m, speed_mps, effort_n_per_kg)| {
            let measurement = Measurement { time_s: 0.0, location_m, speed_mps, effort_n_per_kg };
            (dt_s, measurement)
        },
    )
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 200, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn covariance_stays_symmetric_and_positive(
        steps in steps(), direction in direction(), paper_spread in any::<bool>(),
        efforts in prop::collection::vec(-0.3..0.3, 30), noise_mps2 in prop_oneof![Just(0.0), 0.0..0.1],
        reuse_points in any::<bool>(), seen in prop::collection::vec((any::<bool>(), any::<bool>()), 30),
    ) {
        let (train, track) = (train(), track(&steps));
        let line = Line { train: &train, track: &track, direction };
        let mut belief = Gaussian::independent([8000.0, 25.0, 7.38e-3, 1.6e-4, 2.8e-5], [5.0, 0.5, 1e-3, 2e-5, 3e-6]);
        let ukf = Ukf { spread: if paper_spread { Spread::PAPER } else { Spread::WIDE }, gate: [None; 2], reuse_points };
        let observation = LocationAndSpeed { location_variance: 16.0, speed_variance: 0.08 };
        for (effort, (location, speed)) in efforts.iter().zip(&seen) {
            let motion = Motion::new(&line, &belief.mean, *effort, 10.0, Evaluate::Beginning).with_noise(noise_mps2);
            let z = [location.then_some(belief.mean[0] + 5.0), speed.then_some(belief.mean[1].max(1.0))];
            ukf.step(&mut belief, &motion, &observation, &z).unwrap();
            prop_assert!(symmetric_and_positive(&belief.covariance), "{}", belief.covariance);
        }
    }

    #[test]
    fn sigma_points_give_back_mean_and_covariance(entries in prop::collection::vec(-1.0..1.0, SIZE * SIZE), mean in prop::array::uniform5(-10.0..10.0)) {
        let belief = Gaussian::<SIZE> { mean: SVector::from(mean), covariance: covariance(&entries) };
        for alpha in [1e-3, 0.3, 1.0] {
            let shape = PlainSpread { alpha, beta: 2.0, kappa: -2.0 };
            let back = Points::new(shape, &belief).unwrap().statistics(shape);
            // Weights of 1.7e6 take ten digits from the printed sums at alpha = 0.001.
            let tolerance = if alpha < 0.01 { 1e-5 } else { 1e-11 };
            prop_assert!((back.mean - belief.mean).amax() < tolerance);
            prop_assert!((back.covariance - belief.covariance).amax() < tolerance);
        }
    }

    /// An identity motion through the filter itself: mean and covariance come back, at alpha = 0.001 too.
    #[test]
    fn linear_model_equals_the_closed_kalman_form(
        p in prop::collection::vec(-1.0..1.0, 9), t in prop::collection::vec(-1.0..1.0, 9), b in prop::array::uniform3(-1.0..1.0),
        g in prop::array::uniform3(-1.0..1.0), q in 0.0..0.5,
        mean in prop::array::uniform3(-5.0..5.0), z in prop::array::uniform2(-5.0..5.0), variance in prop::array::uniform2(0.05..4.0),
        alpha in prop_oneof![Just(1e-3), Just(1.0)],
    ) {
        let linear = Linear { t: SMatrix::from_fn(|i, j| t[3 * i + j]), b: SVector::from(b), g: SVector::from(g), q };
        let begin = Gaussian::<3> { mean: SVector::from(mean), covariance: covariance(&p) };
        let observation = LocationAndSpeed { location_variance: variance[0], speed_variance: variance[1] };
        let ukf = Ukf { spread: Spread::try_new(alpha, 2.0, -2.0).unwrap(), gate: [None; 2], reuse_points: false };
        let mut ours = begin;
        let innovation = ukf.step(&mut ours, &linear, &observation, &z.map(Some)).unwrap();

        let f = linear.t + linear.b * linear.g.transpose();
        let prior_mean = f * begin.mean;
        let prior = f * begin.covariance * f.transpose() + linear.b * linear.b.transpose() * q;
        let mut s = prior.fixed_view::<2, 2>(0, 0).into_owned();
        s[(0, 0)] += variance[0];
        s[(1, 1)] += variance[1];
        let inverse = s.try_inverse().unwrap();
        let gain = prior.fixed_columns::<2>(0) * inverse;
        let nu = Vector2::from(z) - prior_mean.fixed_rows::<2>(0);
        let mean = prior_mean + gain * nu;
        let covariance = prior - gain * s * gain.transpose();
        let distance = (nu.transpose() * inverse * nu)[0];
        let log_likelihood = -0.5 * (distance + (std::f64::consts::TAU * std::f64::consts::TAU * s.determinant()).ln());
        prop_assert!((ours.mean - mean).amax() < 1e-10);
        prop_assert!((ours.covariance - covariance).amax() < 1e-10);
        prop_assert!((innovation.covariance - s).amax() < 1e-10 && (innovation.value - nu).amax() < 1e-10);
        prop_assert!((innovation.distance_squared() - distance).abs() < 1e-8 * (1.0 + distance));
        prop_assert!((innovation.log_likelihood() - log_likelihood).abs() < 1e-8 * (1.0 + distance));
    }

    #[test]
    fn regime_bands_partition_the_plane(effort in -0.5..0.5, acceleration in -0.5..0.5, edge in 0..3_usize) {
        let rule = PaperRule::default();
        let effort = [effort, 0.025_f64.copysign(effort), effort][edge];
        let acceleration = [acceleration, acceleration, 0.06_f64.copysign(acceleration)][edge];
        let coast = effort.abs() <= 0.025;
        let cruise = !coast && acceleration.abs() < 0.06;
        let holds = [
            (Regime::Standstill, false),
            (Regime::Traction, !coast && !cruise && effort > 0.0),
            (Regime::Cruise, cruise),
            (Regime::Coast, coast),
            (Regime::Brake, !coast && !cruise && effort < 0.0),
        ];
        prop_assert_eq!(holds.iter().filter(|(_, holds)| *holds).count(), 1);
        prop_assert!(holds.contains(&(rule.recognise(effort, acceleration), true)));
    }

    #[test]
    fn mean_gradient_is_the_numeric_average(steps in steps(), direction in direction(), front_m in -300.0..21_000.0, length_m in 1.0..900.0) {
        let track = track(&steps);
        let permille = |at_m: f64| {
            let (mut from_m, mut value) = (0.0, 0.0);
            for (step_m, permille) in &steps {
                from_m += step_m;
                if at_m >= from_m { value = *permille }
            }
            value
        };
        const COUNT: i32 = 4000;
        let sum: f64 = (0..COUNT).map(|i| permille(front_m - direction.sign() * length_m * (f64::from(i) + 0.5) / f64::from(COUNT))).sum();
        let average = direction.sign() * sum / f64::from(COUNT) / 1000.0;
        let found = track.mean_gradient(front_m, length_m, direction);
        // Each break under the train costs the sum at most one sample of 80 permille, half of it on average.
        let breaks = steps.len().min(40) as f64;
        prop_assert!((found - average).abs() < 1e-9 + 0.08 * breaks / f64::from(COUNT), "{found} {average}");
    }

    #[test]
    fn hostile_measurements_never_make_a_number_that_is_none(
        steps in steps(), direction in direction(),
        mode in prop_oneof![Just(Mode::Paper), Just(Mode::Gated), Just(Mode::Measured)],
        run in prop::collection::vec(measurement_step(), 1..80),
    ) {
        let estimator = Estimator::try_new(Config::with_mode(mode), train(), track(&steps)).unwrap();
        let mut vehicle = estimator.new_vehicle();
        let mut state = estimator.begin_run(&vehicle, direction);
        let mut time_s = 0.0;
        for (dt_s, measurement) in &run {
            let at_s = time_s + dt_s;
            if let Ok(estimate) = estimator.step(&mut state, &Measurement { time_s: at_s, ..*measurement }) {
                prop_assert!(at_s > time_s || time_s == 0.0);
                time_s = at_s;
                prop_assert!(finite(&estimate), "{mode:?} {measurement:?} {estimate:?}");
            }
        }
        let summary = estimator.end_run(&mut state, &mut vehicle);
        prop_assert!(summary.run_davis.is_finite() && vehicle.davis().is_finite());
    }

    /// Nothing is learned from what is not believed: neither reading is there, or its time does not go on.
    #[test]
    fn rejected_data_leave_the_resistance_frozen(
        mode in prop_oneof![Just(Mode::Gated), Just(Mode::Measured)],
        bad in prop::collection::vec((prop::sample::select(vec![None, Some(f64::NAN), Some(f64::INFINITY), Some(-1e9), Some(1e9)]),
            prop::sample::select(vec![None, Some(f64::NAN), Some(-3.0), Some(500.0)]), any::<bool>()), 1..60),
    ) {
        let estimator = Estimator::try_new(Config::with_mode(mode), train(), track(&[])).unwrap();
        let mut state = estimator.begin_run(&estimator.new_vehicle(), Direction::Up);
        // Nothing to learn from: a train at its starting place.
        let stand = Measurement { time_s: 0.0, location_m: Some(0.0), speed_mps: Some(0.0), effort_n_per_kg: None };
        let begin = estimator.step(&mut state, &stand).unwrap();
        let mut time_s = 0.0;
        for (location_m, speed_mps, backward) in bad {
            let at_s = if backward { time_s - 1.0 } else { time_s + 10.0 };
            let measurement = Measurement { time_s: at_s, location_m, speed_mps, effort_n_per_kg: Some(0.1) };
            let stepped = estimator.step(&mut state, &measurement);
            prop_assert_eq!(stepped.is_err(), backward);
            if let Ok(estimate) = stepped {
                time_s = at_s;
                prop_assert_eq!(estimate.davis(), begin.davis());
                prop_assert_eq!(estimate.belief.covariance.fixed_view::<3, 3>(2, 2), begin.belief.covariance.fixed_view::<3, 3>(2, 2));
                prop_assert!(!estimate.learning);
            }
        }
    }
}
