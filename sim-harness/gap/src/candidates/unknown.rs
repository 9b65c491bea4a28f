//! What no named effect explains: a section, a cube of the speed, a step between runs, or a table.

use crate::candidates::kit::*;
use crate::columns::{both_directions, coordinate, hats, in_the_middle, knots};
use rundown::model::effects::{MAX_POINTS, Unknown};

/// Most values of a coordinate between which steps are tried: each run's, where there are no more.
const STEPS: usize = 100;
/// Half the width of a steep step, of a day or a degree.
pub const STEEP: f64 = 0.02;
/// Knots at even speeds.
const EVEN: usize = 12;
/// Points of the table of a cube.
const CUBE: u32 = 20;

pub struct This;

/// What a term without a name is.
enum Form<'a> {
    Section([f64; 2]),
    Step(Coordinate, [f64; 2], Side),
    Table(Coordinate, &'a [f64]),
    /// v³.
    Cube,
}

impl<'a> Form<'a> {
    fn of(shape: &'a Shape) -> Self {
        match shape {
            Shape::Section(section) => Self::Section(*section),
            Shape::Step(which, ends, side) => Self::Step(*which, *ends, *side),
            Shape::Table(which, knots) => Self::Table(*which, knots),
            Shape::Law
            | Shape::Powers(_)
            | Shape::Number(_)
            | Shape::Numbers(..)
            | Shape::Runs(_)
            | Shape::NumberInRuns(..) => Self::Cube,
        }
    }
}

fn term(shape: Shape) -> Term {
    Term { of: &This, shape }
}

/// A smooth term along a coordinate.
pub fn smooth(which: Coordinate, knots: Vec<f64>) -> Term {
    term(Shape::Table(which, knots))
}

/// Days and temperatures are those of runs, so a step lies between two of them.
fn steps(which: Coordinate, rows: &[Row]) -> Option<Family> {
    let of_runs = rows.chunk_by(|a, b| a.interval.run == b.interval.run);
    let between = knots(of_runs.filter_map(|rows| in_the_middle(which, &rows[0])), STEPS);
    let steps = between.windows(2).flat_map(|pair| {
        let at = 0.5 * (pair[0] + pair[1]);
        [Side::Below, Side::Above].map(|side| term(Shape::Step(which, [at - STEEP, at + STEEP], side)))
    });
    let steps: Vec<Term> = steps.collect();
    (!steps.is_empty()).then_some(Family::Shapes(steps))
}

impl Candidate for This {
    fn facts(&self) -> Facts {
        Facts {
            kind: Some(EffectKind::Unknown),
            what: "Something that is none of these: a table of extra resistance over the coordinate that explains it best.",
            law: "resistance + table(coordinate), straight between its points",
            parameters: "coordinate: location, speed, time since departure, temperature or day; table in N/kg",
            shows: "as in its table",
            confounded: "a named effect that these data show only in part",
            separates: "the picture of the table; then somebody who knows the train and the line",
            prior: Prior::least(
                6e-4,
                "N/kg. Judgement: a table without a name takes the faults of all that is named with it.",
            ),
            ..Facts::default()
        }
    }

    fn families(&self, offer: &Offer<'_>) -> Vec<Family> {
        let rows = offer.rows;
        let mut families = vec![Family::Shapes(vec![term(Shape::Law)])];
        if both_directions(rows) {
            families.push(Family::Section(term(Shape::Section([0.0; 2]))));
        }
        families.extend([Coordinate::Day, Coordinate::Temperature].into_iter().filter_map(|which| steps(which, rows)));
        let along = |which| rows.iter().filter_map(move |row| in_the_middle(which, row));
        let mut tables =
            vec![(Coordinate::Speed, 7), (Coordinate::Speed, 14), (Coordinate::Time, 7), (Coordinate::Time, 24)];
        if rows.iter().any(|row| row.interval.temperature_c.is_some()) {
            tables.push((Coordinate::Temperature, 5));
        }
        if offer.context.conditions.period_days > 0.0 {
            tables.push((Coordinate::Day, 5));
        }
        let mut tables: Vec<Term> =
            tables.into_iter().map(|(which, count)| smooth(which, knots(along(which), count))).collect();
        // Speeds that are only passed through have few rows, and no knot among those that are equally filled.
        let (low, high) = along(Coordinate::Speed).fold((f64::INFINITY, 0.0_f64), |(l, h), v| (l.min(v), h.max(v)));
        if low < high {
            let even = |i: usize| low + (high - low) * i as f64 / (EVEN - 1) as f64;
            tables.push(smooth(Coordinate::Speed, (0..EVEN).map(even).collect()));
        }
        families.extend(tables.into_iter().map(|term| Family::Shapes(vec![term])));
        families
    }

