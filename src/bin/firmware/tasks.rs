//! Tasks and priorities (RTIC).
//!
//! | priority | task | woken by | does |
//! |---|---|---|---|
//! | 3 | `line` | serial port | bytes into the ring, bytes out of the outbox |
//! | 3 | in `board` | CAN controller, feature `can` | frames into one queue, frames out of the other |
//! | 2 | `timer` | system timer, 10 Hz | time, watchdog, wakes the two below |
//! | 1 | `tick` | `timer` | every [`PERIOD_S`]: the application's tick |
//! | 1 | `link` | `line`, `timer` | bytes of the ring into the application |
//! | 0 | `idle` | | sleeps |
//!
//! `tick` and `link` have the same priority, so the application needs no lock; `tick` has the lower interrupt number
//! and goes first. Both are woken through the interrupt controller: a wake-up that comes while the task runs makes it
//! run again, none is lost. What the application still has to do after a call is done by `link`, a piece each time it
//! runs, before it takes the next byte; `tick` may run between two pieces, and waits where they are not through.

/// Period of the application's tick, s.
pub const PERIOD_S: u32 = 10;

#[rtic::app(device = crate::board::device, peripherals = false)]
mod app {
    use super::PERIOD_S;
    use crate::board::provisioning::KeyPage;
    use crate::board::stopwatch::{self, Stopwatch, TIMER_HZ};
    use crate::board::{self, Metal, device::Interrupt, kept_ram};
    use crate::can;
    use core::mem::MaybeUninit;
    use core::sync::atomic::{AtomicU32, Ordering};
    use heapless::spsc::{Consumer, Producer, Queue};
    use rtic::mutex_prelude::TupleExt02;
    use rundown::estimator::run_state::RunState;
    use rundown::link::Counters;
    use rundown::onboard::application::{Application, Hardware};
    use rundown::onboard::board::{Board, FailurePoint, Started};
    use rundown::onboard::clock::{Clock, CrystalWatch};
    use rundown::onboard::crash_loop::Operation;
    use rundown::onboard::event::Event;
    use rundown::onboard::kept::{Boot, Kept};
    use rundown::onboard::outbox::{Arriving, Outbox, WhenFull};
    use rundown::onboard::serial::{self, LineErrors};
    use rundown::onboard::task::Room;
    use rundown::onboard::watchdog::{Beats, FeedRule, Watchdog};
    use rundown_wire::{Failure, Health};

    type SerialPort = <Metal as Board>::Port;
    type Dog = <Metal as Board>::Watchdog;
    type Flash = <Metal as Board>::Flash;

    /// Bytes from the line that may wait: 89 ms of it.
    const RING: usize = 1024;
    /// Bytes of frames that may wait: the most that a tick sends, 356 ms of the line.
    const OUTBOX: usize = 4096;
    /// Wakes the tick task: an interrupt of a peripheral that is not used.
    const TICK: Interrupt = Interrupt::COMP;
    /// The same for the link task.
    const LINK: Interrupt = Interrupt::TSC;
    /// Timer periods without a feed after which the reason is written down; the watchdog bites after 20.
    const QUIET_PERIODS: u32 = 5;

    static LINE_ERRORS: LineErrors = LineErrors::new();
    static TICK_BEATS: AtomicU32 = AtomicU32::new(0);
    /// Frames that the line did not take.
    static DROPPED: AtomicU32 = AtomicU32::new(0);
    static LINK_BEATS: AtomicU32 = AtomicU32::new(0);
    /// Timer periods since boot; wraps after 13 years.
    static PERIODS: AtomicU32 = AtomicU32::new(0);

    /// What is known since the start.
    #[derive(Clone, Copy)]
    pub struct Start {
        boot: Boot,
        clock: Clock,
        crystal: CrystalWatch,
        can: can::Counts,
    }

    #[shared]
    struct Shared {
        /// With the line's interrupt.
        port: SerialPort,
        outbox: &'static mut Outbox<OUTBOX>,
        #[lock_free]
        can: can::Line,
        #[lock_free]
        start: Start,
        #[lock_free]
        application: &'static mut Application<'static, Flash, KeyPage>,
    }

    #[local]
    struct Local {
        ring_in: Producer<'static, u8>,
        ring_out: Consumer<'static, u8>,
        watchdog: Dog,
        feed_rule: FeedRule,
        quiet_periods: u32,
        kept: Kept,
        next_tick: u32,
    }

