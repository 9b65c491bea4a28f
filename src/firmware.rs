//! Tasks and priorities (RTIC).
//!
//! | priority | task | woken by | does |
//! |---|---|---|---|
//! | 3 | `line` | serial port | bytes into the ring, bytes out of the outbox |
//! | 2 | `timer` | system timer, 10 Hz | time, watchdog, wakes the two below |
//! | 1 | `tick` | `timer` | every [`PERIOD_S`]: the application's tick, or its heartbeat after too many crashes |
//! | 1 | `link` | `line`, `timer` | bytes of the ring into the application |
//! | 0 | `idle` | | sleeps |
//!
//! `tick` and `link` have the same priority, so the application needs no lock; `tick` has the lower interrupt number and goes first. Both are woken through the
//! interrupt controller: a wake-up that comes while the task runs makes it run again, none is lost.

/// Period of the application's tick, s.
pub const PERIOD_S: u32 = 10;

#[rtic::app(device = crate::board::device, peripherals = false)]
mod app {
    use super::PERIOD_S;
    use crate::application::Application;
    use crate::board::stopwatch::{self, Stopwatch, TIMER_HZ};
    use crate::board::{self, Board, DogTimer, Place, SerialPort, device::Interrupt, kept_ram};
    use core::sync::atomic::{AtomicU32, Ordering};
    use heapless::spsc::{Consumer, Producer, Queue};
    use rundown::onboard::clock::Clock;
    use rundown::onboard::crash_loop::Operation;
    use rundown::onboard::failure::Failure;
    use rundown::onboard::health::Health;
    use rundown::onboard::kept::{Boot, Kept};
    use rundown::onboard::outbox::Outbox;
    use rundown::onboard::serial::{self, LineErrors};
    use rundown::onboard::watchdog::{Beats, FeedRule, Watchdog};

    /// Bytes from the line that may wait: 89 ms of it.
    const RING: usize = 1024;
    /// Bytes of frames that may wait: 178 ms of the line.
    const OUTBOX: usize = 2048;
    /// Timer periods without a feed after which the reason is written down; the watchdog bites after 20.
    const QUIET_PERIODS: u32 = 5;

    static LINE_ERRORS: LineErrors = LineErrors::new();
    static TICK_BEATS: AtomicU32 = AtomicU32::new(0);
    static LINK_BEATS: AtomicU32 = AtomicU32::new(0);
    /// Timer periods since boot; wraps after 13 years.
    static PERIODS: AtomicU32 = AtomicU32::new(0);

    #[shared]
    struct Shared {
        /// With the line's interrupt.
        port: SerialPort,
        outbox: Outbox<OUTBOX>,
        #[lock_free]
        application: &'static mut Application,
    }

    #[local]
    struct Local {
        ring_in: Producer<'static, u8>,
        ring_out: Consumer<'static, u8>,
        watchdog: DogTimer,
        feed_rule: FeedRule,
        quiet_periods: u32,
        kept: Kept,
        boot: Boot,
        clock: Clock,
        next_tick: u32,
        /// Bytes go to the application.
        normal: bool,
    }