    /// A section acts in both directions alike; v³ is hard to separate from wrong Davis coefficients.
    fn columns(&self, shape: &Shape, context: &Context<'_>, rows: &[Row]) -> Vec<Vec<f64>> {
        match Form::of(shape) {
            Form::Section(section) => vec![along(context, rows, |line, _, p| share(line, p.location_m, section))],
            Form::Step(which, [below, above], side) => vec![along(context, rows, |_, row, p| {
                let Some(at) = coordinate(which, &row.interval, p) else {
                    return 0.0;
                };
                let up = ((at - below) / (above - below)).clamp(0.0, 1.0);
                match side {
                    Side::Below => 1.0 - up,
                    Side::Above => up,
                }
            })],
            Form::Table(which, knots) => hats(which, knots, rows),
            Form::Cube => {
                vec![along(context, rows, |_, _, p| p.speed_mps.powi(3))]
            }
        }
    }

    fn penalty(&self, shape: &Shape, penalty: &PenaltyConfig, _: &[Row]) -> f64 {
        match Form::of(shape) {
            Form::Section(_) | Form::Step(..) => penalty.coefficient + penalty.section + penalty.unnamed,
            Form::Table(_, knots) => knots.len() as f64 * penalty.coefficient + penalty.unnamed,
            Form::Cube => penalty.coefficient + penalty.unnamed_law,
        }
    }

    fn is_plausible(&self, size: &Size<'_>) -> bool {
        let search = &size.context.config.search;
        match size.term.shape {
            Shape::Section(_) => size.most() > search.least_in_section_n_per_kg,
            Shape::Law => size.often() > search.least_n_per_kg,
            Shape::Powers(_)
            | Shape::Number(_)
            | Shape::Numbers(..)
            | Shape::Runs(_)
            | Shape::NumberInRuns(..)
            | Shape::Step(..)
            | Shape::Table(..) => size.most() > size.least(),
        }
    }

    fn effect(&self, fitted: &Fitted, naming: &Naming<'_>) -> Option<(Effect, Vec<Interval95>)> {
        let mut intervals = fitted.edges();
        let mut one = |parameter| {
            let (value, interval) = fitted.first(parameter, 1.0);
            intervals.push(interval);
            value
        };
        let effect = match Form::of(&fitted.term.shape) {
            Form::Section([from_m, to_m]) => {
                let n_per_kg = one("n_per_kg");
                let knots = [from_m - 1.0, from_m, to_m, to_m + 1.0];
                table(Coordinate::Location, &knots, &[0.0, n_per_kg, n_per_kg, 0.0])
            }
            Form::Step(which, ends, side) => {
                let n_per_kg = one("n_per_kg");
                let values = match side {
                    Side::Below => [n_per_kg, 0.0],
                    Side::Above => [0.0, n_per_kg],
                };
                table(which, &ends, &values)
            }
            Form::Table(which, knots) => table(which, knots, &fitted.beta),
            Form::Cube => {
                let b = one("n_per_kg_at_1_mps");
                let fastest = naming.rows.iter().map(|row| row.interval.speed_mps[0]);
                let step_mps = fastest.fold(1.0, f64::max) / f64::from(CUBE - 1);
                let knots: Vec<f64> = (0..CUBE).map(|i| step_mps * f64::from(i)).collect();
                let values: Vec<f64> = knots.iter().map(|v| b * v.powi(3)).collect();
                table(Coordinate::Speed, &knots, &values)
            }
        };
        Some((effect?, intervals))
    }

