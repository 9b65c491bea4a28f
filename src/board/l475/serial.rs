//! USART1, 8N1: the debugger's virtual COM port. By DMA; byte by byte where there is no DMA controller.

use super::byte_serial::BytePort;
use super::device::{DMA1, GPIOB, RCC, USART1};
use super::dma_serial::{self, DmaPort};
use cortex_m::peripheral::NVIC;
use embedded_hal_nb::nb;
use embedded_hal_nb::serial::{ErrorKind, ErrorType, Read, Write};
use rundown::onboard::serial::LinePort;

/// The line.
pub enum SerialPort {
    Dma(DmaPort),
    Bytes(BytePort),
}

impl SerialPort {
    /// Gives USART1 its clock and its pins, and starts it.
    pub fn start(rcc: &RCC, pins: &GPIOB, usart: USART1, dma: DMA1, nvic: &mut NVIC, bus_hz: u32) -> Self {
        rcc.ahb2enr().modify(|_, w| w.gpioben().set_bit());
        rcc.apb2enr().modify(|_, w| w.usart1en().set_bit());
        // The reference manual wants a moment between the enable and the first access; a read makes it.
        let _ = rcc.apb2enr().read();
        // SAFETY: alternate function 7 and mode 2 (alternate) exist for both pins.
        pins.afrl().modify(|_, w| unsafe { w.afrl6().bits(7).afrl7().bits(7) });
        // SAFETY: as above.
        pins.moder().modify(|_, w| unsafe { w.moder6().bits(2).moder7().bits(2) });
        match dma_serial::start(rcc, usart, dma, nvic, bus_hz) {
            Ok(port) => Self::Dma(port),
            Err(usart) => Self::Bytes(BytePort::start(usart, bus_hz)),
        }
    }
}

impl ErrorType for SerialPort {
    type Error = ErrorKind;
}

impl Read<u8> for SerialPort {
    fn read(&mut self) -> nb::Result<u8, ErrorKind> {
        match self {
            Self::Dma(port) => port.read(),
            Self::Bytes(port) => port.read(),
        }
    }
}

impl Write<u8> for SerialPort {
    fn write(&mut self, byte: u8) -> nb::Result<(), ErrorKind> {
        match self {
            Self::Dma(port) => port.write(byte),
            Self::Bytes(port) => port.write(byte),
        }
    }

    fn flush(&mut self) -> nb::Result<(), ErrorKind> {
        match self {
            Self::Dma(port) => port.flush(),
            Self::Bytes(port) => port.flush(),
        }
    }
}

impl LinePort for SerialPort {
    fn interrupt_when_writable(&mut self, on: bool) {
        match self {
            Self::Dma(port) => port.interrupt_when_writable(on),
            Self::Bytes(port) => port.interrupt_when_writable(on),
        }
    }

    fn given_up(&mut self) -> u32 {
        match self {
            Self::Dma(port) => port.given_up(),
            Self::Bytes(_) => 0,
        }
    }
}
