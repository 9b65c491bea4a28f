//! Registers and buffers of USART1 and its channels of DMA1; the sequence is in `rundown::onboard::stm32l4_serial`.

use super::super::BAUD;
use super::device::{DMA1, Interrupt, RCC, USART1, unmask_as_line};
use core::cell::UnsafeCell;
use cortex_m::peripheral::NVIC;
use rundown::onboard::stm32l4_serial::{
    Block, Channel, RECEIVE, SEND, SerialController, SerialRegister, Stm32l4Serial,
};

pub type DmaPort = Stm32l4Serial<Controller>;

/// Memory that a channel reads or writes.
#[repr(align(4))]
struct Buffer<const N: usize>(UnsafeCell<[u8; N]>);

// SAFETY: touched by a channel, and by the one `Controller`, byte by byte and volatile.
unsafe impl<const N: usize> Sync for Buffer<N> {}

static RECEIVED: Buffer<RECEIVE> = Buffer(UnsafeCell::new([0; RECEIVE]));
static SENT: Buffer<SEND> = Buffer(UnsafeCell::new([0; SEND]));

/// USART1, channels 4 and 5 of DMA1, and their buffers.
pub struct Controller {
    usart: USART1,
    _dma: DMA1,
}

/// Starts the line and the interrupts of its channels; USART1 comes back where there is no DMA controller. Pins and
/// USART1's clock are there, interrupts are off.
pub fn start(rcc: &RCC, usart: USART1, dma: DMA1, nvic: &mut NVIC, bus_hz: u32) -> Result<DmaPort, USART1> {
    rcc.ahb1enr().modify(|_, w| w.dma1en().set_bit());
    // The reference manual wants a moment between the enable and the first access; a read makes it.
    let _ = rcc.ahb1enr().read();
    let controller = Controller { usart, _dma: dma };
    let port = Stm32l4Serial::start(controller, (bus_hz + BAUD / 2) / BAUD).map_err(|controller| controller.usart)?;
    // SAFETY: their handler is the line's task itself.
    unsafe { unmask_as_line(nvic, [Interrupt::DMA1_CH4, Interrupt::DMA1_CH5]) };
    Ok(port)
}

impl Controller {
    fn at(register: SerialRegister) -> *mut u32 {
        let (block, offset) = register.place();
        let base = match block {
            Block::Usart => USART1::ptr().cast::<u32>(),
            Block::Dma => DMA1::ptr().cast::<u32>(),
        };
        base.cast_mut().wrapping_byte_add(offset)
    }
}

impl SerialController for Controller {
    fn register(&mut self, register: SerialRegister) -> u32 {
        // SAFETY: a register of one of the two blocks, aligned; `self` owns them.
        unsafe { Self::at(register).read_volatile() }
    }

    fn set_register(&mut self, register: SerialRegister, bits: u32) {
        // What was collected is in memory before a channel is enabled.
        cortex_m::asm::dmb();
        // SAFETY: as above; the sequence gives a channel no other memory than the buffers here, and no more than their
        // length.
        unsafe { Self::at(register).write_volatile(bits) }
    }

    fn addresses(&self, channel: Channel) -> (u32, u32) {
        let usart = USART1::ptr() as u32;
        match channel {
            Channel::Send => (usart + 0x28, SENT.0.get() as u32),
            Channel::Receive => (usart + 0x24, RECEIVED.0.get() as u32),
        }
    }

    fn received(&mut self, at: usize) -> u8 {
        // SAFETY: within the buffer; volatile, because a channel writes it.
        unsafe { RECEIVED.0.get().cast::<u8>().add(at % RECEIVE).read_volatile() }
    }

    fn collect(&mut self, at: usize, byte: u8) {
        // SAFETY: within the buffer, which no channel reads while bytes are collected.
        unsafe { SENT.0.get().cast::<u8>().add(at % SEND).write_volatile(byte) }
    }
}
