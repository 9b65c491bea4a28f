//! The metal: registers and linker symbols. The only place with `unsafe`; what can be decided without a register is in `rundown::onboard`.
//!
//! | here | what |
//! |---|---|
//! | `l475` | ST B-L475E-IOT01A |
//! | `mps2` | Arm MPS2 AN386, test-only, in the emulator |
//! | `ram_flash` | RAM that plays the flash, in the emulator |
//! | `kept_ram` | RAM that survives a reset |
//! | `painted_stack` | how deep the stack has been |
//! | `fallen` | panics and faults: write down why, then reset |
//! | `stopwatch` | time in counts of the system timer |

mod fallen;
pub mod kept_ram;
pub mod painted_stack;
#[cfg(any(feature = "mps2", feature = "emulator"))]
mod ram_flash;
pub mod stopwatch;

#[cfg(not(feature = "mps2"))]
mod l475;
#[cfg(not(feature = "mps2"))]
pub use l475::{Board, DogTimer, Flash, SerialPort, device, flash_errors, provoke, start};

#[cfg(feature = "mps2")]
mod mps2;
#[cfg(feature = "mps2")]
pub use mps2::{Board, DogTimer, Flash, SerialPort, device, flash_errors, provoke, start};

/// Speed of the serial line, bit/s.
#[cfg_attr(
    feature = "mps2",
    expect(dead_code, reason = "the emulated port takes any")
)]
pub const BAUD: u32 = 115_200;

/// Where a test build can be told to fail.
#[derive(Clone, Copy)]
pub enum Place {
    Tick,
    Link,
}

#[cfg(not(feature = "emulator"))]
unsafe extern "C" {
    /// First byte of the provisioning record; the linker's symbol.
    static _key: u8;
}

/// The provisioning record of the tests, which everybody knows: the emulator of the B-L475E-IOT01A cannot be given one. No image for a train has this feature.
#[cfg(feature = "emulator")]
pub fn key_record() -> [u8; rundown::auth::provisioning::SIZE] {
    rundown::auth::Provisioning {
        key_id: 1,
        key: rundown::auth::Key::new(*b"not a secret key"),
        train: rundown::train_id::TrainId(0x2451),
    }
    .to_bytes()
}

/// The provisioning record as it stands in flash.
#[cfg(not(feature = "emulator"))]
pub fn key_record() -> [u8; rundown::auth::provisioning::SIZE] {
    let first = &raw const _key;
    // SAFETY: the page is flash of its own, and nothing writes to it while the firmware runs; volatile, because the compiler must not think that it knows the bytes.
    core::array::from_fn(|offset| unsafe { first.add(offset).read_volatile() })
}
