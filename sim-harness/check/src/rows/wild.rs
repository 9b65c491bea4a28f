//! Which readings of a column are wild: a few between others that agree with each other.

/// So many wild readings may stand together.
pub(crate) const MOST_WILD: usize = 3;

/// Readings, of these rows, that are far from those before and behind: each with how far. `far` takes the last reading
/// that is not wild, the first and the last of those that may be, and the next one.
pub(crate) fn wild(read: &[usize], far: impl Fn([usize; 4]) -> Option<f64>) -> Vec<(usize, f64)> {
    let mut found = Vec::new();
    let Some(mut before) = read.first().copied() else { return found };
    let mut at = 1;
    while at + 1 < read.len() {
        let together = (1..=MOST_WILD).find_map(|long| {
            let after = *read.get(at + long)?;
            Some((long, far([before, read[at], read[at + long - 1], after])?))
        });
        match together {
            Some((long, off)) => {
                found.extend(read[at..at + long].iter().map(|i| (*i, off)));
                at += long;
            }
            None => {
                before = read[at];
                at += 1;
            }
        }
    }
    found
}
