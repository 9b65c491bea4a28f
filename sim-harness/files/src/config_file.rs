//! Configuration: a TOML file with the names of [`Config`]; what it leaves out keeps its default.

use crate::{refusal::ReadError, toml_file::TomlFile};
use rundown::estimator::config::Config;
use std::path::Path;

/// Reads and checks a configuration file.
///
/// # Errors
/// [`ReadError`] names file, line and column.
pub fn read(path: &Path) -> Result<Config, ReadError> {
    checked(TomlFile::read(path)?)
}

/// Reads and checks a text; `path` is for the messages.
///
/// # Errors
/// As [`read`].
///
/// ```
/// use rundown::estimator::config::{Config, Mode};
/// use rundown::tick::sensor::Rounding;
///
/// let text = "mode = \"measured\"\n[sensor]\nrounding = \"truncated\"\n";
/// let config = rundown_files::config_file::parse("c.toml".as_ref(), text)?;
/// assert_eq!(config.mode, Mode::Measured);
/// assert_eq!(config.sensor.rounding, Rounding::Truncated);
/// assert_eq!(config.paper, Config::default().paper);
/// # Ok::<(), rundown_files::refusal::ReadError>(())
/// ```
pub fn parse(path: &Path, text: &str) -> Result<Config, ReadError> {
    checked(TomlFile::parse(path, text)?)
}

fn checked(file: TomlFile<Config>) -> Result<Config, ReadError> {
    match file.values.check() {
        Ok(()) => Ok(file.values),
        Err(error) => Err(file.refuse_error(&[], &error)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rundown::estimator::config::Mode;

    fn message(text: &str) -> String {
        parse("c.toml".as_ref(), text).unwrap_err().to_string()
    }

    #[test]
    fn an_empty_file_is_the_default() {
        assert_eq!(parse("c.toml".as_ref(), "").unwrap(), Config::default());
    }

    #[test]
    fn every_default_survives_being_written_and_read() {
        for mode in [Mode::Paper, Mode::Gated, Mode::Measured] {
            let config = Config::with_mode(mode);
            let text = toml::to_string(&config).unwrap();
            assert_eq!(parse("c.toml".as_ref(), &text).unwrap(), config, "{text}");
        }
    }

    #[test]
    fn refusals_name_line_and_column() {
        assert!(
            message("mode = \"gatd\"\n")
                .starts_with("c.toml:1:8: unknown variant `gatd`, expected one of `paper`, `gated`, `measured`")
        );
        assert!(
            message("[sensor]\nlocation_sd = 3\n")
                .starts_with("c.toml:2:1: unknown field `location_sd`, expected one of")
        );
        let found = message("\n[sensor]\nlocation_sd_m = -3\n");
        assert_eq!(found, "c.toml:3:17: sensor.location_sd_m: expected 0.01 to 10000, found -3");
        let found = message("[features]\nbridge_samples = 2\npower_window_kmh = [130, 50]\n");
        assert_eq!(
            found,
            "c.toml:3:20: features.power_window_kmh: expected two speeds, the smaller first, found 130, 50"
        );
    }
}
