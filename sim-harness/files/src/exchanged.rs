//! Does a train stand where a track is expected, or the other way round?
//!
//! In: the text of a description that was refused. Out: its refusal; where it is the other description that is said,
//! not its first field that is unknown.

use crate::refusal::ReadError;
use std::path::Path;
use toml::de::DeTable;

/// What a file describes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Described {
    Train,
    Track,
}

/// A train needs these, and a track has none of them.
const OF_A_TRAIN: [&str; 3] = ["mass_kg", "max_power_w", "davis"];
/// A train has none of these.
const OF_A_TRACK: [&str; 7] = ["gradient", "curve", "tunnel", "speed_limit", "feeding_section", "stop", "centre_line"];

impl Described {
    /// `error`: why this text is not what is expected.
    pub(crate) fn or_exchanged(self, error: ReadError, path: &Path, text: &str) -> ReadError {
        let words = |described| if described == Self::Train { "a train" } else { "a track" };
        match Self::of(text) {
            Some(found) if found != self => {
                let (expected, found) = (words(self), words(found));
                let message = format!("expected {expected}, found {found}; are --train and --track exchanged?");
                ReadError::of_file(path, message)
            }
            _ => error,
        }
    }

    /// None of a text that is neither, or a mixture.
    fn of(text: &str) -> Option<Self> {
        let table = DeTable::parse(text.trim_start_matches('\u{feff}')).ok()?;
        let has = |names: &[&str]| names.iter().any(|name| table.get_ref().contains_key(*name));
        match (has(&OF_A_TRAIN), has(&OF_A_TRACK)) {
            (true, false) => Some(Self::Train),
            (false, true) => Some(Self::Track),
            _ => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::track_file::TrackFile;
    use crate::train_file::TrainFile;

    fn as_train(text: &str) -> String {
        TrainFile::parse("t.toml".as_ref(), text).unwrap_err().to_string()
    }

    fn as_track(text: &str) -> String {
        TrackFile::parse("t.toml".as_ref(), text).unwrap_err().to_string()
    }

    #[test]
    fn each_field_shows_which_of_the_two_it_is_of() {
        let exchanged = "are --train and --track exchanged?";
        for field in OF_A_TRAIN {
            let text = format!("name = \"unit\"\nlength_m = 90\n{field} = 1\n");
            assert_eq!(as_track(&text), format!("t.toml: expected a track, found a train; {exchanged}"));
            assert!(!as_train(&text).contains("unknown field"), "{field}: {}", as_train(&text));
        }
        for field in OF_A_TRACK {
            let text = format!("name = \"line\"\nlength_m = 9000\n[[{field}]]\nat = 0\n");
            assert_eq!(as_train(&text), format!("t.toml: expected a train, found a track; {exchanged}"));
            // Of the table, not of the field itself.
            assert!(!as_track(&text).contains(&format!("unknown field `{field}`")), "{field}: {}", as_track(&text));
        }
    }

    #[test]
    fn a_mixture_is_refused_by_its_field() {
        let text = "name = \"unit\"\nmass_kg = 1e5\n[[stop]]\nat_m = 0\n";
        assert!(as_train(text).contains("unknown field `stop`"), "{}", as_train(text));
        assert!(as_track(text).contains("unknown field `mass_kg`"), "{}", as_track(text));
    }
}
