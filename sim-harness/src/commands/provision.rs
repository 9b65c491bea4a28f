//! `rundown provision`: the record that makes a board known: its key and its train.

use super::{Failure, screen};
use rundown::onboard::auth::{Key, Provisioning};
use rundown::onboard::train_id::TrainId;
use rundown_files::WriteError;
use std::{path::PathBuf, process::ExitCode};

const EXAMPLES: &str = "\
Examples:
  A new key for the board of unit 2451, and how to write it (page of its own, see docs/firmware.md):
    rundown provision --train-id 2451 --key-id 1 --out key.bin
    probe-rs download --chip STM32L475VGTx --binary-format bin --base-address 0x080FF800 key.bin

The file is the secret: whoever has it can change the board. Keep it where the operator keeps keys, never beside an image.";

#[derive(Debug, clap::Args)]
#[command(after_help = EXAMPLES)]
pub struct Arguments {
    /// The operator's name of the train
    #[arg(long, value_name = "NAME", value_parser = clap::builder::NonEmptyStringValueParser::new())]
    train_id: String,
    /// Number of the key, shown in lists; says nothing of the key
    #[arg(long, value_name = "N", default_value_t = 1)]
    key_id: u32,
    /// File for the record; it must not exist yet, for a key that is overwritten leaves its board locked
    #[arg(long, value_name = "KEY.bin")]
    out: PathBuf,
}

pub(super) fn run(arguments: &Arguments) -> Result<ExitCode, Failure> {
    let at = |error: String| Failure::not_written(format!("{}: {error}", arguments.out.display()));
    let mut key = [0; 16];
    getrandom::fill(&mut key).map_err(|error| at(format!("no random numbers: {error}")))?;
    let provisioning =
        Provisioning { key_id: arguments.key_id, key: Key::new(key), train: TrainId::of(&arguments.train_id) };
    let mut options = std::fs::OpenOptions::new();
    options.write(true).create_new(true);
    // Nobody but its owner reads a secret.
    #[cfg(unix)]
    std::os::unix::fs::OpenOptionsExt::mode(&mut options, 0o600);
    let mut file = options.open(&arguments.out).map_err(|error| match error.kind() {
        std::io::ErrorKind::AlreadyExists => {
            at("expected a new file, found one whose key a board may need; choose another --out".to_owned())
        }
        _ => WriteError { path: arguments.out.clone(), source: error }.into(),
    })?;
    std::io::Write::write_all(&mut file, &provisioning.to_bytes()).map_err(|error| at(error.to_string()))?;
    screen::print(&format!(
        "key {} of train {} ({}): {}\n",
        arguments.key_id,
        arguments.train_id,
        provisioning.train,
        arguments.out.display()
    ));
    Ok(ExitCode::SUCCESS)
}

#[cfg(all(test, unix))]
mod tests {
    use super::*;
    use std::os::unix::fs::PermissionsExt;

    #[test]
    fn a_place_that_takes_no_file_is_named_with_what_helps() {
        let folder = tempfile::tempdir().unwrap();
        let out = folder.path().join("no/such/key.bin");
        let refused = run(&Arguments { train_id: "2451".into(), key_id: 1, out }).unwrap_err();
        assert_eq!(refused.code, super::super::NOT_WRITTEN);
        assert!(refused.message.contains("key.bin: cannot be written: "), "{}", refused.message);
        assert!(refused.message.ends_with("with --out"), "{}", refused.message);
    }

    #[test]
    fn a_key_is_for_its_owner_alone() {
        let folder = tempfile::tempdir().unwrap();
        let out = folder.path().join("key.bin");
        run(&Arguments { train_id: "2451".into(), key_id: 1, out: out.clone() }).unwrap();
        assert_eq!(out.metadata().unwrap().permissions().mode() & 0o777, 0o600);
    }
}
