//! `effect.frame`: the effects of a repaired model as the messages that bring them to a board.
//!
//! ```text
//! file       serial frames (COBS and CRC-32C, `docs/link.md`), one a message
//! message    open uplink message: first `clear_effects`, then `effect`, one for each effect or each point of an unknown one
//! ```
//!
//! A board refuses them as they stand: what changes it must be secured with its key and its announced freshness, which
//! only the sender on its line has. `rundown link --effects effect.frame` secures and sends them.

use rundown::link::checksum::LengthError;
use rundown::link::serial::{self, Decoder};
use rundown::model::effects::{Effect, Effects, FrameError};
use rundown::uplink::{self, Command, OPEN, Request, Uplink, VERSION};
use rundown_wire::{EncodeError, MAX_MESSAGE};
use thiserror::Error;

/// Why a file is no `effect.frame`.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
#[non_exhaustive]
#[expect(missing_docs, reason = "said by the messages")]
pub enum EffectFrameError {
    /// A frame was damaged.
    #[error("message {message}: {reason}")]
    Damaged { message: usize, reason: serial::SerialError },
    #[error("message {message}: expected an open uplink message with an effect, found another one")]
    NoEffect { message: usize },
    #[error("message {message}: {reason}")]
    Refused { message: usize, reason: FrameError },
    /// The last frame has no end.
    #[error("message {message}: expected its end, found the end of the file")]
    CutOff { message: usize },
}

/// Why effects do not fit into messages; their limits are so that it cannot be.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
#[non_exhaustive]
#[expect(missing_docs, reason = "said by the messages")]
pub enum TooLong {
    #[error("effect: {0}")]
    Message(EncodeError),
    #[error("message: {0}")]
    Frame(LengthError),
}

/// The file of these effects.
///
/// # Errors
/// [`TooLong`].
///
/// ```
/// use rundown::model::effects::{Effect, Effects, SteadyWind};
/// use rundown_files::effect_frame::{read, write};
///
/// let effects = Effects::try_new([Effect::SteadyWind(SteadyWind { wind_mps: 2.0 })])?;
/// assert_eq!(read(&write(&effects)?)?, effects);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn write(effects: &Effects) -> Result<Vec<u8>, TooLong> {
    let parts = effects.iter().flat_map(Effect::parts).map(Request::Effect);
    let requests = std::iter::once(Request::Command(Command::ClearEffects)).chain(parts);
    let mut file = Vec::new();
    for (sequence, request) in (1..).zip(requests) {
        let mut buffer = [0; MAX_MESSAGE];
        let message = uplink::encode(&Uplink { sequence, request }, OPEN, &mut buffer).map_err(TooLong::Message)?;
        file.extend_from_slice(&serial::encode(message).map_err(TooLong::Frame)?);
    }
    Ok(file)
}

/// The effects of a file.
///
/// # Errors
/// [`EffectFrameError`] with the number of the message.
pub fn read(file: &[u8]) -> Result<Effects, EffectFrameError> {
    let mut effects = Effects::NONE;
    let mut decoder: Decoder = Decoder::new();
    let mut message = 1;
    let mut whole = true;
    for &byte in file {
        whole = byte == 0;
        let damaged = |reason| EffectFrameError::Damaged { message, reason };
        let Some(bytes) = decoder.push(byte).map_err(damaged)? else {
            continue;
        };
        let uplink = match bytes {
            [VERSION, OPEN, payload @ ..] => uplink::decode(payload),
            _ => None,
        };
        match uplink.map(|uplink| uplink.request) {
            Some(Request::Command(Command::ClearEffects)) => effects = Effects::NONE,
            Some(Request::Effect(effect)) => {
                effects.take(&effect).map_err(|reason| EffectFrameError::Refused { message, reason })?
            }
            _ => return Err(EffectFrameError::NoEffect { message }),
        }
        message += 1;
    }
    if whole { Ok(effects) } else { Err(EffectFrameError::CutOff { message }) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rundown::model::effects::{Coordinate, TunnelDrag, Unknown};

    fn effects() -> Effects {
        let tunnel = TunnelDrag { from_m: 100.0, to_m: 900.0, k: 1e-5 };
        let table = [(0.0, 0.0), (20.0, 0.01), (40.0, 0.03)];
        let unknown = Unknown { coordinate: Coordinate::Speed, table: table.into_iter().collect() };
        Effects::try_new([Effect::TunnelDrag(tunnel), Effect::Unknown(unknown)]).unwrap()
    }

    #[test]
    fn what_is_written_is_read() {
        assert_eq!(read(&write(&effects()).unwrap()), Ok(effects()));
        assert_eq!(read(&write(&Effects::NONE).unwrap()), Ok(Effects::NONE));
    }

    #[test]
    fn no_damage_goes_unseen() {
        let file = write(&effects()).unwrap();
        for at in 0..file.len() {
            let mut damaged = file.clone();
            damaged[at] ^= 0x10;
            assert!(read(&damaged).is_err(), "byte {at}");
            // Cut between two messages it is a shorter list.
            let cut = read(&file[..at]);
            assert_eq!(cut.is_ok(), at == 0 || file[at - 1] == 0, "cut at {at}");
        }
    }
}
