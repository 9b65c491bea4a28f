//! A mock of the chip: a line that brings and takes bytes, both channels, and the flags that ask for interrupts.

use super::*;
use crate::onboard::outbox::{Outbox, WhenFull};
use crate::onboard::serial::{self, LineErrors};
use heapless::spsc::Queue;
use rundown_wire::LineCounts;
extern crate std;
use std::vec::Vec;

const DATA: (u32, u32) = (0x4001_3828, 0x4001_3824);
const BUFFERS: (u32, u32) = (0x2000_0100, 0x2000_0400);

/// Channels by [`Channel::index`].
#[derive(Clone, Copy, Debug, Default)]
struct MockChannel {
    control: u32,
    left: u32,
    /// What `left` was when it was enabled.
    whole: u32,
    device: u32,
    memory: u32,
}

#[derive(Debug)]
struct Mock {
    control: u32,
    by_dma: u32,
    divider: u32,
    status: u32,
    flags: u32,
    requests: u32,
    channels: [MockChannel; 5],
    receive: [u8; RECEIVE],
    send: [u8; SEND],
    line: Vec<u8>,
    /// The buffer was written while the channel had it.
    torn: bool,
    /// There is no DMA controller: its registers read zero.
    absent: bool,
    /// Flags that come up right after the next look.
    meanwhile: Option<u32>,
}

impl Mock {
    fn new() -> Self {
        // After a reset flags and requests of others may be anything.
        Self {
            control: 0,
            by_dma: 0,
            divider: 0,
            status: 0,
            flags: u32::MAX,
            requests: 0x0500_0777,
            channels: Default::default(),
            receive: [0; RECEIVE],
            send: [0; SEND],
            line: Vec::new(),
            torn: false,
            absent: false,
            meanwhile: None,
        }
    }

    fn channel(&mut self, channel: Channel) -> &mut MockChannel {
        &mut self.channels[channel.index() as usize]
    }

    /// The line brings a byte.
    fn brings(&mut self, byte: u8) {
        assert_eq!(self.control & usart::ENABLED, usart::ENABLED);
        let channel = *self.channel(Channel::Receive);
        if channel.control & dma::ENABLE == 0 {
            self.status |= usart::OVERRUN;
            return;
        }
        assert_eq!((channel.device, channel.memory), (DATA.1, BUFFERS.1));
        self.receive[(channel.whole - channel.left) as usize] = byte;
        let left = channel.left - 1;
        if left == channel.whole / 2 {
            self.flags |= Channel::Receive.flag(dma::HALF);
        }
        if left == 0 {
            self.flags |= Channel::Receive.flag(dma::DONE);
        }
        self.channel(Channel::Receive).left = if left == 0 { channel.whole } else { left };
    }

    /// Bytes and then silence.
    fn brings_all(&mut self, bytes: &[u8]) {
        bytes.iter().for_each(|byte| self.brings(*byte));
        self.status |= usart::IDLE;
    }

    /// The line takes what is being sent.
    fn takes(&mut self, most: usize) {
        for _ in 0..most {
            let channel = *self.channel(Channel::Send);
            if channel.control & dma::ENABLE == 0 || channel.left == 0 {
                return;
            }
            assert_eq!((channel.device, channel.memory), (DATA.0, BUFFERS.0));
            self.line.push(self.send[(channel.whole - channel.left) as usize]);
            self.channel(Channel::Send).left -= 1;
            if channel.left == 1 {
                self.flags |= Channel::Send.flag(dma::DONE);
            }
        }
    }

    /// The flag of any is up where one of its channel is.
    fn any(&mut self) {
        for channel in [Channel::Send, Channel::Receive] {
            let any = channel.flag(dma::ANY);
            let up = self.flags & channel.flag(dma::ALL) & !any != 0;
            self.flags = if up { self.flags | any } else { self.flags & !any };
        }
    }

