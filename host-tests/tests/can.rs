//! Does the board's CAN controller carry messages: filters, full mailboxes, overrun, bus-off, a controller that does
//! not answer?

use embedded_can::{ExtendedId, Frame, Id, StandardId};
use heapless::spsc::Queue;
use host_tests::can_controller::{CanSilicon, FIFO};
use rundown::link::Link;
use rundown::link::can::CanFrame;
use rundown::link::can_link::{CanLink, FROM_BOARD, TO_BOARD};
use rundown::link::isotp::Config;
use rundown::link::serial;
use rundown::onboard::can::bxcan::{Bxcan, CanRegister, MOST_PER_CALL, NoController, control};
use rundown::onboard::can::line::CanLine;
use rundown::onboard::can::timing::BitTiming;
use rundown::onboard::can::{Ends, Mailbox};
use rundown::onboard::clock::MOST_POLLS;
use rundown::onboard::outbox::WhenFull;
use rundown::onboard::serial::{LineCounts, LineErrors};
use std::cell::RefCell;
use std::convert::Infallible;

const TIMING: BitTiming = match BitTiming::new(80_000_000, 250_000) {
    Ok(timing) => timing,
    Err(_) => panic!("250 kbit/s"),
};

fn own_id() -> StandardId {
    match TO_BOARD {
        Id::Standard(id) => id,
        Id::Extended(_) => panic!("a standard identifier"),
    }
}

fn up(silicon: CanSilicon) -> Bxcan<CanSilicon> {
    Bxcan::start(silicon, TIMING, own_id()).unwrap()
}

fn frame(id: Id, number: u8) -> CanFrame {
    CanFrame::new(id, &[number]).unwrap()
}

/// Interrupts until there is none; one that never ends fails.
fn interrupts<const I: usize, const O: usize>(
    can: &mut Bxcan<CanSilicon>,
    incoming: &mut Queue<Mailbox, I>,
    outgoing: &mut Queue<Mailbox, O>,
    errors: &LineErrors,
) {
    for _ in 0..20 {
        if !can.registers().interrupts() {
            return;
        }
        can.serve(&mut incoming.split().0, &mut outgoing.split().1, errors);
    }
    panic!("the interrupt does not end");
}

fn numbers<const N: usize>(queue: &mut Queue<Mailbox, N>) -> Vec<u8> {
    std::iter::from_fn(|| queue.dequeue()).map(|mailbox| mailbox.frame().unwrap().data()[0]).collect()
}

#[test]
fn it_comes_up_with_its_timing_and_is_left_on_the_bus() {
    let mut can = up(CanSilicon::default());
    let silicon = can.registers();
    assert_eq!(silicon.violations, [""; 0]);
    assert_eq!(silicon.bits(CanRegister::TIMING), TIMING.bits());
    assert!(silicon.is_on_bus());
    // The debugger's bit, which the reset sets, stays.
    let expected = 1 << 16 | control::RECOVER | control::IN_ORDER | control::KEEP_OLDEST;
    assert_eq!(silicon.bits(CanRegister::CONTROL), expected);
}

#[test]
fn a_controller_that_does_not_answer_costs_bounded_polls() {
    for (dead, mode_polls) in [(true, 0), (false, u32::MAX)] {
        let mut silicon = CanSilicon::default();
        (silicon.dead, silicon.mode_polls) = (dead, mode_polls);
        let started = Bxcan::start(&mut silicon, TIMING, own_id());
        assert_eq!(started.map(|_| ()), Err(NoController));
        assert!(silicon.accesses <= u64::from(MOST_POLLS) + 2, "{}", silicon.accesses);
    }
}

#[test]
fn only_data_frames_with_the_boards_identifier_are_taken() {
    let mut can = up(CanSilicon::default());
    let (mut incoming, mut outgoing) = (Queue::<Mailbox, 16>::new(), Queue::<Mailbox, 4>::new());
    let errors = LineErrors::new();
    let same_bits = ExtendedId::new(u32::from(own_id().as_raw()) << 18).unwrap();
    for other in (0..0x800).filter_map(StandardId::new).filter(|id| *id != own_id()) {
        can.registers().bus_brings(&frame(other.into(), 1));
    }
    can.registers().bus_brings(&frame(same_bits.into(), 2));
    can.registers().bus_brings(&CanFrame::new_remote(own_id(), 1).unwrap());
    assert!(!can.registers().interrupts());
    can.registers().bus_brings(&frame(TO_BOARD, 3));
    interrupts(&mut can, &mut incoming, &mut outgoing, &errors);
    assert_eq!(numbers(&mut incoming), [3]);
    assert_eq!(errors.counts(), LineCounts::default());
}

