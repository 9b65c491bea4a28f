//! The record that was written at the depot, at a fixed address of its own page. The firmware never writes there.

use rundown::onboard::auth::provisioning::SIZE;
use rundown::onboard::auth::{KeySource, Provisioning, ProvisioningError};

unsafe extern "C" {
    /// Its first byte; the linker's symbol, its address is the value.
    static _key: u8;
}

/// As it stands; a page that was never written reads 0xFF (in the emulator of the reference board 0).
fn record() -> [u8; SIZE] {
    let mut record = [0; SIZE];
    for (index, byte) in record.iter_mut().enumerate() {
        // SAFETY: within the page; volatile, because the compiler does not know what was written there.
        *byte = unsafe { (&raw const _key).add(index).read_volatile() };
    }
    record
}

/// The page; read each time.
pub struct KeyPage;

impl KeySource for KeyPage {
    #[inline(never)]
    fn provisioning(&self) -> Result<Provisioning, ProvisioningError> {
        Provisioning::from_bytes(&record())
    }
}