    #[init(local = [ring: Queue<u8, RING> = Queue::new(), application: MaybeUninit<Application<'static, Flash, KeyPage>> = MaybeUninit::uninit(), run: RunState = RunState::ZEROED, outbox: Outbox<OUTBOX> = Outbox::new(), room: Room = Room::EMPTY])]
    fn init(cx: init::Context) -> (Shared, Local) {
        // The chip's registers are taken once, here; if they were not free something is very wrong, and a reset is the
        // answer.
        let Some(Started { port, watchdog, flash, clock, cause }) = Metal::start(cx.core) else {
            cortex_m::peripheral::SCB::sys_reset()
        };
        let (kept, boot) = Kept::boot(kept_ram::load(), cause);
        kept_ram::store(&kept);
        log(&Event::boot(&boot, clock.hz()));
        let heartbeat_only = boot.operation == Operation::HeartbeatOnly;
        let application = place(cx.local.application, flash, heartbeat_only, cx.local.run, cx.local.room);
        let can = can::Line::start(clock.hz(), &LINE_ERRORS);
        let (ring_in, ring_out) = cx.local.ring.split();
        rtic::pend(TICK);
        rtic::pend(LINK);
        (
            Shared {
                port,
                outbox: cx.local.outbox,
                can,
                start: Start { boot, clock, crystal: CrystalWatch::default(), can: can::Counts::NONE },
                application,
            },
            Local { ring_in, ring_out, watchdog, feed_rule: FeedRule::default(), quiet_periods: 0, kept, next_tick: 0 },
        )
    }

    #[idle]
    fn idle(_: idle::Context) -> ! {
        loop {
            cortex_m::asm::wfi();
        }
    }

    #[task(binds = USART1, priority = 3, shared = [port, outbox], local = [ring_in])]
    fn line(cx: line::Context) {
        let ring = cx.local.ring_in;
        let served =
            (cx.shared.port, cx.shared.outbox).lock(|port, outbox| serial::serve(port, ring, outbox, &LINE_ERRORS));
        if served.came {
            rtic::pend(LINK);
        }
        if served.more {
            rtic::pend(Interrupt::USART1);
        }
    }

    #[task(binds = SysTick, priority = 2, local = [watchdog, feed_rule, quiet_periods, kept])]
    fn timer(cx: timer::Context) {
        let local = cx.local;
        let periods = PERIODS.load(Ordering::Relaxed).wrapping_add(1);
        PERIODS.store(periods, Ordering::Relaxed);
        if periods.is_multiple_of(TIMER_HZ) {
            local.kept.crash_loop.second();
            kept_ram::store(local.kept);
        }
        let beats = Beats { tick: TICK_BEATS.load(Ordering::Relaxed), link: LINK_BEATS.load(Ordering::Relaxed) };
        match local.feed_rule.ask(beats) {
            Ok(()) => {
                local.watchdog.feed();
                *local.quiet_periods = 0;
                local.kept.failure = Failure::None;
            }
            Err(stalled) => {
                *local.quiet_periods += 1;
                if *local.quiet_periods >= QUIET_PERIODS {
                    local.kept.failure = Failure::Stalled(stalled);
                    kept_ram::store(local.kept);
                }
            }
        }
        rtic::pend(TICK);
        rtic::pend(LINK);
    }

    #[task(binds = COMP, priority = 1, shared = [port, outbox, can, start, application], local = [next_tick])]
    fn tick(cx: tick::Context) {
        if cx.shared.start.boot.operation == Operation::Normal {
            Metal::provoke(FailurePoint::Tick);
        }
        let periods = PERIODS.load(Ordering::Relaxed);
        // The difference, because the counter wraps. Where something is still to be done `link` does it, and wakes this
        // task again.
        if periods.wrapping_sub(*cx.local.next_tick) < u32::MAX / 2 && !cx.shared.application.is_busy() {
            *cx.local.next_tick = cx.local.next_tick.wrapping_add(PERIOD_S * TIMER_HZ);
            let (start, mut say) = (*cx.shared.start, say(cx.shared.port, cx.shared.outbox, cx.shared.can));
            let watch = Stopwatch::start();
            cx.shared.application.tick(start, &mut say);
            watch.stop();
            if cx.shared.application.is_busy() {
                rtic::pend(LINK);
            }
        }
        TICK_BEATS.fetch_add(1, Ordering::Relaxed);
    }