    #[init(local = [ring: Queue<u8, RING> = Queue::new(), application: Application = Application::IDLE])]
    fn init(cx: init::Context) -> (Shared, Local) {
        // The chip's registers are taken once, here; if they were not free something is very wrong, and a reset is the answer.
        let Some(Board {
            mut port,
            watchdog,
            flash: _flash,
            clock,
            cause,
        }) = board::start(cx.core)
        else {
            cortex_m::peripheral::SCB::sys_reset()
        };
        let (kept, boot) = Kept::boot(kept_ram::load(), cause);
        kept_ram::store(&kept);
        defmt::info!(
            "boot, clock {=u32} Hz, resets {=u32}",
            clock.hz(),
            boot.resets
        );
        let mut outbox = Outbox::new();
        let application = cx.local.application;
        if boot.operation == Operation::Normal {
            application.begin(&boot, &board::provisioning::record(), &mut |frame| {
                // A frame longer than the outbox does not exist: see `application::MOST_BYTES`.
                let _ = outbox.push(frame);
            });
        }
        serial::send(&mut port, &mut outbox);
        let (ring_in, ring_out) = cx.local.ring.split();
        rtic::pend(Interrupt::COMP);
        rtic::pend(Interrupt::TSC);
        (
            Shared {
                port,
                outbox,
                application,
            },
            Local {
                ring_in,
                ring_out,
                watchdog,
                feed_rule: FeedRule::default(),
                quiet_periods: 0,
                kept,
                boot,
                clock,
                next_tick: 0,
                normal: boot.operation == Operation::Normal,
            },
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
        let came = (cx.shared.port, cx.shared.outbox)
            .lock(|port, outbox| serial::serve(port, ring, outbox, &LINE_ERRORS));
        if came {
            rtic::pend(Interrupt::TSC);
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
        let beats = Beats {
            tick: TICK_BEATS.load(Ordering::Relaxed),
            link: LINK_BEATS.load(Ordering::Relaxed),
        };
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
        rtic::pend(Interrupt::COMP);
        rtic::pend(Interrupt::TSC);
    }

    #[task(binds = COMP, priority = 1, shared = [port, outbox, application], local = [boot, clock, next_tick])]
    fn tick(cx: tick::Context) {
        let normal = cx.local.boot.operation == Operation::Normal;
        if normal {
            board::provoke(Place::Tick);
        }
        let periods = PERIODS.load(Ordering::Relaxed);
        // The difference, because the counter wraps.
        if periods.wrapping_sub(*cx.local.next_tick) < u32::MAX / 2 {
            *cx.local.next_tick = cx.local.next_tick.wrapping_add(PERIOD_S * TIMER_HZ);
            let mut wires = (cx.shared.port, cx.shared.outbox);
            let frames_dropped = wires.lock(|_, outbox| outbox.dropped());
            let health = Health {
                uptime_ms: periods.wrapping_mul(1000 / TIMER_HZ),
                boot: *cx.local.boot,
                clock: *cx.local.clock,
                line: LINE_ERRORS.counts(),
                frames_dropped,
                stack_bytes: board::painted_stack::high_water(),
                longest_us: stopwatch::longest_us(),
                flash_errors: board::flash_errors(),
            };
            let mut send = |frame: &[u8]| wires.lock(|port, outbox| say(port, outbox, frame));
            let watch = Stopwatch::start();
            if normal {
                cx.shared.application.tick(&health, &mut send);
            } else {
                cx.shared.application.heartbeat(&health, &mut send);
            }
            watch.stop();
        }
        TICK_BEATS.fetch_add(1, Ordering::Relaxed);
    }

    #[task(binds = TSC, priority = 1, shared = [port, outbox, application], local = [ring_out, normal])]
    fn link(cx: link::Context) {
        let normal = *cx.local.normal;
        if normal {
            board::provoke(Place::Link);
        }
        let mut wires = (cx.shared.port, cx.shared.outbox);
        // At most one ring at a time: a line that babbles must not keep the other task waiting.
        for _ in 0..RING {
            let Some(byte) = cx.local.ring_out.dequeue() else {
                break;
            };
            if !normal {
                continue;
            }
            let watch = Stopwatch::start();
            cx.shared.application.receive(byte, &mut |frame| {
                wires.lock(|port, outbox| say(port, outbox, frame))
            });
            watch.stop();
        }
        if cx.local.ring_out.ready() {
            rtic::pend(Interrupt::TSC);
        }
        LINK_BEATS.fetch_add(1, Ordering::Relaxed);
    }

    /// Puts a frame into the outbox and starts the line.
    fn say(port: &mut SerialPort, outbox: &mut Outbox<OUTBOX>, frame: &[u8]) {
        // A frame longer than the outbox does not exist: see `application::MOST_BYTES`.
        let _ = outbox.push(frame);
        serial::send(port, outbox);
    }
}
