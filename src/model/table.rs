//! A table of a track that comes entry by entry, sorted: its curves, its targets.

/// Entries are checked as they come; what is in the table is ready for use.
pub(crate) trait Table {
    type Entry;

    /// Number of entries.
    fn len(&self) -> usize;

    fn clear(&mut self);

    /// False: it is no such entry, it lies before the last one, or there is no room. The table is as before.
    fn push(&mut self, entry: Self::Entry) -> bool;

    /// These entries instead, or the index of the first one that is refused.
    fn refill(&mut self, entries: impl IntoIterator<Item = Self::Entry>) -> Result<(), usize> {
        self.clear();
        let mut entries = entries.into_iter().enumerate();
        entries.try_for_each(|(index, entry)| self.push(entry).then_some(()).ok_or(index))
    }
}