    #[task(binds = TSC, priority = 1, shared = [port, outbox, can, start, application], local = [ring_out])]
    fn link(cx: link::Context) {
        if cx.shared.start.boot.operation == Operation::Normal {
            Metal::provoke(FailurePoint::Link);
        }
        if cx.shared.start.crystal.is_missed(Metal::trim_clock(), uptime_s()) {
            log(&Event::CrystalMissed);
        }
        if serve(cx) {
            rtic::pend(LINK);
        }
        LINK_BEATS.fetch_add(1, Ordering::Relaxed);
    }

    /// The next piece of what is still to be done or, where there is none, what has come. True: there is more.
    fn serve(cx: link::Context) -> bool {
        let application = cx.shared.application;
        if application.is_busy() {
            let mut say = say(cx.shared.port, cx.shared.outbox, cx.shared.can);
            let watch = Stopwatch::start();
            application.go_on(*cx.shared.start, &mut say);
            watch.stop();
            // A tick may have waited.
            rtic::pend(TICK);
            return true;
        }
        let now_us = stopwatch::now_us(&PERIODS);
        let message = cx.shared.can.exchange(now_us);
        cx.shared.start.can = cx.shared.can.counts();
        let start = *cx.shared.start;
        let mut say = say(cx.shared.port, cx.shared.outbox, cx.shared.can);
        if let Some(message) = message {
            let watch = Stopwatch::start();
            application.receive_message(&message, start, &mut say);
            watch.stop();
        }
        // At most one ring at a time: a line that babbles must not keep the other task waiting.
        for _ in 0..RING {
            if application.is_busy() {
                return true;
            }
            let Some(byte) = cx.local.ring_out.dequeue() else {
                return false;
            };
            let watch = Stopwatch::start();
            application.receive_byte(byte, start, &mut say);
            watch.stop();
        }
        application.is_busy() || cx.local.ring_out.ready()
    }

    /// In a frame of its own, so that the stack of the start is given back.
    #[inline(never)]
    fn place(
        slot: &'static mut MaybeUninit<Application<'static, Flash, KeyPage>>,
        flash: Flash,
        heartbeat_only: bool,
        run: &'static mut RunState,
        room: &'static mut Room,
    ) -> &'static mut Application<'static, Flash, KeyPage> {
        slot.write(Application::new(KeyPage, flash, heartbeat_only, run, room))
    }

    /// Puts a frame into the outbox and starts the line.
    // One type for both tasks, so that the application is in the image once.
    fn say(
        port: impl rtic::Mutex<T = SerialPort>,
        outbox: impl rtic::Mutex<T = &'static mut Outbox<OUTBOX>>,
        can: &mut can::Line,
    ) -> impl FnMut(&[u8], WhenFull) -> bool {
        let mut wires = (port, outbox);
        move |frame, when_full| {
            can.push(frame, when_full);
            let mut arriving = Arriving::new(frame, when_full);
            // A lock a piece: the line's interrupt waits for none of them for long.
            let taken = loop {
                match wires.lock(|_, outbox| outbox.take(&mut arriving)) {
                    Ok(false) => {}
                    taken => break taken.is_ok(),
                }
            };
            wires.lock(|port, outbox| {
                DROPPED.store(outbox.dropped(), Ordering::Relaxed);
                stopwatch::apart(|| serial::send(port, outbox));
            });
            taken
        }
    }

    fn uptime_s() -> u32 {
        PERIODS.load(Ordering::Relaxed) / TIMER_HZ
    }

    /// To the debugger.
    #[inline(never)]
    fn log(event: &Event) {
        if event.is_trouble() {
            defmt::warn!("{}", event);
        } else {
            defmt::info!("{}", event);
        }
    }

    impl Hardware for Start {
        fn health(&self) -> Health {
            Health {
                uptime_s: uptime_s(),
                reset_cause: self.boot.cause,
                failure: self.boot.failure,
                resets: self.boot.resets,
                slow_clock: self.clock != Clock::Fast,
                stack_bytes: board::painted_stack::high_water(),
                longest_us: stopwatch::longest_us(),
                flash_errors: Metal::flash_errors(),
                line: self.crystal.counted(LINE_ERRORS.counts()),
                not_sent: DROPPED.load(Ordering::Relaxed).saturating_add(self.can.dropped()),
                ..Health::default()
            }
        }

        fn other_links(&self) -> Counters {
            self.can.link()
        }

        fn uptime_s(&self) -> Option<u32> {
            Some(uptime_s())
        }

        fn log(&self, event: &Event) {
            log(event);
        }
    }
}
