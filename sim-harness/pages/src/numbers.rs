//! Numbers as they are read: with as many digits as are worth it, and a dash for what is not there.

use rundown::{Real, features::Statistic, tick::estimate::Cause};

/// Stands where there is no value.
pub const NOTHING: &str = "\u{2013}";

/// With so many decimals; a dash when it is not there or not finite.
pub fn number(value: impl Into<Option<Real>>, decimals: usize) -> String {
    match value.into() {
        Some(value) if value.is_finite() => {
            let text = format!("{value:.decimals$}");
            let is_zero = text.chars().all(|c| matches!(c, '-' | '0' | '.'));
            match is_zero {
                true => text.trim_start_matches('-').to_owned(),
                false => text.replace('-', "\u{2212}"),
            }
        }
        _ => NOTHING.to_owned(),
    }
}

/// A share of one as `57.1 %`, the sign kept with its number.
pub fn percent(share: impl Into<Option<Real>>) -> String {
    match share.into().filter(|share| share.is_finite()) {
        Some(share) => format!("{}\u{a0}%", number(100.0 * share, 1)),
        None => NOTHING.to_owned(),
    }
}

/// `45 s`, `12.3 min`, `3.1 h`.
pub fn duration(time_s: Real) -> String {
    match time_s {
        _ if !time_s.is_finite() => NOTHING.to_owned(),
        _ if time_s < 120.0 => format!("{} s", number(time_s, 0)),
        _ if time_s < 7200.0 => format!("{} min", number(time_s / 60.0, 1)),
        _ => format!("{} h", number(time_s / 3600.0, 1)),
    }
}

/// `1 run`, `3 runs`.
pub fn counted(count: usize, one: &str, many: &str) -> String {
    format!("{count} {}", if count == 1 { one } else { many })
}

/// Count, mean and standard deviation in another unit; one value has no standard deviation.
pub fn statistic(statistic: &Statistic, per_unit: Real, decimals: usize) -> [String; 3] {
    let Statistic { count, mean, sd } = *statistic;
    [
        count.to_string(),
        number((count > 0).then_some(mean * per_unit), decimals),
        number((count > 1).then_some(sd * per_unit), decimals),
    ]
}

/// What a cause means, for those who do not know the words of the tables.
pub fn meaning(cause: Cause) -> &'static str {
    match cause {
        Cause::NoLocation => "the location was not sent",
        Cause::NoSpeed => "the speed was not sent",
        Cause::LocationOutOfRange => "the location was not a number, or off the track",
        Cause::SpeedOutOfRange => "the speed was not a number, negative, or faster than any train",
        Cause::LocationJump => "the location lay far from where the speed led",
        Cause::SpeedJump => "the speed changed faster than a train can",
        Cause::StuckSpeed => "the speed stayed the same while the location said otherwise",
        Cause::StuckLocation => "the location stayed the same while the train ran",
        Cause::Reversing => "the train ran against its direction of travel",
        Cause::Contradiction => "the locations were shifted for good, and were reset",
        Cause::LongGap => "no measurement for so long that location and speed were reset",
        Cause::Numerics => "the covariance was repaired",
        // `Cause` may grow; its own word is better than nothing.
        other => other.as_str(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_not_there_is_a_dash() {
        assert_eq!(number(Real::NAN, 2), NOTHING);
        assert_eq!(number(None, 2), NOTHING);
        assert_eq!(percent(Real::INFINITY), NOTHING);
        assert_eq!(duration(Real::NAN), NOTHING);
        let one = Statistic { count: 1, mean: 2.0, sd: 0.0 };
        assert_eq!(statistic(&one, 3.6, 1), ["1", "7.2", NOTHING]);
        assert_eq!(statistic(&Statistic::default(), 1.0, 1), ["0", NOTHING, NOTHING]);
    }

    #[test]
    fn zero_has_no_sign() {
        assert_eq!(number(-0.0001, 2), "0.00");
        assert_eq!(number(-0.25, 2), "\u{2212}0.25");
        assert_eq!(percent(0.5712), "57.1\u{a0}%");
        assert_eq!(duration(119.0), "119 s");
        assert_eq!(duration(900.0), "15.0 min");
        assert_eq!(counted(1, "run", "runs"), "1 run");
    }
}
