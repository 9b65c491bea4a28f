//! The line as it really is: heights and speed limits.
//!
//! In: tables of (from_m, value), sorted, piecewise constant until the next entry. Out: mean gradient under a train,
//! limits.
//!
//! ```text
//! mean gradient = (h(front) - h(tail)) / train length        mass spread evenly over the train
//! ```
//!
//! Before the first gradient the line is level; the last gradient and the first and last limit go on.

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, Normal};

/// Length of the case study, m.
const CORRIDOR_LENGTH_M: f64 = 32_103.0;

/// Limits of the case study, (from_m, km/h): 40 km/h up to 900 m, and over the last 250 m plus a platform of 170 m.
const CORRIDOR_LIMITS_KMH: [(f64, f64); 3] = [(0.0, 40.0), (900.0, 140.0), (CORRIDOR_LENGTH_M - 420.0, 40.0)];

/// Gradients of the flat corridor, (from_m, permille). Invented; the ramps of 5 permille are 400 m long.
const CORRIDOR_PERMILLE: [(f64, f64); 36] = [
    (0.0, 0.0),
    (250.0, 0.8),
    (950.0, -1.2),
    (1_900.0, 0.4),
    (2_750.0, 1.6),
    (3_600.0, -0.7),
    (4_400.0, 5.0),
    (4_800.0, 0.0),
    (5_250.0, -5.0),
    (5_650.0, 0.3),
    (6_800.0, -1.9),
    (7_700.0, -0.4),
    (8_900.0, 1.1),
    (9_800.0, 0.0),
    (11_000.0, -5.0),
    (11_400.0, 0.0),
    (12_600.0, 5.0),
    (13_000.0, -0.6),
    (14_100.0, -1.5),
    (15_000.0, 0.9),
    (16_200.0, 2.0),
    (16_900.0, -0.2),
    (18_000.0, -1.0),
    (19_300.0, 0.5),
    (20_500.0, -0.8),
    (21_600.0, 1.3),
    (22_400.0, 5.0),
    (22_800.0, 0.2),
    (23_300.0, -5.0),
    (23_700.0, -0.3),
    (25_000.0, 0.7),
    (26_400.0, -1.7),
    (27_300.0, 0.1),
    (28_800.0, -0.9),
    (30_100.0, 1.4),
    (31_200.0, 0.0),
];

/// Curves of the flat corridor, (from_m, to_m, radius_m). Invented.
const CORRIDOR_CURVES_M: [(f64, f64, f64); 9] = [
    (300.0, 720.0, 420.0),
    (2_100.0, 2_900.0, 1_500.0),
    (6_200.0, 7_300.0, 1_900.0),
    (10_400.0, 11_000.0, 1_200.0),
    (14_600.0, 15_800.0, 2_200.0),
    (19_000.0, 19_900.0, 1_400.0),
    (24_200.0, 25_300.0, 1_700.0),
    (28_700.0, 29_400.0, 1_100.0),
    (31_200.0, 31_700.0, 480.0),
];

/// What lies further than this beyond an end of a line does not matter, m.
const BEYOND_M: f64 = 1e5;

/// Length of the cells in which gradients are looked up, m, and how much of the cell before belongs to each for the
/// rounding of a quotient.
const CELL_M: f64 = 50.0;
const OVERLAP_M: f64 = 1.0;

/// A curve of the line.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Curve {
    /// Where it begins, m.
    pub from_m: f64,
    /// Where it ends, m.
    pub to_m: f64,
    /// Radius, m.
    pub radius_m: f64,
}

/// A line from 0 to its end, where the platform is.
#[derive(Clone, Debug, PartialEq)]
pub struct Line {
    length_m: f64,
    gradients_permille: Vec<(f64, f64)>,
    limits_kmh: Vec<(f64, f64)>,
    heights_m: Vec<f64>,
    // Gradients that have begun where a cell begins: the integrator asks for eight heights a step, and a search for
    // each took half of its time.
    begun_by_cell: Vec<usize>,
    curves: Vec<Curve>,
    calls_m: Vec<f64>,
}

