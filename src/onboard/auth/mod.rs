//! Who may change what: messages with a MAC and a freshness that never repeats.
//!
//! In: a message and a key that only the operator and this board have. Out: the same message with a trailer of 16
//! bytes; on the board the message again, or why it is refused.
//!
//! ```text
//! message | epoch | counter | MAC         secured message; trailer little-endian: 4, 4 and 8 bytes
//!
//! MAC = first 8 bytes of AES-128-CMAC(key, direction | data id | train id | epoch | counter | message)
//!                                              1         2          8         4       4           bytes
//! ```
//!
//! In the manner of AUTOSAR SecOC (truncated CMAC over data id, data and whole freshness); CMAC after RFC 4493. Nothing
//! is encrypted.
//!
//! - *Epoch*: rises with every boot of the board
//!   ([`Store::advance_epoch`](crate::onboard::store::Store::advance_epoch)), stored before it is used. What was
//!   recorded before a reboot is of an older epoch.
//! - *Counter*: within an epoch every accepted message has a higher one. It does not wrap: after `u32::MAX` messages
//!   the board has to be restarted.
//! - *Announcement*: the board states its epoch and last counter in its status, with a MAC of the other direction. So
//!   nobody can make the sender sign for an epoch that is still to come.
//! - *Data id*: what kind of message it is; a message of one kind cannot be passed off as another.
//!
//! The MAC is checked first and in constant time; epoch and counter of a forged message are never looked at. Nothing of
//! a refused message is parsed. Without a provisioned key, or without an epoch, everything secured is refused.
//!
//! ```
//! use rundown::onboard::auth::{Key, Provisioning, Refusal, Signer, Verifier};
//! use rundown::onboard::train_id::TrainId;
//!
//! let provisioning = Provisioning { key_id: 1, key: Key::new([7; 16]), train: TrainId::of("2451") };
//! let mut board = Verifier::new(Ok(provisioning), Ok(3));
//!
//! let mut desk = Signer::new(&provisioning, &board.announcement().unwrap())?;
//! let mut buffer = [0; 64];
//! let secured = desk.seal(2, b"new track", &mut buffer)?;
//! assert_eq!(board.open(2, secured)?, b"new track");
//! assert!(matches!(board.open(2, secured), Err(Refusal::Stale { .. })));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod aes;
mod error;
mod mac;
pub mod provisioning;
mod signer;
mod verifier;

pub use error::{Refusal, SealError};
pub use mac::{Freshness, MAC, TRAILER};
pub use provisioning::{Key, KeySource, Provisioning, ProvisioningError};
pub use signer::Signer;
pub use verifier::Verifier;