    /// An interrupt is asked for.
    fn asks(&self) -> bool {
        let of_channel = |channel: Channel| {
            let control = self.channels[channel.index() as usize].control;
            // Done, half and error have the same place in the flags and in the control register.
            self.flags >> (4 * channel.index()) & control & (dma::TELLS | dma::TELLS_HALF) != 0
        };
        let errors = usart::OVERRUN | usart::FRAMING | usart::NOISE;
        self.status & (usart::IDLE | errors) != 0 || of_channel(Channel::Send) || of_channel(Channel::Receive)
    }
}

impl SerialController for Mock {
    fn register(&mut self, register: SerialRegister) -> u32 {
        match register {
            SerialRegister::Control => self.control,
            SerialRegister::Dma => self.by_dma,
            SerialRegister::Divider => self.divider,
            SerialRegister::Status => {
                let sends = self.channel(Channel::Send).left > 0;
                self.status | if sends { 0 } else { usart::GONE }
            }
            SerialRegister::Clear | SerialRegister::ClearFlags => 0,
            SerialRegister::Flags => {
                self.any();
                let seen = self.flags;
                // Between this look and the clearing of what it saw.
                self.flags |= self.meanwhile.take().unwrap_or_default();
                seen
            }
            SerialRegister::Requests => self.requests,
            SerialRegister::ChannelControl(channel) => self.channel(channel).control,
            SerialRegister::Left(channel) => self.channel(channel).left,
            SerialRegister::Device(channel) => self.channel(channel).device,
            SerialRegister::Memory(channel) => self.channel(channel).memory,
        }
    }

    fn set_register(&mut self, register: SerialRegister, bits: u32) {
        let locked = |mock: &mut Self, channel: Channel| mock.channel(channel).control & dma::ENABLE != 0;
        match register {
            SerialRegister::Control => self.control = bits,
            SerialRegister::Dma => self.by_dma = bits,
            SerialRegister::Divider => self.divider = bits,
            SerialRegister::Clear => self.status &= !bits,
            SerialRegister::ClearFlags => {
                for channel in [Channel::Send, Channel::Receive] {
                    let all = bits & channel.flag(dma::ANY) != 0;
                    self.flags &= !if all { channel.flag(dma::ALL) } else { bits & channel.flag(dma::ALL) };
                }
                self.any();
            }
            SerialRegister::Requests => self.requests = bits,
            SerialRegister::Status | SerialRegister::Flags => panic!("read only"),
            SerialRegister::ChannelControl(channel) => {
                let channel = self.channel(channel);
                channel.control = bits;
                if bits & dma::ENABLE != 0 {
                    channel.whole = channel.left;
                }
            }
            SerialRegister::Left(channel) | SerialRegister::Device(channel) | SerialRegister::Memory(channel)
                if locked(self, channel) =>
            {
                panic!("{register:?} is written while its channel runs")
            }
            SerialRegister::Left(channel) => self.channel(channel).left = bits,
            SerialRegister::Device(channel) => self.channel(channel).device = bits,
            SerialRegister::Memory(_) if self.absent => {}
            SerialRegister::Memory(channel) => self.channel(channel).memory = bits,
        }
    }

    fn addresses(&self, channel: Channel) -> (u32, u32) {
        match channel {
            Channel::Send => (DATA.0, BUFFERS.0),
            Channel::Receive => (DATA.1, BUFFERS.1),
        }
    }

    fn received(&mut self, at: usize) -> u8 {
        self.receive[at]
    }

    fn collect(&mut self, at: usize, byte: u8) {
        let channel = *self.channel(Channel::Send);
        self.torn |= channel.control & dma::ENABLE != 0 && channel.left > 0;
        self.send[at] = byte;
    }
}

/// Port, ring and outbox as the firmware has them.
struct Board {
    port: Stm32l4Serial<Mock>,
    ring: Queue<u8, 2048>,
    outbox: Outbox<8192>,
    errors: LineErrors,
    got: Vec<u8>,
    interrupts: u32,
}

impl Board {
    fn start() -> Self {
        let port = Stm32l4Serial::start(Mock::new(), 694).unwrap();
        let errors = LineErrors::new();
        Self { port, ring: Queue::new(), outbox: Outbox::new(), errors, got: Vec::new(), interrupts: 0 }
    }

