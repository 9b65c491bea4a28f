//! Lists of a fixed capacity from items. `collect` panics where there are more items than room; here the first ones are
//! kept.

use heapless::Vec;

/// As many of the items as there is room for. Every caller has room for all of them.
pub(crate) fn listed<T, const N: usize>(items: impl IntoIterator<Item = T>) -> Vec<T, N> {
    let mut list = Vec::new();
    for item in items {
        if list.push(item).is_err() {
            break;
        }
    }
    list
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_ones_are_kept() {
        assert_eq!(listed::<_, 4>([1, 2]), [1, 2]);
        assert_eq!(listed::<_, 2>([1, 2, 3]), [1, 2]);
    }
}
