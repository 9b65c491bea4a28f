use super::*;
use crate::study::trials::{Missed, Misses, Noise, Pace, Sensitivity, Shaken};
use crate::{study::case::case_study, study::description};

fn train() -> Train {
    description::of(&case_study().unwrap()).unwrap().train
}

fn verdict(claims: &[Claim], needle: &str) -> Verdict {
    let claim = claims.iter().find(|c| c.statement.contains(needle));
    claim.unwrap_or_else(|| panic!("no claim on {needle}")).verdict
}

#[test]
fn without_runs_nothing_is_reproduced_but_what_the_description_says() {
    let claims = claims(&Gathered::default(), &train(), &Trials::default());
    assert!(claims.len() > 20, "{}", claims.len());
    let of_description = ["38 km/h", "0.025 N/kg", "0.06 m/s", "third moment"];
    for claim in &claims {
        let is_one = of_description.iter().any(|n| claim.statement.contains(n));
        let is_reproduced = claim.verdict == Verdict::Reproduced;
        assert_eq!(is_reproduced, is_one, "{}", claim.statement);
    }
    assert_eq!(verdict(&claims, "38 km/h"), Verdict::Reproduced);
}

#[test]
fn on_another_line_only_what_the_method_does_is_judged() {
    let of = |way_m| {
        let mut gathered = Gathered::default();
        gathered.travelled_m.add(way_m);
        gathered.paper.runs = 1;
        [0.0072, 0.0073].into_iter().for_each(|r0| gathered.paper.davis_samples[0].add(r0));
        gathered.paper.r0_in_band = 2;
        claims(&gathered, &train(), &Trials::default())
    };
    let (home, elsewhere) = (of(32_103.0), of(18_000.0));
    assert!(home.iter().all(|claim| claim.verdict != Verdict::Elsewhere));
    for (there, here) in home.iter().zip(&elsewhere) {
        let has_the_papers_train = ["0.00738", "manufacturer overestimates", "one run: traction"]
            .iter()
            .any(|words| there.statement.contains(words));
        let of_the_method =
            there.kind == ClaimKind::Predicted && !has_the_papers_train || there.statement.contains("third moment");
        let expected = if of_the_method { there.verdict } else { Verdict::Elsewhere };
        assert_eq!(here.verdict, expected, "{}", here.statement);
    }
    assert_eq!(verdict(&home, "0.00738"), Verdict::Reproduced);
    assert_eq!(verdict(&elsewhere, "third moment"), Verdict::Reproduced);
    assert!(summary::elsewhere(&elsewhere).starts_with("Of all 50 claims 34 are not judged: "));
    assert_eq!(summary::by_kind(&elsewhere), "input 1 of 1, predicted 1 of 15");
    assert_eq!(summary::elsewhere(&home), "");
}

#[test]
fn a_coefficient_of_variation_is_judged_by_its_margin() {
    let of = |coasts_s: [f64; 3]| {
        let mut gathered = Gathered::default();
        gathered.paper.runs = 3;
        for coast_s in coasts_s {
            gathered.paper.coast_s.add(coast_s);
        }
        verdict(&claims(&gathered, &train(), &Trials::default()), "lengths of the final coast vary by 30")
    };
    assert_eq!(of([210.0, 300.0, 390.0]), Verdict::Reproduced);
    assert_eq!(of([290.0, 300.0, 310.0]), Verdict::Not);
}

#[test]
fn brake_rates_must_rise_towards_low_speeds() {
    let of = |rates: [f64; 5]| {
        let mut gathered = Gathered::default();
        for (moments, rate) in gathered.paper.brake_steps.iter_mut().zip(rates) {
            for _ in 0..10 {
                moments.add(rate);
            }
        }
        verdict(&claims(&gathered, &train(), &Trials::default()), "lower the speed")
    };
    assert_eq!(of([0.20, 0.25, 0.30, 0.32, 0.36]), Verdict::Reproduced);
    assert_eq!(of([0.36, 0.32, 0.30, 0.25, 0.20]), Verdict::Not);
}

#[test]
fn coefficients_that_stay_where_they_are_are_bounded_by_anything() {
    let of = |sd: f64, r0_in_band| {
        let mut gathered = Gathered::default();
        gathered.paper.r0_in_band = r0_in_band;
        [-sd, sd].into_iter().for_each(|off| gathered.paper.davis_samples[0].add(7.3e-3 + off));
        verdict(&claims(&gathered, &train(), &Trials::default()), "besides outliers")
    };
    assert_eq!(
        [of(5e-5, 2), of(5e-7, 2), of(5e-5, 1), of(5e-7, 1)],
        [Verdict::Reproduced, Verdict::NotVisible, Verdict::Not, Verdict::Not]
    );
}