    fn chip(&mut self) -> &mut Mock {
        &mut self.port.controller
    }

    /// Interrupts until none is asked for.
    fn serve(&mut self) {
        let mut again = false;
        while self.chip().asks() || again {
            self.interrupts += 1;
            assert!(self.interrupts < 100_000, "an interrupt that never ends");
            let (mut into, _) = self.ring.split();
            again = serial::serve(&mut self.port, &mut into, &mut self.outbox, &self.errors).more;
        }
        self.got.extend(core::iter::from_fn(|| self.ring.dequeue()));
    }

    fn counts(&self) -> LineCounts {
        self.errors.counts()
    }
}

fn bytes(count: usize) -> Vec<u8> {
    (0..count).map(|i| (i * 7 % 251) as u8).collect()
}

#[test]
fn the_start_sets_up_both_channels_and_leaves_those_of_others() {
    let mut board = Board::start();
    let chip = board.chip();
    assert_eq!(chip.requests, 0x0502_2777);
    assert_eq!(chip.divider, 694);
    assert_eq!(chip.by_dma & usart::BY_DMA, usart::BY_DMA);
    assert_eq!(chip.flags & Channel::Receive.flag(dma::ALL), 0);
    assert_eq!(chip.flags & Channel::Send.flag(dma::ALL), 0);
    assert!(!chip.asks());
}

#[test]
fn without_a_dma_controller_the_registers_come_back() {
    let chip = Stm32l4Serial::start(Mock { absent: true, ..Mock::new() }, 694).unwrap_err();
    assert_eq!(chip.control, 0, "the line was not started");
}

#[test]
fn bytes_arrive_in_order_over_many_turns_of_the_buffer_and_after_any_silence() {
    let mut board = Board::start();
    let sent = bytes(20 * RECEIVE + 13);
    let (mut at, mut piece) = (0, 1);
    while at < sent.len() {
        let end = (at + piece).min(sent.len());
        board.chip().brings_all(&sent[at..end]);
        board.serve();
        (at, piece) = (end, piece * 5 % (RECEIVE / 2 - 1) + 1);
    }
    assert_eq!(board.got, sent);
    assert_eq!(board.counts(), LineCounts::default());
}

#[test]
fn a_line_that_never_falls_idle_is_served_at_halves_and_ends() {
    let mut board = Board::start();
    let sent = bytes(4 * RECEIVE);
    for byte in &sent {
        board.chip().brings(*byte);
        board.serve();
    }
    assert_eq!(board.got, sent);
    assert_eq!(board.counts(), LineCounts::default());
    // 16 bytes at a time.
    assert!(board.interrupts as usize <= 1 + sent.len() / serial::MOST_PER_CALL + 8, "{}", board.interrupts);
}

#[test]
fn bytes_that_were_written_over_are_an_overrun_and_the_line_goes_on() {
    let mut board = Board::start();
    board.chip().brings_all(&bytes(RECEIVE + 100));
    board.serve();
    assert!(board.got.is_empty(), "what is left of them is not to be trusted");
    assert_eq!(board.counts().overrun, 1);
    board.chip().brings_all(&[1, 2, 3]);
    board.serve();
    assert_eq!(board.got, [1, 2, 3]);
}

#[test]
fn each_byte_that_was_written_over_is_counted() {
    for read in [0, 1, 100, RECEIVE / 2 - 1, RECEIVE / 2, RECEIVE / 2 + 1, RECEIVE - 1] {
        // From so many on it passes both marks, and from a turn more on nothing says how often it went round.
        let passes_both = RECEIVE - read % (RECEIVE / 2);
        for lost in (1..passes_both + RECEIVE).step_by(3) {
            let mut board = Board::start();
            for piece in bytes(read).chunks(100) {
                board.chip().brings_all(piece);
                board.serve();
            }
            board.chip().brings_all(&bytes(lost));
            board.serve();
            let (counts, overrun) = (board.counts(), lost >= passes_both);
            let dropped = if overrun { lost } else { 0 };
            assert_eq!(counts.overrun, overrun.into(), "{lost} after {read}");
            assert_eq!(counts.ring_full as usize, dropped, "{lost} after {read}");
            assert_eq!(board.got.len(), read + lost - dropped, "{lost} after {read}");
        }
    }
}

