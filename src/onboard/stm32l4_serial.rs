//! How an STM32L4 receives and sends a serial line by DMA (RM0351 chapters 11 and 40), free of registers so that the
//! host tests it.
//!
//! In: a controller's registers and its two buffers ([`SerialController`]). Out: a port as `serial` serves it.
//!
//! - Receive: a channel writes each byte into a circular buffer; nothing is lost while the processor is elsewhere.
//!   Interrupts at half of the buffer, at its end, and when the line falls idle say that bytes are there.
//! - Send: bytes are collected in a buffer and go as one transfer; its end is an interrupt. While it runs the buffer
//!   belongs to the channel.
//!
//! Each flag that asks for an interrupt is cleared where it is looked at: one that stays would ask for ever.

use super::serial::LinePort;
use embedded_hal_nb::nb;
use embedded_hal_nb::serial::{ErrorKind, ErrorType, Read, Write};

/// Bytes of the circular buffer: 44 ms at 115 200 bit/s.
pub const RECEIVE: usize = 512;
/// Bytes that go as one transfer, 2.8 ms; collecting them takes the processor 11 to 18 µs, in which its interrupt
/// waits.
pub const SEND: usize = 32;

/// Registers, by block: those of the USART, those of the DMA controller.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SerialRegister {
    /// USART_CR1.
    Control,
    /// USART_CR3.
    Dma,
    /// USART_BRR.
    Divider,
    /// USART_ISR.
    Status,
    /// USART_ICR; a 1 clears.
    Clear,
    /// DMA_ISR.
    Flags,
    /// DMA_IFCR; a 1 clears.
    ClearFlags,
    /// DMA_CSELR: which device a channel serves.
    Requests,
    /// DMA_CCR of a channel.
    ChannelControl(Channel),
    /// DMA_CNDTR: transfers that are left.
    Left(Channel),
    /// DMA_CPAR.
    Device(Channel),
    /// DMA_CMAR.
    Memory(Channel),
}

/// The channels of USART1 on DMA1.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Channel {
    /// Channel 4.
    Send,
    /// Channel 5.
    Receive,
}

/// Block of a register.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Block {
    /// The serial port.
    Usart,
    /// The DMA controller.
    Dma,
}

impl SerialRegister {
    /// Block and offset in it, bytes.
    pub const fn place(self) -> (Block, usize) {
        match self {
            Self::Control => (Block::Usart, 0x00),
            Self::Dma => (Block::Usart, 0x08),
            Self::Divider => (Block::Usart, 0x0C),
            Self::Status => (Block::Usart, 0x1C),
            Self::Clear => (Block::Usart, 0x20),
            Self::Flags => (Block::Dma, 0x00),
            Self::ClearFlags => (Block::Dma, 0x04),
            Self::Requests => (Block::Dma, 0xA8),
            Self::ChannelControl(channel) => (Block::Dma, 0x08 + channel.offset()),
            Self::Left(channel) => (Block::Dma, 0x0C + channel.offset()),
            Self::Device(channel) => (Block::Dma, 0x10 + channel.offset()),
            Self::Memory(channel) => (Block::Dma, 0x14 + channel.offset()),
        }
    }
}

impl Channel {
    /// Counted from 0.
    const fn index(self) -> u32 {
        match self {
            Self::Send => 3,
            Self::Receive => 4,
        }
    }

    const fn offset(self) -> usize {
        20 * self.index() as usize
    }

    /// A flag of the channel.
    const fn flag(self, flag: u32) -> u32 {
        flag << (4 * self.index())
    }
}

/// Bits of the USART; errors and idle have the same place in status and clear.
pub mod usart {
    /// Enabled; receiver, transmitter, interrupt when the line falls idle.
    pub const ENABLED: u32 = 1 << 0 | 1 << 2 | 1 << 3 | 1 << 4;
    /// Both ways by DMA, and an interrupt for errors.
    pub const BY_DMA: u32 = 1 << 0 | 1 << 6 | 1 << 7;
    /// A byte without its stop bit.
    pub const FRAMING: u32 = 1 << 1;
    /// The samples of a bit disagreed.
    pub const NOISE: u32 = 1 << 2;
    /// A byte came before the last one was fetched.
    pub const OVERRUN: u32 = 1 << 3;
    /// The line fell idle.
    pub const IDLE: u32 = 1 << 4;
    /// The last byte is on the line.
    pub const GONE: u32 = 1 << 6;
}