#[test]
fn the_band_of_r0_ends_where_it_is_printed_to_end() {
    let of = |r0: f64| {
        let mut seen = crate::study::view::Seen::default();
        seen.points.davis = vec![[r0, 2e-4, 3e-5]];
        let mut tallies = Tallies::default();
        tallies.add(&seen);
        tallies.r0_in_band
    };
    assert_eq!([of(0.007_384_8), of(0.007_385_2), of(0.007_195_1), of(0.007_194_9)], [1, 0, 1, 0]);
}

/// A run with 30 intervals of power at 50 to 130 km/h.
fn drawn(power_kw: impl Fn(f64) -> f64) -> crate::study::gather::Drawn {
    use crate::study::view::{PowerPoint, Seen};
    let mut seen = Seen::default();
    let point = |index: u32| {
        let speed_kmh = 50.0 + 80.0 * f64::from(index) / 29.0;
        // Off by up to 10 %.
        let off = 0.2 * ((f64::from(index) * 0.618_034).fract() - 0.5);
        PowerPoint {
            speed_kmh,
            power_kw: power_kw(speed_kmh) * (1.0 + off),
            location_m: 0.0,
            dt_s: 10.0,
            follows: true,
        }
    };
    seen.points.power = (0..30).map(point).collect();
    let recording = rundown_files::recording::Recording::default();
    crate::study::gather::Drawn { recording, as_recorded: None, paper: seen.clone(), gated: seen, truth: None }
}

#[test]
fn two_clouds_are_better_than_one_and_on_either_side_of_the_power() {
    let of = |power_kw: &dyn Fn(f64) -> f64| {
        let gathered = Gathered { drawn: (0..5).map(|_| drawn(power_kw)).collect(), ..Gathered::default() };
        verdict(&claims(&gathered, &train(), &Trials::default()), "two clouds")
    };
    let step = |at_kmh: f64, slow: f64, fast: f64| move |kmh: f64| if kmh > at_kmh { fast } else { slow };
    assert_eq!(of(&step(115.0, 1800.0, 2500.0)), Verdict::Reproduced);
    assert_eq!(of(&step(95.0, 1800.0, 2500.0)), Verdict::Not, "they part elsewhere");
    assert_eq!(of(&step(115.0, 1300.0, 1900.0)), Verdict::Not, "both below the manufacturer's");
    assert_eq!(of(&step(115.0, 2500.0, 1800.0)), Verdict::Not, "the wrong way round");
    assert_eq!(of(&|kmh| 18.0 * kmh), Verdict::Not, "one that leans");
    assert_eq!(of(&|_| 2036.0), Verdict::Not, "one");
}

#[test]
fn brakes_that_begin_gentler_do_so_in_more_runs_than_chance_and_in_truth() {
    let of = |found: [u64; 2], was: [u64; 2]| {
        let mut gathered = Gathered::default();
        gathered.truth.runs = 67;
        (gathered.paper.gentle_first, gathered.truth.gentle_first) = (found, was);
        for tallies in [&mut gathered.paper, &mut gathered.truth] {
            tallies.brake_gain_mps2.add(0.04);
        }
        verdict(&claims(&gathered, &train(), &Trials::default()), "begin gentler")
    };
    assert_eq!(of([41, 67], [41, 67]), Verdict::Reproduced);
    assert_eq!(of([40, 67], [41, 67]), Verdict::Not);
    assert_eq!(of([41, 67], [40, 67]), Verdict::Not);
    assert_eq!([of([9, 9], [41, 67]), of([41, 67], [9, 9])], [Verdict::NoData; 2]);
}