#[test]
fn full_mailboxes_keep_the_order_and_the_rest_waits() {
    let mut can = up(CanSilicon::default());
    let (mut incoming, mut outgoing) = (Queue::<Mailbox, 4>::new(), Queue::<Mailbox, 16>::new());
    let errors = LineErrors::new();
    for number in 0..10 {
        outgoing.enqueue(Mailbox::of(&frame(FROM_BOARD, number)).unwrap()).unwrap();
    }
    let mut serve = |can: &mut Bxcan<CanSilicon>| {
        can.serve(&mut incoming.split().0, &mut outgoing.split().1, &errors);
        outgoing.len()
    };
    assert_eq!(serve(&mut can), 7);
    // Woken again for nothing: what is under way stays as it is.
    assert_eq!(serve(&mut can), 7);
    let mut sent = Vec::new();
    for turn in 0..10 {
        // Now and then several have gone before the interrupt is served.
        let taken = can.registers().bus_takes().unwrap();
        assert_eq!(taken.id(), FROM_BOARD);
        sent.push(taken.data()[0]);
        if turn % 3 != 0 {
            serve(&mut can);
        }
    }
    assert_eq!(sent, (0..10).collect::<Vec<_>>());
    serve(&mut can);
    assert!(!can.registers().interrupts(), "nothing is left to do");
    assert_eq!(can.registers().violations, [""; 0]);
}

#[test]
fn an_overrun_is_counted_and_the_frames_before_it_arrive_once() {
    for release_polls in [0, 1, 7] {
        let mut can = up(CanSilicon::default());
        can.registers().release_polls = release_polls;
        let (mut incoming, mut outgoing) = (Queue::<Mailbox, 16>::new(), Queue::<Mailbox, 4>::new());
        let errors = LineErrors::new();
        (0..10).for_each(|number| can.registers().bus_brings(&frame(TO_BOARD, number)));
        interrupts(&mut can, &mut incoming, &mut outgoing, &errors);
        assert_eq!(numbers(&mut incoming), (0..FIFO as u8).collect::<Vec<_>>());
        assert_eq!(errors.counts(), LineCounts { overrun: 1, ..LineCounts::default() });
        can.registers().bus_brings(&frame(TO_BOARD, 10));
        interrupts(&mut can, &mut incoming, &mut outgoing, &errors);
        assert_eq!(numbers(&mut incoming), [10]);
        assert_eq!(can.registers().violations, [""; 0]);
    }
}

#[test]
fn a_release_that_never_ends_costs_bounded_accesses() {
    let mut can = up(CanSilicon::default());
    can.registers().release_polls = u32::MAX - 1;
    let (mut incoming, mut outgoing) = (Queue::<Mailbox, 16>::new(), Queue::<Mailbox, 4>::new());
    can.registers().bus_brings(&frame(TO_BOARD, 1));
    let before = can.registers().accesses;
    can.serve(&mut incoming.split().0, &mut outgoing.split().1, &LineErrors::new());
    assert!(can.registers().accesses - before < 200);
    assert_eq!(numbers(&mut incoming), [1]);
}

#[test]
fn a_full_queue_drops_the_newest_and_counts() {
    let mut can = up(CanSilicon::default());
    let (mut incoming, mut outgoing) = (Queue::<Mailbox, 5>::new(), Queue::<Mailbox, 4>::new());
    let errors = LineErrors::new();
    for number in 0..MOST_PER_CALL as u8 {
        can.registers().bus_brings(&frame(TO_BOARD, number));
        interrupts(&mut can, &mut incoming, &mut outgoing, &errors);
    }
    assert_eq!(numbers(&mut incoming), [0, 1, 2, 3]);
    assert_eq!(errors.counts(), LineCounts { ring_full: 2, ..LineCounts::default() });
}

#[test]
fn bus_off_is_counted_and_what_waited_goes_out_after_the_recovery() {
    let mut can = up(CanSilicon::default());
    let (mut incoming, mut outgoing) = (Queue::<Mailbox, 4>::new(), Queue::<Mailbox, 16>::new());
    let errors = LineErrors::new();
    for number in 0..5 {
        outgoing.enqueue(Mailbox::of(&frame(FROM_BOARD, number)).unwrap()).unwrap();
    }
    can.serve(&mut incoming.split().0, &mut outgoing.split().1, &errors);
    let mut sent = Vec::new();
    for times in 1..=3 {
        can.registers().bus_goes_off();
        interrupts(&mut can, &mut incoming, &mut outgoing, &errors);
        assert_eq!(errors.counts(), LineCounts { other: times, ..LineCounts::default() });
        assert_eq!(can.registers().bus_takes(), None);
        can.registers().bus_is_quiet();
        sent.extend(can.registers().bus_takes().map(|frame| frame.data()[0]));
        interrupts(&mut can, &mut incoming, &mut outgoing, &errors);
    }
    assert_eq!(sent, [0, 1, 2]);
    can.registers().bus_brings(&frame(TO_BOARD, 9));
    interrupts(&mut can, &mut incoming, &mut outgoing, &errors);
    assert_eq!(numbers(&mut incoming), [9]);
}

