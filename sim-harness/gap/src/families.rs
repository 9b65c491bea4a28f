//! The families of terms among which a search looks.

use super::calibrate::knots;
use super::rows::Row;
use super::scan::{Kind, Scan};
use super::terms::{Context, Coordinate, Side, Term, both_directions, coordinate};
use super::whitening::Whitening;
use std::ops::Range;

/// Most values of a coordinate between which steps are tried: each run's, where there are no more.
const STEPS: usize = 100;
/// Half the width of a steep step, of a day or a degree.
pub const STEEP: f64 = 0.02;
/// Knots at even speeds.
const EVEN: usize = 12;
/// A family of terms: which shapes there are.
#[derive(Clone, Debug)]
pub enum Family {
    /// Some shapes to try.
    Shapes(Vec<Term>),
    /// A section of the line.
    Section(Box<Scan>),
    /// A length of the train; its coefficient is 1.
    Length,
    /// A steady wind, linearised where it is.
    Wind,
    /// The runs in which a brake drags.
    Dragging,
}

/// All families that these data can show. `measured`: with an effort column.
pub fn families(context: &Context<'_>, rows: &[Row], whitening: &Whitening, measured: bool) -> Vec<Family> {
    let kmh = |v: f64| v / 3.6;
    let mut families = vec![
        // r1 alone is what a one-way wind looks like, and no way in which a description goes wrong.
        Family::Shapes(
            [[true, false, false], [false, false, true], [true, false, true], [true, true, true]]
                .map(Term::Davis)
                .to_vec(),
        ),
        Family::Shapes(vec![Term::Cube]),
        Family::Wind,
        Family::Shapes([60.0, 120.0, 200.0, 300.0, 450.0, 700.0, 1000.0].map(Term::WarmUp).to_vec()),
        Family::Length,
        Family::Dragging,
    ];
    for kind in [Kind::Tunnel, Kind::Gradient] {
        families.push(Family::Section(Box::new(Scan::new(kind, context, rows, whitening))));
    }
    if both_directions(rows) {
        families.push(Family::Section(Box::new(Scan::new(Kind::Bump, context, rows, whitening))));
    }
    if !context.curves.is_empty() {
        families.push(Family::Shapes(vec![Term::Curve]));
    }
    // In coasting it is a wrong r2, and so a rival of that.
    families.push(Family::Shapes(vec![Term::Mass]));
    if measured {
        families.push(Family::Shapes(vec![Term::Gauge]));
        families.push(Family::Shapes([20.0, 40.0, 60.0, 80.0, 100.0].map(|v| Term::BrakeFade(kmh(v))).to_vec()));
    }
    let mut coordinates =
        vec![(Coordinate::Speed, 7), (Coordinate::Speed, 14), (Coordinate::Time, 7), (Coordinate::Time, 24)];
    if rows.iter().any(|row| row.interval.temperature_c.is_some()) {
        families.push(Family::Shapes(vec![Term::Temperature]));
        coordinates.push((Coordinate::Temperature, 5));
    }
    if context.period_days > 0.0 {
        families.push(Family::Shapes(vec![Term::Season]));
        coordinates.push((Coordinate::Day, 5));
    }
    let along = |which| {
        let at = move |row: &Row| coordinate(which, row, row.interval.middle());
        rows.iter().filter_map(at)
    };
    // Days and temperatures are those of runs, so a step lies between two of them.
    for which in [Coordinate::Day, Coordinate::Temperature] {
        let of_run = |range: &Range<usize>| coordinate(which, &rows[range.start], rows[range.start].interval.middle());
        let between = knots(whitening.runs().iter().filter_map(of_run), STEPS);
        let steps = between.windows(2).flat_map(|pair| {
            let at = 0.5 * (pair[0] + pair[1]);
            [Side::Below, Side::Above].map(|side| Term::Step(which, [at - STEEP, at + STEEP], side))
        });
        let steps: Vec<Term> = steps.collect();
        if !steps.is_empty() {
            families.push(Family::Shapes(steps));
        }
    }
    let mut smooth = |which, knots| families.push(Family::Shapes(vec![Term::Smooth(which, knots)]));
    for (which, count) in coordinates {
        smooth(which, knots(along(which), count));
    }
    // Speeds that are only passed through have few rows, and no knot among those that are equally filled.
    let (low, high) = along(Coordinate::Speed).fold((f64::INFINITY, 0.0_f64), |(l, h), v| (l.min(v), h.max(v)));
    if low < high {
        let even = |i: usize| low + (high - low) * i as f64 / (EVEN - 1) as f64;
        smooth(Coordinate::Speed, (0..EVEN).map(even).collect());
    }
    families
}