#[test]
fn clouds_are_further_apart_than_a_profile_of_the_wrong_sign_makes_them() {
    use rundown::model::track::{Gradient, Track};
    // The faster cloud is drawn on the second half of the line.
    let of = |permille: f64| {
        let mut run = drawn(|kmh| if kmh > 115.0 { 2500.0 } else { 1800.0 });
        for seen in [&mut run.paper, &mut run.gated] {
            for point in &mut seen.points.power {
                point.location_m = if point.speed_kmh > 115.0 { 9000.0 } else { 3000.0 };
            }
        }
        let climb = [Gradient { from_m: 0.0, permille: 0.0 }, Gradient { from_m: 6000.0, permille }];
        let track = Some(Track::try_new(12_000.0, climb).unwrap());
        let gathered = Gathered { drawn: vec![run; 5], track, ..Gathered::default() };
        verdict(&claims(&gathered, &train(), &Trials::default()), "too far apart for an inaccurate gradient")
    };
    // 700 kW at 115 km/h are 6.1 permille of 364 t.
    assert_eq!(
        [of(0.0), of(2.5), of(3.5), of(-3.5)],
        [Verdict::Reproduced, Verdict::Reproduced, Verdict::Not, Verdict::Not]
    );
}

#[test]
fn what_is_missing_of_the_steps_of_the_brake_is_said() {
    let of = |fastest| {
        let mut gathered = Gathered::default();
        for (moments, runs) in gathered.paper.brake_steps.iter_mut().zip([fastest, 7, 12, 12, 12]) {
            (0..runs).for_each(|_| moments.add(0.3));
        }
        claims(&gathered, &train(), &Trials::default())
    };
    let (without, with) = (of(0), of(12));
    for needle in ["lower the speed", "three behaviours"] {
        let claim = without.iter().find(|claim| claim.statement.contains(needle)).unwrap();
        assert_eq!(claim.verdict, Verdict::NoData);
        let said = "of 4 steps that it takes 3 have 10 runs that brake there, missing: above 130 km/h (0) or 130 to 80 km/h (7); ";
        assert!(claim.why.starts_with(said), "{}", claim.why);
    }
    assert_eq!(verdict(&with, "lower the speed"), Verdict::NotVisible, "one step above 80 km/h is enough");
    let alike = with.iter().find(|claim| claim.statement.contains("40 to 80 km/h are alike")).unwrap();
    assert!(alike.why.starts_with("means of both steps"));
}

#[test]
fn slightly_richer_is_visible_and_no_more_than_twice() {
    let of = |way: f64, more_n_per_kg: f64, negative_runs| {
        let still = Shaken { negative_runs: 0, runs: 5, way: 0.1, more_n_per_kg: -1e-5 };
        let drawn = Shaken { negative_runs, runs: 5, way, more_n_per_kg };
        let noise = vec![Noise { sd_mps2: 0.01, q: still, drawn }];
        let trials = Trials { noise, ..Trials::default() };
        verdict(&claims(&Gathered::default(), &train(), &trials), "slightly richer")
    };
    assert_eq!([of(1.2, 2e-5, 0), of(1.2, 2e-6, 0)], [Verdict::Reproduced, Verdict::NotVisible]);
    assert_eq!([of(44.0, 2e-5, 0), of(1.2, 2e-5, 1)], [Verdict::Not; 2]);
}

#[test]
fn steps_of_the_brake_are_alike_in_pairs() {
    let mut gathered = Gathered::default();
    for (moments, rate) in gathered.paper.brake_steps[1..].iter_mut().zip([0.25, 0.30, 0.31, 0.40]) {
        (0..10).for_each(|run| moments.add(rate + 0.01 * f64::from(run)));
    }
    let claims = claims(&gathered, &train(), &Trials::default());
    let of = |needle| verdict(&claims, needle);
    assert_eq!([of("40 to 80 km/h are alike"), of("above 80 km/h are alike")], [Verdict::Reproduced, Verdict::NoData]);
}

#[test]
fn negative_coefficients_are_those_of_the_changed_filter() {
    let of = |printed: usize, negative_runs: [usize; 3]| {
        let found =
            |which, factor, negative_runs| Sensitivity { which, factor, negative_runs, runs: 5, least_share: [0.5; 3] };
        let mut sensitivity = vec![found("r0, r1, r2", 1.0, printed), found("r0, r1, r2", 100.0, 5)];
        let changed = ["r0", "r1", "r2"].into_iter().zip(negative_runs);
        sensitivity.extend(changed.map(|(which, runs)| found(which, 100.0, runs)));
        let trials = Trials { sensitivity, ..Trials::default() };
        verdict(&claims(&Gathered::default(), &train(), &trials), "give negative coefficients")
    };
    assert_eq!(of(0, [5, 1, 1]), Verdict::Reproduced);
    assert_eq!(of(0, [5, 5, 0]), Verdict::Not, "of any coefficient");
    assert_eq!(of(1, [5, 5, 5]), Verdict::Not, "with Table 1, too");
}