impl Line {
    /// A line from its tables.
    ///
    /// # Panics
    /// If there is no limit, or a table is not sorted.
    pub fn new(length_m: f64, gradients_permille: Vec<(f64, f64)>, limits_kmh: Vec<(f64, f64)>) -> Self {
        assert!(!limits_kmh.is_empty(), "a line needs a speed limit");
        assert!(limits_kmh.is_sorted_by(|a, b| a.0 < b.0), "limits must be sorted");
        assert!(gradients_permille.is_sorted_by(|a, b| a.0 < b.0), "gradients must be sorted");
        let mut heights_m = Vec::with_capacity(gradients_permille.len());
        let mut height_m = 0.0;
        for (i, &(from_m, _)) in gradients_permille.iter().enumerate() {
            if i > 0 {
                let (last_m, permille) = gradients_permille[i - 1];
                height_m += (from_m - last_m) * permille / 1000.0;
            }
            heights_m.push(height_m);
        }
        let cells = (length_m / CELL_M).max(0.0) as usize + 1;
        let begin_m = |cell: usize| cell as f64 * CELL_M - OVERLAP_M;
        let begun = |cell| gradients_permille.partition_point(|g| g.0 <= begin_m(cell));
        Self {
            length_m,
            begun_by_cell: (0..cells).map(begun).collect(),
            gradients_permille,
            limits_kmh,
            heights_m,
            curves: Vec::new(),
            calls_m: Vec::new(),
        }
    }

    /// Replaces the curves, sorted by where they begin. They act only by an effect.
    pub fn set_curves(&mut self, curves: Vec<Curve>) {
        self.curves = curves;
    }

    /// Replaces the stops between both ends at which every run calls, sorted.
    pub fn set_calls(&mut self, calls_m: Vec<f64>) {
        self.calls_m = calls_m;
    }

    /// The same line travelled from its end: what lay at x lies at length - x, uphill becomes downhill.
    pub fn reversed(&self) -> Self {
        let from_end = |at_m: f64| self.length_m - at_m;
        let mut gradients = Vec::new();
        let mut limits = Vec::new();
        // The last entries go on beyond the end.
        gradients.extend(self.gradients_permille.last().map(|g| (-BEYOND_M, -g.1)));
        limits.extend(self.limits_kmh.last().map(|l| (-BEYOND_M, l.1)));
        let pairs = self.gradients_permille.windows(2).rev();
        gradients.extend(pairs.map(|p| (from_end(p[1].0), -p[0].1)));
        let pairs = self.limits_kmh.windows(2).rev();
        limits.extend(pairs.map(|p| (from_end(p[1].0), p[0].1)));
        // Before its first gradient the line is level.
        gradients.extend(self.gradients_permille.first().map(|g| (from_end(g.0), 0.0)));
        let mut reversed = Self::new(self.length_m, gradients, limits);
        reversed.curves = self
            .curves
            .iter()
            .rev()
            .map(|c| Curve { from_m: from_end(c.to_m), to_m: from_end(c.from_m), ..*c })
            .collect();
        reversed.curves.sort_by(|a, b| a.from_m.total_cmp(&b.from_m));
        reversed.calls_m = self.calls_m.iter().rev().map(|m| from_end(*m)).collect();
        reversed
    }

    /// The same line with this many permille more between two locations.
    pub fn with_extra_gradient(&self, from_m: f64, to_m: f64, permille: f64) -> Self {
        let mut edges: Vec<f64> = self.gradients_permille.iter().map(|g| g.0).collect();
        edges.extend([from_m, to_m]);
        edges.sort_by(f64::total_cmp);
        edges.dedup();
        let gradients = edges
            .into_iter()
            .map(|at_m| {
                let described = self.permille(at_m);
                let inside = (from_m..to_m).contains(&at_m);
                (at_m, described + if inside { permille } else { 0.0 })
            })
            .collect();
        Self {
            curves: self.curves.clone(),
            calls_m: self.calls_m.clone(),
            ..Self::new(self.length_m, gradients, self.limits_kmh.clone())
        }
    }

    /// The same line where no more than this is permitted between two locations, km/h.
    pub fn with_restriction(&self, from_m: f64, to_m: f64, kmh: f64) -> Self {
        let limit = |at_m: f64| self.limits_kmh[self.limits_kmh.partition_point(|l| l.0 <= at_m).max(1) - 1].1;
        let mut edges: Vec<f64> = self.limits_kmh.iter().map(|l| l.0).collect();
        edges.extend([from_m, to_m]);
        edges.sort_by(f64::total_cmp);
        edges.dedup();
        let restricted = |at_m: f64| if (from_m..to_m).contains(&at_m) { limit(at_m).min(kmh) } else { limit(at_m) };
        let limits_kmh = edges.into_iter().map(|at_m| (at_m, restricted(at_m))).collect();
        Self { limits_kmh, ..self.clone() }
    }

