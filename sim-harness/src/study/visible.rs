//! How large a change must be that a reader of the paper could have seen it.
//!
//! A claim of direction ("decreases", "negative skewness", "overestimates") is true of any change of the right sign,
//! however small. The authors saw it in a figure or in printed digits, so a change counts from the resolution of these
//! on. Of r1 and r2 nothing is printed, and Table 1 lets them move by a half and a quarter of the share by which r0
//! does: what is said of all three is visible where r0 is.

use super::verdict::Verdict;

/// The least change that is seen, in the unit of what changes, and why that one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Size {
    pub least: f64,
    pub reason: &'static str,
}

/// Of r0, N/kg: a change, or the standard deviation of a distribution.
pub const R0: Size = Size { least: 1e-5, reason: "1e-5 N/kg, the last digit of r0 that section 4.2 prints" };
pub const SKEWNESS: Size =
    Size { least: 0.5, reason: "a skewness of 0.5: a histogram with less looks symmetric (Bulmer 1979)" };
/// Of a brake rate, m/s².
pub const RATE: Size =
    Size { least: 0.01, reason: "0.01 m/s\u{b2}, the last digit of the largest rate that section 4.2 prints" };
/// Of an effort or a power, as a share of the manufacturer's.
pub const SHARE: Size =
    Size { least: 0.01, reason: "1 %, the last digit of shares of the largest that section 4.2 prints" };
/// Of a share of a run's time.
pub const TIME_SHARE: Size =
    Size { least: 0.001, reason: "0.1 points, the last digit of the shares that section 4.3 prints" };
/// Of a length of a phase, s.
pub const LENGTH: Size =
    Size { least: 1.0, reason: "1 s, a tenth of the time between readings; the paper gives no figure" };

impl Size {
    /// `change` is positive where it goes as the paper says.
    pub fn judge(&self, change: f64) -> Verdict {
        match change {
            change if change >= self.least => Verdict::Reproduced,
            change if change <= -self.least => Verdict::Not,
            // Also what is not a number.
            _ => Verdict::NotVisible,
        }
    }

    pub fn sees(&self, change: f64) -> bool {
        self.judge(change) == Verdict::Reproduced
    }
}

/// Of a claim with several parts: each must hold.
pub fn weakest(parts: impl IntoIterator<Item = Verdict>) -> Verdict {
    let rank = |verdict: &Verdict| match verdict {
        Verdict::Not => 0,
        Verdict::NotVisible => 1,
        Verdict::NoData | Verdict::Elsewhere => 2,
        Verdict::Reproduced => 3,
    };
    parts.into_iter().min_by_key(rank).unwrap_or(Verdict::NoData)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_change_below_the_last_printed_digit_is_not_visible_in_either_direction() {
        let of = |change| R0.judge(change);
        assert_eq!(
            [of(1.1e-5), of(0.9e-5), of(-0.9e-5)],
            [Verdict::Reproduced, Verdict::NotVisible, Verdict::NotVisible]
        );
        assert_eq!([of(-1.1e-5), of(f64::NAN)], [Verdict::Not, Verdict::NotVisible]);
    }

    #[test]
    fn a_part_that_goes_the_other_way_outweighs_one_that_cannot_be_seen() {
        let parts = [Verdict::Reproduced, Verdict::NotVisible];
        assert_eq!(weakest(parts), Verdict::NotVisible);
        assert_eq!(weakest(parts.into_iter().chain([Verdict::Not])), Verdict::Not);
        assert_eq!(weakest([Verdict::Reproduced; 2]), Verdict::Reproduced);
    }
}