#[test]
fn a_slow_filter_and_samples_that_do_no_harm_are_no_reproduction() {
    let of = |step_ms, thinned_s| {
        let misses = |s: f64| {
            let (mut length, mut regimes) = (Moments::default(), Moments::default());
            length.add(s);
            regimes.add(0.01 * s);
            let missed = Missed { lengths_s: [length; 2], regimes };
            Misses { paper: missed, gated: missed }
        };
        let pace = Pace { step_ms, run_s: 1 };
        let trials =
            Trials { pace: Some([pace; 2]), thinned: Some([misses(5.0), misses(thinned_s)]), ..Trials::default() };
        let claims = claims(&Gathered::default(), &train(), &trials);
        ["computation time", "less accurate regimes", "less accurate features"].map(|n| verdict(&claims, n))
    };
    assert_eq!(of(1, 8.0), [Verdict::Reproduced; 3]);
    assert_eq!(of(2_000, 4.0), [Verdict::Not; 3]);
}

#[test]
fn features_are_less_accurate_where_their_errors_grow_together() {
    let of = |[coast_s, brake_s]: [f64; 2]| {
        let misses = |lengths_s: [f64; 2]| {
            let lengths_s = lengths_s.map(|s| std::iter::once(s).collect());
            let missed = Missed { lengths_s, regimes: Moments::default() };
            Misses { paper: missed, gated: missed }
        };
        let thinned = Some([misses([7.0, 3.5]), misses([coast_s, brake_s])]);
        let trials = Trials { thinned, ..Trials::default() };
        verdict(&claims(&Gathered::default(), &train(), &trials), "less accurate features")
    };
    assert_eq!(of([31.0, 3.4]), Verdict::Reproduced);
    assert_eq!(of([6.0, 3.9]), Verdict::NotVisible);
    assert_eq!(of([4.0, 4.5]), Verdict::Not);
}

#[test]
fn a_filter_that_leaves_the_description_as_it_is_estimates_nothing() {
    let of = |error: f64| {
        let mut gathered = Gathered::default();
        gathered.truth.runs = 1;
        gathered.paper.resistance_error2.add(error * error);
        gathered.truth.resistance_error2.add(0.1 * 0.1);
        verdict(&claims(&gathered, &train(), &Trials::default()), "estimates the running resistance")
    };
    assert_eq!([of(0.049), of(0.051), of(0.1)], [Verdict::Reproduced, Verdict::Not, Verdict::Not]);
}

#[test]
fn a_recogniser_that_works_has_nine_of_ten_samples_right() {
    let of = |wrong: usize| {
        let mut misses = Misses::default();
        (0..100).for_each(|index| misses.paper.regimes.add(f64::from(u8::from(index < wrong))));
        let trials = Trials { thinned: Some([misses; 2]), ..Trials::default() };
        verdict(&claims(&Gathered::default(), &train(), &trials), "determined successfully")
    };
    assert_eq!([of(9), of(19)], [Verdict::Reproduced, Verdict::Not]);
}

#[test]
fn nothing_was_put_into_recorded_runs() {
    let of = |paper_runs, true_runs| {
        let mut gathered = Gathered::default();
        (gathered.paper.runs, gathered.truth.runs) = (paper_runs, true_runs);
        summary::counts(&claims(&gathered, &train(), &Trials::default()))
            .into_iter()
            .map(|count| (count.kind, count.claims))
            .collect::<Vec<_>>()
    };
    assert_eq!(of(67, 67), [("input", 12), ("recovered", 20), ("predicted", 18)]);
    // What is left as an input is of the description and the method.
    assert_eq!(of(67, 0), [("input", 7), ("predicted", 18), ("observed", 25)]);
    let mut gathered = Gathered::default();
    gathered.paper.runs = 67;
    let of_recorded = claims(&gathered, &train(), &Trials::default());
    assert!(of_recorded.iter().all(|claim| claim.truth == NOTHING), "nobody knows what is true");
}