    fn sentence(&self, named: &Named, context: &Context<'_>) -> String {
        let Effect::Unknown(e) = &named.effect else {
            return String::new();
        };
        let origin = if e.coordinate == Coordinate::Day { context.conditions.first_day } else { 0.0 };
        let (along, unit, factor) = match e.coordinate {
            Coordinate::Location => ("location", "km", 1e-3),
            Coordinate::Speed => ("speed", "km/h", 3.6),
            Coordinate::Time => ("time since departure", "min", 1.0 / 60.0),
            Coordinate::Temperature => ("temperature", "\u{b0}C", 1.0),
            Coordinate::Day => ("date", "days after the first run", 1.0),
        };
        let points = || e.table.iter().map(|(at, n)| (f64::from(*at), f64::from(*n)));
        let largest = points().max_by(|a, b| a.1.abs().total_cmp(&b.1.abs()));
        let (at, extra) = largest.unwrap_or((f64::NAN, f64::NAN));
        // A constant within a section is a table that is zero at both ends.
        let acting: Vec<f64> = points().filter(|(_, n)| *n != 0.0).map(|(at, _)| at).collect();
        let place = match (acting.as_slice(), e.coordinate) {
            ([from, to], Coordinate::Location) => format!("from {}", place(*from, *to)),
            _ => format!("most at {} {unit}", number((at - origin) * factor, 1)),
        };
        let size = short(extra);
        format!(
            "Something that no named effect explains adds resistance that depends on the {along}: {size} N/kg {place}"
        )
    }

    fn axis<'a>(&self, named: &'a Named, context: &Context<'a>) -> Option<Axis<'a>> {
        let Effect::Unknown(e) = &named.effect else {
            return None;
        };
        let first_day = context.conditions.first_day;
        let (axis, factor, origin) = match e.coordinate {
            Coordinate::Location => (Axis::location(), 1e-3, 0.0),
            Coordinate::Speed => (Axis::speed(), 3.6, 0.0),
            Coordinate::Time => (Axis::time(), 1.0 / 60.0, 0.0),
            Coordinate::Temperature => (Axis::temperature(), 1.0, 0.0),
            Coordinate::Day => (Axis::day(first_day), 1.0, first_day),
        };
        let point = |&(at, n_per_kg): &(f32, f32)| ((f64::from(at) - origin) * factor, f64::from(n_per_kg));
        Some(Axis { table: e.table.iter().map(point).collect(), ..axis })
    }

    fn hidden_names(&self) -> Vec<&'static str> {
        vec!["cubic_drag", "speed_bump", "location_bump", "periodic_drag", "frost", "day_step"]
    }

    fn hidden(&self, name: &str, hide: &mut Hide<'_>) -> Option<Value> {
        let [from_m, to_m] = hide.section_m;
        Some(match name {
            "cubic_drag" => json!({ "k": hide.of([3e-7, 1.5e-7, 7e-8]) }),
            "speed_bump" => {
                let (at, half) = (hide.rng.random_range(65.0..100.0), hide.rng.random_range(10.0..25.0));
                json!({ "at_kmh": at, "half_width_kmh": half, "drag_n_per_kg": hide.of([0.012, 0.006, 0.003]) })
            }
            "location_bump" => {
                json!({ "from_m": from_m, "to_m": to_m, "drag_n_per_kg": hide.of([0.02, 0.01, 0.005]) })
            }
            "periodic_drag" => {
                let period_s = hide.rng.random_range(300.0..900.0);
                json!({ "amplitude": hide.of([0.01, 0.005, 0.0025]), "period_s": period_s })
            }
            "frost" => {
                let below_c = hide.rng.random_range(2.0..5.0);
                json!({ "below_c": below_c, "drag_n_per_kg": hide.of([5e-3, 2.5e-3, 1.2e-3]) })
            }
            "day_step" => {
                let from_share = hide.rng.random_range(0.3..0.7);
                json!({ "from_share": from_share, "drag_n_per_kg": hide.of([4e-3, 2e-3, 1e-3]) })
            }
            _ => return None,
        })
    }
}

/// None: a value is no number.
fn table(coordinate: Coordinate, knots: &[f64], values: &[f64]) -> Option<Effect> {
    let mut points: Vec<(f32, f32)> = knots.iter().zip(values).map(|(k, v)| (*k as f32, *v as f32)).collect();
    // Single precision may make two knots one, and a board takes neither that nor a value that is no number.
    points.dedup_by(|a, b| a.0 <= b.0);
    let finite = points.iter().all(|(k, v)| k.is_finite() && v.is_finite());
    finite.then(|| Effect::Unknown(Unknown { coordinate, table: points.into_iter().take(MAX_POINTS).collect() }))
}
