//! The CMSDK UART 0, by interrupt.

use embedded_hal_nb::nb;
use embedded_hal_nb::serial::{ErrorKind, ErrorType, Read, Write};
use rundown::onboard::serial::LinePort;

const UART: usize = 0x4000_4000;
const DATA: *mut u32 = UART as *mut u32;
const STATE: *mut u32 = (UART + 0x4) as *mut u32;
const CONTROL: *mut u32 = (UART + 0x8) as *mut u32;
const INTERRUPTS: *mut u32 = (UART + 0xC) as *mut u32;
const DIVIDER: *mut u32 = (UART + 0x10) as *mut u32;

/// Bits of STATE.
const TX_FULL: u32 = 1 << 0;
const RX_FULL: u32 = 1 << 1;
const RX_OVERRUN: u32 = 1 << 3;
/// Bits of CONTROL: transmitter, receiver, interrupt after a byte came, and after one went.
const ENABLED: u32 = 0b1011;
const TX_INTERRUPT: u32 = 1 << 2;

/// The emulated line.
pub struct SerialPort;

impl SerialPort {
    pub fn start() -> Self {
        // SAFETY: registers of the UART, which nothing else touches. The divider is the smallest that is allowed; the
        // emulator has no bit time.
        unsafe {
            DIVIDER.write_volatile(16);
            CONTROL.write_volatile(ENABLED);
        }
        Self
    }
}

impl ErrorType for SerialPort {
    type Error = ErrorKind;
}

impl Read<u8> for SerialPort {
    fn read(&mut self) -> nb::Result<u8, ErrorKind> {
        // SAFETY: registers of the UART; the interrupt is acknowledged before the byte is taken, so the next byte
        // raises it again.
        unsafe {
            INTERRUPTS.write_volatile(0b11);
            let state = STATE.read_volatile();
            if state & RX_OVERRUN != 0 {
                STATE.write_volatile(RX_OVERRUN);
                return Err(nb::Error::Other(ErrorKind::Overrun));
            }
            if state & RX_FULL == 0 {
                return Err(nb::Error::WouldBlock);
            }
            Ok((DATA.read_volatile() & 0xFF) as u8)
        }
    }
}

impl Write<u8> for SerialPort {
    fn write(&mut self, byte: u8) -> nb::Result<(), ErrorKind> {
        // SAFETY: registers of the UART.
        unsafe {
            if STATE.read_volatile() & TX_FULL != 0 {
                return Err(nb::Error::WouldBlock);
            }
            DATA.write_volatile(byte.into());
        }
        Ok(())
    }

    fn flush(&mut self) -> nb::Result<(), ErrorKind> {
        // SAFETY: register of the UART.
        if unsafe { STATE.read_volatile() } & TX_FULL != 0 {
            return Err(nb::Error::WouldBlock);
        }
        Ok(())
    }
}

impl LinePort for SerialPort {
    fn interrupt_when_writable(&mut self, on: bool) {
        let bits = if on { ENABLED | TX_INTERRUPT } else { ENABLED };
        // SAFETY: register of the UART.
        unsafe { CONTROL.write_volatile(bits) };
    }
}