#[test]
fn what_was_put_in_must_be_so_in_truth() {
    use Verdict::{Not, NotVisible, Reproduced};
    let of = |was| claim("3", "an order").recovered([Some(Reproduced), was]);
    assert_eq!((of(Some(Reproduced)).kind, of(Some(Reproduced)).verdict), (ClaimKind::Recovered, Reproduced));
    assert_eq!([of(Some(Not)).verdict, of(Some(NotVisible)).verdict], [Not; 2]);
    assert_eq!((of(None).verdict, of(None).why.as_str()), (Reproduced, ""), "of recorded runs nobody knows");
    assert_eq!(claim("3", "an order").recovered([None, Some(Reproduced)]).verdict, Verdict::NoData);
    assert_eq!(of(Some(Verdict::NoData)).verdict, Verdict::NoData, "a truth that says nothing");
    let skewed = |true_kmh: [f64; 3]| {
        let mut gathered = Gathered::default();
        let runs = |kmh: [f64; 3]| (0..9).map(|index| kmh[usize::from(index > 6) + usize::from(index > 7)]).collect();
        gathered.paper.plain_cruise_kmh = runs([138.0, 136.0, 126.0]);
        gathered.truth.plain_cruise_kmh = runs(true_kmh);
        verdict(&claims(&gathered, &train(), &Trials::default()), "cruise speeds are skewed")
    };
    assert_eq!(skewed([138.0, 136.0, 126.0]), Reproduced);
    assert_eq!(skewed([135.5, 137.0, 147.0]), Not, "the true ones lean to the other side");
}

#[test]
fn what_was_put_in_must_be_found_with_a_small_error() {
    let of = |found_s: f64| {
        let mut gathered = Gathered::default();
        (gathered.paper.runs, gathered.truth.runs) = (3, 3);
        for part in [0.7, 1.0, 1.3] {
            gathered.paper.coast_s.add(part * found_s);
            gathered.truth.coast_s.add(part * 300.0);
        }
        let claims = claims(&gathered, &train(), &Trials::default());
        let claim = claims.into_iter().find(|c| c.statement.contains("2.5 to 10 min")).unwrap();
        (claim.kind, claim.verdict, claim.error)
    };
    assert_eq!(of(310.0), (ClaimKind::Recovered, Verdict::Reproduced, "10 s".to_owned()));
    assert_eq!(of(380.0).1, Verdict::Not);
}

#[test]
fn a_direction_is_no_reproduction_where_nobody_could_see_it() {
    let stated = train().davis().r0;
    let of = |below: f64| {
        let mut gathered = Gathered::default();
        gathered.paper.davis_samples[0].add(stated - below);
        verdict(&claims(&gathered, &train(), &Trials::default()), "overestimates")
    };
    assert_eq!(of(5e-5), Verdict::Reproduced);
    assert_eq!(of(5e-7), Verdict::NotVisible);
    assert_eq!(of(-5e-5), Verdict::Not);
}

#[test]
fn the_skewness_of_a_distribution_that_is_one_bar_says_nothing() {
    let davis = train().davis();
    let of = |width: f64| {
        let mut gathered = Gathered::default();
        for (moments, mean) in gathered.paper.davis_samples.iter_mut().zip([davis.r0, davis.r1, davis.r2]) {
            [0.0, 0.0, 0.0, 0.0, -1.0].into_iter().for_each(|part| moments.add(mean * (1.0 + width * part)));
        }
        verdict(&claims(&gathered, &train(), &Trials::default()), "negative skewness")
    };
    assert_eq!([of(0.02), of(0.0002)], [Verdict::Reproduced, Verdict::NotVisible]);
    assert_eq!([of(-0.02), of(-0.0002)], [Verdict::Not, Verdict::NotVisible]);
}

#[test]
fn brake_rates_that_differ_by_less_than_a_printed_digit_do_not_rise() {
    let mut gathered = Gathered::default();
    for (moments, rate) in gathered.paper.brake_steps.iter_mut().zip([0.200, 0.202, 0.204, 0.206, 0.208]) {
        (0..10).for_each(|_| moments.add(rate));
    }
    let claims = claims(&gathered, &train(), &Trials::default());
    assert_eq!(verdict(&claims, "lower the speed"), Verdict::NotVisible);
}

#[test]
fn two_clouds_are_counted_by_run() {
    let of = |inside| {
        let mut gathered = Gathered::default();
        gathered.paper.in_both_clouds = [inside, 67];
        verdict(&claims(&gathered, &train(), &Trials::default()), "all trajectories")
    };
    assert_eq!(of(66), Verdict::Reproduced);
    assert_eq!(of(40), Verdict::Not);
}