/// Bits of the DMA controller: flags of a channel, and its control register.
pub mod dma {
    /// All flags of a channel.
    pub const ALL: u32 = 0xF;
    /// Any of them; written to the clearing register it clears all, those too that were set meanwhile.
    pub const ANY: u32 = 1 << 0;
    /// The whole transfer is done.
    pub const DONE: u32 = 1 << 1;
    /// Half of it.
    pub const HALF: u32 = 1 << 2;
    /// The bus refused.
    pub const ERROR: u32 = 1 << 3;
    /// Of the control register: runs.
    pub const ENABLE: u32 = 1 << 0;
    /// Interrupts: done, error.
    pub const TELLS: u32 = 1 << 1 | 1 << 3;
    /// Interrupt: half.
    pub const TELLS_HALF: u32 = 1 << 2;
    /// From memory to the device.
    pub const OUT: u32 = 1 << 4;
    /// Begins again at the front.
    pub const CIRCULAR: u32 = 1 << 5;
    /// The next byte of the memory each time.
    pub const NEXT: u32 = 1 << 7;
    /// The request of USART1, of both channels.
    pub const USART1: u32 = 2;
}

/// Registers and buffers.
pub trait SerialController {
    /// Reads a register.
    fn register(&mut self, register: SerialRegister) -> u32;
    /// Writes one.
    fn set_register(&mut self, register: SerialRegister, bits: u32);
    /// Address of the device's data register, and of the channel's buffer.
    fn addresses(&self, channel: Channel) -> (u32, u32);
    /// A byte of the buffer that the channel fills; `at` below [`RECEIVE`].
    fn received(&mut self, at: usize) -> u8;
    /// Sets a byte of the buffer that the channel reads; `at` below [`SEND`].
    fn collect(&mut self, at: usize, byte: u8);
}

/// USART1 by DMA.
#[derive(Debug)]
pub struct Stm32l4Serial<C> {
    controller: C,
    /// Place of the next byte to be read.
    next: usize,
    /// Bytes collected; being sent if `sending`.
    collected: usize,
    sending: bool,
    /// Bytes that were received and dropped with the last error.
    given_up: u32,
}

impl<C: SerialController> Stm32l4Serial<C> {
    /// Starts both ways. `divider`: of the clock, for the speed of the line.
    ///
    /// # Errors
    /// The controller comes back where a channel does not keep what is written into it: there is none, as in the
    /// emulator.
    pub fn start(controller: C, divider: u32) -> Result<Self, C> {
        let mut serial = Self { controller, next: 0, collected: 0, sending: false, given_up: 0 };
        let requests = serial.get(SerialRegister::Requests);
        let of = |channel: Channel, value: u32| value << (4 * channel.index());
        let ours = of(Channel::Send, 0xF) | of(Channel::Receive, 0xF);
        let usart = of(Channel::Send, dma::USART1) | of(Channel::Receive, dma::USART1);
        serial.set(SerialRegister::Requests, requests & !ours | usart);
        for channel in [Channel::Send, Channel::Receive] {
            let (device, memory) = serial.controller.addresses(channel);
            serial.set(SerialRegister::ChannelControl(channel), 0);
            serial.set(SerialRegister::ClearFlags, channel.flag(dma::ALL));
            serial.set(SerialRegister::Device(channel), device);
            serial.set(SerialRegister::Memory(channel), memory);
            if serial.get(SerialRegister::Memory(channel)) != memory {
                return Err(serial.controller);
            }
        }
        serial.receive();
        serial.set(SerialRegister::Divider, divider);
        serial.set(SerialRegister::Dma, usart::BY_DMA);
        serial.set(SerialRegister::Control, usart::ENABLED);
        Ok(serial)
    }

    /// The receiving channel begins at the front.
    fn receive(&mut self) {
        let channel = Channel::Receive;
        self.set(SerialRegister::ChannelControl(channel), 0);
        self.set(SerialRegister::ClearFlags, channel.flag(dma::ALL));
        self.set(SerialRegister::Left(channel), RECEIVE as u32);
        let control = dma::NEXT | dma::CIRCULAR | dma::TELLS | dma::TELLS_HALF | dma::ENABLE;
        self.set(SerialRegister::ChannelControl(channel), control);
        self.next = 0;
    }

    /// An error of the line, cleared.
    fn line_error(&mut self) -> Option<ErrorKind> {
        let status = self.get(SerialRegister::Status);
        let of = |flag: u32, kind: ErrorKind| (status & flag != 0).then_some((flag, kind));
        let error = of(usart::OVERRUN, ErrorKind::Overrun)
            .or(of(usart::FRAMING, ErrorKind::FrameFormat))
            .or(of(usart::NOISE, ErrorKind::Noise));
        let flag = error.map_or(0, |(flag, _)| flag);
        if status & (usart::IDLE | flag) != 0 {
            self.set(SerialRegister::Clear, status & usart::IDLE | flag);
        }
        error.map(|(_, kind)| kind)
    }