/// The board's registers as a controller of the host's side: the bus between them.
struct Bus<'a>(&'a RefCell<Bxcan<CanSilicon>>);

impl embedded_can::nb::Can for Bus<'_> {
    type Frame = CanFrame;
    type Error = Infallible;

    fn transmit(&mut self, frame: &CanFrame) -> nb::Result<Option<CanFrame>, Infallible> {
        let mut can = self.0.borrow_mut();
        // A frame takes longer than its interrupt.
        if can.registers().interrupts() {
            return Err(nb::Error::WouldBlock);
        }
        can.registers().bus_brings(frame);
        Ok(None)
    }

    fn receive(&mut self) -> nb::Result<CanFrame, Infallible> {
        self.0.borrow_mut().registers().bus_takes().ok_or(nb::Error::WouldBlock)
    }
}

fn message(number: u8, length: usize) -> Vec<u8> {
    (0..length).map(|place| number.wrapping_mul(31).wrapping_add(place as u8)).collect()
}

#[test]
fn messages_of_every_size_cross_in_both_directions_in_order() {
    let can = RefCell::new(up(CanSilicon::default()));
    let (mut incoming, mut outgoing) = (Queue::<Mailbox, 33>::new(), Queue::<Mailbox, 17>::new());
    let ((mut in_, taken), (put, mut out)) = (incoming.split(), outgoing.split());
    let mut board = CanLine::<_, 4096>::new(Ends { incoming: taken, outgoing: put });
    let mut host = CanLink::host(Bus(&can), Config::CLASSIC);
    let errors = LineErrors::new();
    let sizes = [1, 3, 4, 20, 81, 255, 511, 512];
    for (number, size) in (0..).zip(sizes) {
        board.push(&serial::encode(&message(number, size)).unwrap(), WhenFull::DropOldest).unwrap();
    }
    let (mut came, mut went, mut questions) = (Vec::new(), Vec::new(), sizes.into_iter().zip(100..));
    for turn in 0..2000 {
        let now_us = turn * 500;
        if !host.is_sending()
            && let Some((size, number)) = questions.next()
        {
            host.send(&message(number, size), now_us).unwrap();
        }
        went.extend(host.receive(now_us).unwrap().map(|message| message.to_vec()));
        can.borrow_mut().serve(&mut in_, &mut out, &errors);
        came.extend(board.exchange(now_us).map(|message| message.to_vec()));
        can.borrow_mut().serve(&mut in_, &mut out, &errors);
    }
    let expected = |first: u8| (0..).zip(sizes).map(|(number, size)| message(first + number, size)).collect::<Vec<_>>();
    assert_eq!(came, expected(100));
    assert_eq!(went, expected(0));
    assert_eq!(errors.counts(), LineCounts::default());
    assert_eq!((board.dropped(), board.counters().sent, board.counters().received), (0, 8, 8));
    assert_eq!(can.borrow_mut().registers().violations, [""; 0]);
}

#[test]
fn with_nobody_on_the_bus_the_newest_messages_wait_and_the_others_are_counted() {
    let can = RefCell::new(up(CanSilicon::default()));
    let (mut incoming, mut outgoing) = (Queue::<Mailbox, 33>::new(), Queue::<Mailbox, 17>::new());
    let ((mut in_, taken), (put, mut out)) = (incoming.split(), outgoing.split());
    let mut board = CanLine::<_, 1024>::new(Ends { incoming: taken, outgoing: put });
    let errors = LineErrors::new();
    // An hour without an acknowledgement.
    let mut now_us = 0;
    for number in 0..=255 {
        board.push(&serial::encode(&message(number, 80)).unwrap(), WhenFull::DropOldest).unwrap();
        for _ in 0..140 {
            now_us += 100_000;
            assert_eq!(board.exchange(now_us), None);
            can.borrow_mut().serve(&mut in_, &mut out, &errors);
        }
    }
    assert!(board.dropped() > 200, "{}", board.dropped());
    let mut host = CanLink::host(Bus(&can), Config::CLASSIC);
    let mut went = Vec::new();
    for _ in 0..20_000 {
        now_us += 1_000;
        went.extend(host.receive(now_us).unwrap().map(|message| message.to_vec()));
        can.borrow_mut().serve(&mut in_, &mut out, &errors);
        board.exchange(now_us);
        can.borrow_mut().serve(&mut in_, &mut out, &errors);
    }
    let newest: Vec<_> = (0..=255).map(|number| message(number, 80)).rev().take(11).rev().collect();
    assert!(went.ends_with(&newest), "{} arrived", went.len());
    // Nothing arrives that was not sent.
    assert!(went.iter().all(|arrived| (0..=255).any(|number| *arrived == message(number, 80))));
}
