//! USART1 by interrupt, a byte at a time: where there is no DMA controller, as in the emulator.

use super::super::BAUD;
use super::device::USART1;
use embedded_hal_nb::nb;
use embedded_hal_nb::serial::{ErrorKind, ErrorType, Read, Write};
use rundown::onboard::serial::LinePort;

/// USART1 byte by byte.
pub struct BytePort(USART1);

impl BytePort {
    pub fn start(usart: USART1, bus_hz: u32) -> Self {
        // SAFETY: 80 MHz gives 694, 4 MHz gives 35: both within the 16 bits, neither below 16.
        usart.brr().write(|w| unsafe { w.bits((bus_hz + BAUD / 2) / BAUD) });
        usart.cr1().write(|w| {
            w.rxneie().set_bit();
            w.re().set_bit();
            w.te().set_bit();
            w.ue().set_bit()
        });
        Self(usart)
    }
}

impl ErrorType for BytePort {
    type Error = ErrorKind;
}

impl Read<u8> for BytePort {
    fn read(&mut self) -> nb::Result<u8, ErrorKind> {
        let status = self.0.isr().read();
        // The byte that is there when another overran it is good: read it first, the flag comes next time.
        if status.rxne().bit() {
            // 32-bit access, as the reference manual says; the low byte is the data. Reading takes the byte and its
            // framing and noise flags.
            let byte = (self.0.rdr().read().bits() & 0xFF) as u8;
            if status.fe().bit() {
                self.0.icr().write(|w| w.fecf().clear_bit_by_one());
                return Err(nb::Error::Other(ErrorKind::FrameFormat));
            }
            if status.nf().bit() {
                self.0.icr().write(|w| w.ncf().clear_bit_by_one());
                return Err(nb::Error::Other(ErrorKind::Noise));
            }
            return Ok(byte);
        }
        if status.ore().bit() {
            self.0.icr().write(|w| w.orecf().clear_bit_by_one());
            return Err(nb::Error::Other(ErrorKind::Overrun));
        }
        Err(nb::Error::WouldBlock)
    }
}

impl Write<u8> for BytePort {
    fn write(&mut self, byte: u8) -> nb::Result<(), ErrorKind> {
        if self.0.isr().read().txe().bit_is_clear() {
            return Err(nb::Error::WouldBlock);
        }
        // SAFETY: eight bits of the nine; a 32-bit access.
        self.0.tdr().write(|w| unsafe { w.bits(byte.into()) });
        Ok(())
    }

    fn flush(&mut self) -> nb::Result<(), ErrorKind> {
        if self.0.isr().read().tc().bit_is_clear() {
            return Err(nb::Error::WouldBlock);
        }
        Ok(())
    }
}

impl LinePort for BytePort {
    fn interrupt_when_writable(&mut self, on: bool) {
        self.0.cr1().modify(|_, w| w.txeie().bit(on));
    }
}
