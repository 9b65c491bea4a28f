//! Whether a claim holds over several sets of runs.

use super::{Claim, Verdict};

/// What sets of runs say of a claim.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Sets {
    /// All that were judged or could not be.
    pub all: usize,
    /// Those that have data on it.
    pub judged: usize,
    pub held: usize,
    /// Those in which the change goes the claim's way or against it, too small to be seen.
    pub not_visible: usize,
}

impl Sets {
    /// In how many sets a claim must hold: 18 of 20, so 90 %.
    pub const fn needed(all: usize) -> usize {
        (9 * all).div_ceil(10)
    }

    fn add(&mut self, verdict: Verdict) {
        self.all += 1;
        self.judged += usize::from(!matches!(verdict, Verdict::NoData | Verdict::Elsewhere));
        self.held += usize::from(verdict == Verdict::Reproduced);
        self.not_visible += usize::from(verdict == Verdict::NotVisible);
    }

    /// Reproduced where enough sets hold, not where too many contradict; without data where too few have any.
    pub fn verdict(&self) -> Verdict {
        let needed = Self::needed(self.all);
        let contradict = self.judged - self.held;
        match () {
            () if self.all == 0 || self.judged == 0 => Verdict::NoData,
            () if self.held >= needed => Verdict::Reproduced,
            () if contradict <= self.all - needed => Verdict::NoData,
            () if 2 * self.not_visible > contradict => Verdict::NotVisible,
            () => Verdict::Not,
        }
    }

    /// `18 of 20`; of those that have data.
    pub fn words(&self) -> String {
        format!("{} of {}", self.held, self.judged)
    }
}

/// The claims over all sets of runs: the words of the first set, the verdict of all.
pub fn over_sets(first: Vec<Claim>, others: &[Vec<Claim>]) -> Vec<Claim> {
    let judged = |(index, claim): (usize, Claim)| {
        let mut sets = Sets::default();
        sets.add(claim.verdict);
        others.iter().filter_map(|other| other.get(index)).for_each(|other| sets.add(other.verdict));
        let elsewhere = claim.verdict == Verdict::Elsewhere;
        Claim { verdict: if elsewhere { claim.verdict } else { sets.verdict() }, sets, ..claim }
    };
    first.into_iter().enumerate().map(judged).collect()
}

#[cfg(test)]
mod tests {
    use super::super::claim;
    use super::*;

    fn over(verdicts: &[Verdict]) -> Claim {
        let of = |verdict| vec![Claim { verdict, ..claim("3", "a") }];
        let others: Vec<_> = verdicts[1..].iter().map(|verdict| of(*verdict)).collect();
        over_sets(of(verdicts[0]), &others).remove(0)
    }

    #[test]
    fn a_claim_holds_in_nine_of_ten_sets_whatever_the_first_says() {
        assert_eq!([1, 2, 10, 19, 20].map(Sets::needed), [1, 2, 9, 18, 18]);
        let of = |held: usize, verdict| {
            let mut all = vec![verdict; 20 - held];
            all.extend(vec![Verdict::Reproduced; held]);
            over(&all).verdict
        };
        assert_eq!(of(18, Verdict::Not), Verdict::Reproduced);
        assert_eq!(of(17, Verdict::Not), Verdict::Not);
        assert_eq!(of(3, Verdict::NotVisible), Verdict::NotVisible);
    }

    #[test]
    fn sets_without_data_neither_hold_nor_contradict() {
        let claim = over(&[Verdict::Reproduced, Verdict::Not, Verdict::NoData, Verdict::Reproduced]);
        assert_eq!(claim.sets, Sets { all: 4, judged: 3, held: 2, not_visible: 0 });
        assert_eq!(over(&[Verdict::Reproduced, Verdict::NoData]).verdict, Verdict::NoData);
        assert_eq!(over(&[Verdict::NoData]).verdict, Verdict::NoData);
        assert_eq!(over(&[Verdict::Reproduced]).verdict, Verdict::Reproduced);
    }
}
