//! Nothing that was found lies beyond the ends of the line: the fit looks a little further, because a train does.

use crate::named::Named;
use rundown::model::effects::{Coordinate, Effect, GradientError, Moment, PowerLimitSection, TunnelDrag, Unknown};

/// Puts sections, their intervals and tables over the location onto the line.
pub fn on_line(one: &mut Named, length_m: f64) {
    if let Effect::TunnelDrag(TunnelDrag { from_m, to_m, .. })
    | Effect::GradientError(GradientError { from_m, to_m, .. })
    | Effect::PowerLimitSection(PowerLimitSection { from_m, to_m, .. }) = &mut one.effect
    {
        let (from, to) = (from_m.clamp(0.0, length_m), to_m.clamp(0.0, length_m));
        // A section that has no part of the line stays what it is.
        if from < to {
            (*from_m, *to_m) = (from, to);
        }
    }
    if let Effect::Unknown(unknown) = &mut one.effect {
        table_on_line(unknown, length_m);
    }
    for (parameter, low, high) in &mut one.intervals {
        if matches!(*parameter, "from_m" | "to_m") {
            *low = low.clamp(0.0, length_m);
            *high = high.clamp(0.0, length_m);
        }
    }
}

/// The points beyond an end give way to one at the end, with what the table has there.
fn table_on_line(unknown: &mut Unknown, length_m: f64) {
    let ends = [0.0, length_m as f32];
    let beyond = |at: f32| at < ends[0] || at > ends[1];
    if unknown.coordinate != Coordinate::Location || !unknown.table.iter().any(|(at, _)| beyond(*at)) {
        return;
    }
    let value = |at: f32| {
        let location_m = f64::from(at);
        let there = Moment { location_m, ..Moment::default() };
        (at, unknown.resistance_n_per_kg(&there) as f32)
    };
    let inside = |(at, _): &&(f32, f32)| *at > ends[0] && *at < ends[1];
    let first = unknown.table.first().filter(|(at, _)| *at <= ends[0]);
    let last = unknown.table.last().filter(|(at, _)| *at >= ends[1]);
    let points = first.map(|_| value(ends[0])).into_iter();
    let points = points.chain(unknown.table.iter().filter(inside).copied());
    unknown.table = points.chain(last.map(|_| value(ends[1]))).collect();
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_section_from_minus_100_m_begins_with_the_line() {
        let effect = Effect::GradientError(GradientError { from_m: -100.0, to_m: 900.0, delta_permille: 1.0 });
        let mut one = Named::plain(effect, Vec::new(), 10.0, 30.0);
        one.intervals.push(("from_m", -140.0, 40.0));
        on_line(&mut one, 32_000.0);
        assert_eq!(one.effect.section_m(), Some((0.0, 900.0)));
        assert_eq!(one.intervals, [("from_m", 0.0, 40.0)]);
    }

    #[test]
    fn a_table_keeps_its_values_on_the_line() {
        let points = [(-100.0, 0.0), (100.0, 2e-3), (900.0, 2e-3), (1100.0, 0.0)];
        let mut one = Named::plain(
            Effect::Unknown(Unknown { coordinate: Coordinate::Location, table: points.into_iter().collect() }),
            Vec::new(),
            10.0,
            30.0,
        );
        on_line(&mut one, 1000.0);
        let Effect::Unknown(unknown) = one.effect else {
            panic!("another effect");
        };
        assert_eq!(unknown.table, [(0.0, 1e-3), (100.0, 2e-3), (900.0, 2e-3), (1000.0, 1e-3)]);
    }
}
