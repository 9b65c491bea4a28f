//! Which runs an effect acts in, where it does not act in all.

use rand::SeedableRng;
use rand::seq::SliceRandom;
use rand_chacha::ChaCha8Rng;
use serde::{Deserialize, Serialize};

/// Some of the runs: a share of them, drawn, or their numbers, counted from 1.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(untagged, expecting = "expected a share of the runs (0 to 1) or a list of their numbers, counted from 1")]
pub enum Affected {
    /// This share of the groups, rounded to whole ones.
    Share(f64),
    /// These runs.
    Numbers(Vec<usize>),
}

impl Affected {
    /// Every run.
    pub fn all() -> Self {
        Self::Share(1.0)
    }

    /// For each run, whether it is affected. Runs with equal values in `groups` (the date, or their own number) share
    /// their fate.
    ///
    /// ```
    /// use rundown_truth::effects::Affected;
    ///
    /// let chosen = Affected::Share(0.5).choose(&[0, 0, 1, 1], 3);
    /// assert!(chosen == [true, true, false, false] || chosen == [false, false, true, true]);
    /// assert_eq!(Affected::Numbers(vec![2]).choose(&[0, 1, 2], 3), [false, true, false]);
    /// ```
    pub fn choose(&self, groups: &[i64], seed: u64) -> Vec<bool> {
        match self {
            Self::Numbers(numbers) => (1..=groups.len()).map(|n| numbers.contains(&n)).collect(),
            Self::Share(share) => {
                let mut all = groups.to_vec();
                all.sort_unstable();
                all.dedup();
                let count = (share * all.len() as f64).round() as usize;
                all.shuffle(&mut ChaCha8Rng::seed_from_u64(seed));
                let chosen = &all[..count.min(all.len())];
                groups.iter().map(|group| chosen.contains(group)).collect()
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_share_is_met_to_the_run() {
        let groups: Vec<i64> = (0..67).collect();
        for seed in 0..20 {
            let chosen = Affected::Share(0.3).choose(&groups, seed);
            assert_eq!(chosen.iter().filter(|c| **c).count(), 20, "seed {seed}");
        }
        assert_ne!(Affected::Share(0.3).choose(&groups, 1), Affected::Share(0.3).choose(&groups, 2));
    }
}