    /// What the receiving channel says of itself, cleared.
    fn channel_error(&mut self) -> Option<ErrorKind> {
        let channel = Channel::Receive;
        let flags = self.get(SerialRegister::Flags) & channel.flag(dma::ALL & !dma::ANY);
        let both = channel.flag(dma::HALF | dma::DONE);
        let turned = flags & both == both;
        if flags & channel.flag(dma::ERROR) != 0 {
            self.given_up = self.unread(turned);
            self.receive();
            return Some(ErrorKind::Other);
        }
        if flags != 0 {
            self.set(SerialRegister::ClearFlags, flags);
        }
        if turned {
            // Both since the last look: what was not read may have been written over.
            self.given_up = self.unread(turned);
            self.next = self.written();
            return Some(ErrorKind::Overrun);
        }
        None
    }

    /// Where the receiving channel writes next.
    fn written(&mut self) -> usize {
        let left = self.get(SerialRegister::Left(Channel::Receive)) as usize;
        // At the end it counts from the whole again.
        RECEIVE.saturating_sub(left) % RECEIVE
    }

    /// Bytes that came and were not read. Where the channel has `turned`, passed both half and end, it has gone round
    /// once more if it stands before the second of these; that it went round more often nothing says.
    fn unread(&mut self, turned: bool) -> u32 {
        let unread = (RECEIVE + self.written() - self.next) % RECEIVE;
        let passes_both = RECEIVE - self.next % (RECEIVE / 2);
        let more = if turned && unread < passes_both { RECEIVE } else { 0 };
        (unread + more) as u32
    }

    /// Looks whether the transfer is over.
    fn sent(&mut self) -> bool {
        let channel = Channel::Send;
        let over = channel.flag(dma::DONE | dma::ERROR);
        if self.sending && self.get(SerialRegister::Flags) & over != 0 {
            self.set(SerialRegister::ChannelControl(channel), 0);
            self.set(SerialRegister::ClearFlags, channel.flag(dma::ALL));
            (self.sending, self.collected) = (false, 0);
        }
        !self.sending
    }

    fn get(&mut self, register: SerialRegister) -> u32 {
        self.controller.register(register)
    }

    fn set(&mut self, register: SerialRegister, bits: u32) {
        self.controller.set_register(register, bits);
    }
}

impl<C> ErrorType for Stm32l4Serial<C> {
    type Error = ErrorKind;
}

impl<C: SerialController> Read<u8> for Stm32l4Serial<C> {
    fn read(&mut self) -> nb::Result<u8, ErrorKind> {
        if let Some(error) = self.line_error().or_else(|| self.channel_error()) {
            return Err(nb::Error::Other(error));
        }
        if self.next == self.written() {
            return Err(nb::Error::WouldBlock);
        }
        let byte = self.controller.received(self.next);
        self.next = (self.next + 1) % RECEIVE;
        Ok(byte)
    }
}

impl<C: SerialController> Write<u8> for Stm32l4Serial<C> {
    fn write(&mut self, byte: u8) -> nb::Result<(), ErrorKind> {
        if !self.sent() || self.collected == SEND {
            return Err(nb::Error::WouldBlock);
        }
        self.controller.collect(self.collected, byte);
        self.collected += 1;
        Ok(())
    }

    fn flush(&mut self) -> nb::Result<(), ErrorKind> {
        let gone = self.get(SerialRegister::Status) & usart::GONE != 0;
        if self.sent() && self.collected == 0 && gone { Ok(()) } else { Err(nb::Error::WouldBlock) }
    }
}

impl<C: SerialController> LinePort for Stm32l4Serial<C> {
    /// Sends what is collected; its end is an interrupt, asked for or not.
    fn interrupt_when_writable(&mut self, _: bool) {
        if !self.sent() || self.collected == 0 {
            return;
        }
        let channel = Channel::Send;
        self.set(SerialRegister::Left(channel), self.collected as u32);
        self.set(SerialRegister::ChannelControl(channel), dma::NEXT | dma::OUT | dma::TELLS | dma::ENABLE);
        self.sending = true;
    }

    fn given_up(&mut self) -> u32 {
        core::mem::take(&mut self.given_up)
    }
}

#[cfg(test)]
mod tests;