    fn permille(&self, at_m: f64) -> f64 {
        let begun = self.gradients_permille.partition_point(|g| g.0 <= at_m);
        begun.checked_sub(1).map_or(0.0, |index| self.gradients_permille[index].1)
    }

    /// A level line of this length, one limit.
    pub fn level(length_m: f64, limit_kmh: f64) -> Self {
        Self::new(length_m, vec![(0.0, 0.0)], vec![(0.0, limit_kmh)])
    }

    /// Shaped like the case study: 32 103 m, 140 km/h, 40 km/h at both ends, gradients within 2 permille and six short
    /// ramps of 5.
    pub fn flat_corridor() -> Self {
        let mut line = Self::new(CORRIDOR_LENGTH_M, CORRIDOR_PERMILLE.to_vec(), CORRIDOR_LIMITS_KMH.to_vec());
        line.set_curves(corridor_curves());
        line
    }

    /// Length and limits of the case study with gradients up to 10 permille, drawn from the seed. Level at both
    /// platforms.
    ///
    /// The draw tends back towards the starting height, so that no line climbs all the way.
    pub fn hilly(seed: u64) -> Self {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        let slope = Normal::new(0.0, 6.0).expect("constant");
        let mut gradients = vec![(0.0, 0.0)];
        let (mut at_m, mut height_m) = (600.0, 0.0_f64);
        while at_m < CORRIDOR_LENGTH_M - 1_000.0 {
            let extent_m = rng.random_range(3..=15) as f64 * 100.0;
            let drawn: f64 = slope.sample(&mut rng) - 0.2 * height_m;
            let permille = (drawn.clamp(-10.0, 10.0) * 10.0).round() / 10.0;
            gradients.push((at_m, permille));
            at_m += extent_m;
            height_m += extent_m * permille / 1000.0;
        }
        gradients.push((at_m, 0.0));
        let mut line = Self::new(CORRIDOR_LENGTH_M, gradients, CORRIDOR_LIMITS_KMH.to_vec());
        line.set_curves(corridor_curves());
        line
    }

    /// Location of the platform, m.
    pub fn length_m(&self) -> f64 {
        self.length_m
    }

    /// (from_m, permille), sorted, uphill positive.
    pub fn gradients_permille(&self) -> &[(f64, f64)] {
        &self.gradients_permille
    }

    /// (from_m, km/h), sorted.
    pub fn limits_kmh(&self) -> &[(f64, f64)] {
        &self.limits_kmh
    }

    /// Curves, sorted by where they begin.
    pub fn curves(&self) -> &[Curve] {
        &self.curves
    }

    /// Stops between both ends, sorted, m.
    pub fn calls_m(&self) -> &[f64] {
        &self.calls_m
    }

    /// The highest speed limit, m/s.
    pub fn top_mps(&self) -> f64 {
        self.limits_kmh.iter().map(|l| l.1 / 3.6).fold(0.0, f64::max)
    }

    /// Height above the first entry, m.
    pub fn height_m(&self, location_m: f64) -> f64 {
        match self.begun(location_m) {
            0 => 0.0,
            begun => {
                let (from_m, permille) = self.gradients_permille[begun - 1];
                self.heights_m[begun - 1] + (location_m - from_m) * permille / 1000.0
            }
        }
    }

    /// Number of gradients that begin at or before a location.
    fn begun(&self, location_m: f64) -> usize {
        let gradients = &self.gradients_permille;
        let cell = location_m * (1.0 / CELL_M);
        // What lies before the line is in no cell.
        let known = self.begun_by_cell.get(cell as usize);
        match known.filter(|_| cell >= 0.0) {
            Some(&known) => {
                let rest = gradients[known..].iter();
                known + rest.take_while(|g| g.0 <= location_m).count()
            }
            None => gradients.partition_point(|g| g.0 <= location_m),
        }
    }

    /// Mean gradient (m/m) under a train whose front is at `front_m`.
    pub fn mean_gradient(&self, front_m: f64, train_length_m: f64) -> f64 {
        (self.height_m(front_m) - self.height_m(front_m - train_length_m)) / train_length_m
    }