#[test]
fn errors_of_the_line_are_counted_once_each() {
    let mut board = Board::start();
    for (flag, count) in [(usart::OVERRUN, 1), (usart::FRAMING, 2), (usart::NOISE, 3)] {
        for _ in 0..count {
            board.chip().status |= flag;
            board.chip().brings_all(&[9]);
            board.serve();
        }
    }
    assert_eq!(board.counts(), LineCounts { overrun: 1, framing: 2, noise: 3, ..LineCounts::default() });
    assert_eq!(board.got, [9; 6]);
}

#[test]
fn a_flag_that_comes_up_between_a_look_and_its_clearing_is_not_lost() {
    let mut board = Board::start();
    board.chip().brings_all(&bytes(RECEIVE / 2 + 1));
    board.chip().meanwhile = Some(Channel::Receive.flag(dma::ERROR));
    board.serve();
    assert_eq!(board.counts().other, 1);
    board.chip().brings_all(&[1, 2]);
    board.serve();
    assert_eq!(board.got[board.got.len() - 2..], [1, 2]);
}

#[test]
fn a_bus_error_starts_the_channel_again() {
    let mut board = Board::start();
    board.chip().brings_all(&[1, 2]);
    board.serve();
    board.chip().flags |= Channel::Receive.flag(dma::ERROR);
    board.chip().channel(Channel::Receive).control &= !dma::ENABLE;
    board.serve();
    assert_eq!(board.counts(), LineCounts { other: 1, ..LineCounts::default() });
    board.chip().brings_all(&[3, 4]);
    board.serve();
    assert_eq!(board.got, [1, 2, 3, 4]);
    // Now before these are read.
    board.chip().brings_all(&bytes(17));
    board.chip().flags |= Channel::Receive.flag(dma::ERROR);
    board.serve();
    assert_eq!(board.counts(), LineCounts { other: 2, ring_full: 17, ..LineCounts::default() });
    assert_eq!(board.got, [1, 2, 3, 4]);
}

#[test]
fn frames_go_in_order_and_a_buffer_that_is_being_sent_is_not_touched() {
    let mut board = Board::start();
    let mut expected = Vec::new();
    for number in 1..=60_u8 {
        let mut frame: Vec<u8> = (0..usize::from(number) * 3 % 200).map(|_| number).collect();
        frame.push(0);
        board.outbox.push(&frame, WhenFull::DropOldest).unwrap();
        expected.extend(frame);
        serial::send(&mut board.port, &mut board.outbox);
        // The line is slower than the frames at first.
        board.chip().takes(usize::from(number) * 5 % 190);
        board.serve();
    }
    for _ in 0..200 {
        board.chip().takes(SEND);
        board.serve();
    }
    assert_eq!(board.outbox.dropped(), 0);
    assert_eq!(board.chip().line, expected);
    assert!(!board.chip().torn);
    assert!(board.outbox.is_empty());
    assert_eq!(board.port.flush(), Ok(()));
}

#[test]
fn a_transfer_that_the_bus_refuses_is_given_up_and_the_next_one_goes() {
    let mut board = Board::start();
    board.outbox.push(&[1, 2, 0], WhenFull::DropOldest).unwrap();
    serial::send(&mut board.port, &mut board.outbox);
    board.chip().flags |= Channel::Send.flag(dma::ERROR);
    board.serve();
    board.outbox.push(&[3, 0], WhenFull::DropOldest).unwrap();
    serial::send(&mut board.port, &mut board.outbox);
    board.chip().takes(SEND);
    board.serve();
    assert_eq!(board.chip().line, [3, 0]);
}