    /// Lowest limit under the train, m/s: a lower limit counts from its sign on, a higher one when the tail has passed.
    pub fn permitted_mps(&self, front_m: f64, train_length_m: f64) -> f64 {
        let begun = |location_m: f64| self.limits_kmh.partition_point(|l| l.0 <= location_m).max(1);
        let under = &self.limits_kmh[begun(front_m - train_length_m) - 1..begun(front_m)];
        under.iter().map(|l| l.1 / 3.6).fold(f64::INFINITY, f64::min)
    }
}

fn corridor_curves() -> Vec<Curve> {
    let curve = |&(from_m, to_m, radius_m): &(f64, f64, f64)| Curve { from_m, to_m, radius_m };
    CORRIDOR_CURVES_M.iter().map(curve).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn gradients_are_found_by_cell_as_by_search() {
        let flat = Line::flat_corridor();
        let changed = flat.with_extra_gradient(7_123.4, 7_149.999_999_999, 3.0);
        let short = Line::new(30.0, vec![(10.0, 1.0), (12.0, 2.0)], vec![(0.0, 40.0)]);
        let none = Line::new(500.0, Vec::new(), vec![(0.0, 40.0)]);
        for line in [flat.reversed(), flat, changed, Line::hilly(3), short, none] {
            let edges = line.gradients_permille.iter().map(|g| g.0);
            let grid = (-20..700).map(|cell| f64::from(cell) * CELL_M);
            let places = edges.chain(grid).flat_map(|m| [m.next_down(), m, m.next_up(), m + 13.7]);
            for at_m in places.chain([f64::NAN, f64::INFINITY, -f64::INFINITY]) {
                let searched = line.gradients_permille.partition_point(|g| g.0 <= at_m);
                assert_eq!(line.begun(at_m), searched, "{at_m} m");
            }
        }
    }

    #[test]
    fn a_reversed_line_has_the_same_heights_from_the_other_end() {
        for line in [Line::flat_corridor(), Line::hilly(4)] {
            let reversed = line.reversed();
            let offset_m = reversed.height_m(0.0) - line.height_m(line.length_m());
            for at in -10..400 {
                let at_m = f64::from(at) * 100.0 + 7.0;
                let there_m = line.height_m(line.length_m() - at_m);
                assert!((reversed.height_m(at_m) - offset_m - there_m).abs() < 1e-9, "{at_m}");
            }
            let twice = reversed.reversed();
            for at in 0..321 {
                let at_m = f64::from(at) * 100.0 + 7.0;
                assert_eq!(twice.permitted_mps(at_m, 0.0), line.permitted_mps(at_m, 0.0));
            }
            assert_eq!(twice.curves(), line.curves());
        }
        assert_eq!(Line::flat_corridor().reversed().permitted_mps(300.0, 0.0), 40.0 / 3.6);
    }

    #[test]
    fn an_extra_gradient_raises_what_lies_behind_it() {
        let line = Line::flat_corridor();
        let steeper = line.with_extra_gradient(10_000.0, 10_500.0, 4.0);
        for (at_m, raised_m) in [(9_900.0, 0.0), (10_250.0, 1.0), (10_500.0, 2.0), (30_000.0, 2.0)] {
            let found_m = steeper.height_m(at_m) - line.height_m(at_m);
            assert!((found_m - raised_m).abs() < 1e-9, "{at_m}: {found_m}");
        }
    }

    #[test]
    fn half_a_train_on_a_ramp_feels_half_of_it() {
        let line = Line::new(2_000.0, vec![(0.0, 0.0), (500.0, 10.0)], vec![(0.0, 140.0)]);
        assert!((line.mean_gradient(550.0, 100.0) - 0.005).abs() < 1e-15);
    }

    #[test]
    fn a_higher_limit_waits_for_the_tail() {
        let line = Line::flat_corridor();
        assert_eq!(line.permitted_mps(1_061.0, 162.0), 40.0 / 3.6);
        assert_eq!(line.permitted_mps(1_063.0, 162.0), 140.0 / 3.6);
        assert_eq!(line.permitted_mps(31_690.0, 162.0), 40.0 / 3.6);
    }

    #[test]
    fn hilly_lines_stay_within_ten_permille_and_near_their_height() {
        for seed in 0..20 {
            let line = Line::hilly(seed);
            assert!(line.gradients_permille().iter().all(|g| g.1.abs() <= 10.0), "seed {seed}");
            assert!((0..321).all(|i| line.height_m(i as f64 * 100.0).abs() < 60.0), "seed {seed}");
        }
    }
}
