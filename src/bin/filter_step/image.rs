//! Steps of the paper's filter and of that of the learning modes, and nothing else. Says over the serial line how long
//! the longest took; `cargo xtask budget` starts it.
//!
//! Out: counts of the system timer for a step of the paper's filter, then for the filter of a tick, 0 where one failed;
//! then how many results with doubles are not those of `rundown::onboard::doubles`; then how many copies and fills are
//! not those of single bytes. 4 bytes each, little endian.

use core::cmp::Ordering;
use core::hint::black_box;
use core::panic::PanicInfo;
use cortex_m::peripheral::SYST;
use cortex_m::peripheral::syst::SystClkSource;
use cortex_m_rt::entry;
// The linker script of the log asks for it.
use defmt_rtt as _;
use rundown::filter::gaussian::Gaussian;
use rundown::filter::ukf::{Spread, Ukf};
use rundown::model::direction::Direction;
use rundown::model::line::Line;
use rundown::model::motion::{Evaluate, Motion};
use rundown::model::state::{SIZE, SIZE_WITH_GAIN};
use rundown::model::track::{Gradient, Track};
use rundown::model::train::{Train, TrainDescription};
use rundown::onboard::doubles;
use rundown::tick::learning::LocationAndSpeed;

#[path = "../../board/memory.rs"]
mod memory;
#[path = "../../board/soft_doubles.rs"]
mod soft_doubles;

unsafe extern "C" {
    fn DefaultHandler();
}

/// Nothing interrupts; the start-up code asks for the table.
// SAFETY: the section is of vectors, and each is the start-up code's own handler.
#[unsafe(link_section = ".vector_table.interrupts")]
#[unsafe(no_mangle)]
static __INTERRUPTS: [unsafe extern "C" fn(); 32] = [DefaultHandler; 32];

const STEPS: u32 = 60;
const DT_S: f64 = 10.0;
/// Pairs of doubles that are added and multiplied.
const DOUBLES: u32 = 200_000;
const OBSERVATION: LocationAndSpeed = LocationAndSpeed { location_variance: 16.0, speed_variance: 1.0 / (3.6 * 3.6) };
const FILTER: Ukf<SIZE, 2> = Ukf { spread: Spread::PAPER, gate: [None; 2], reuse_points: true };

/// What is measured. Of its own, so that its code and its stack are separate from the rest.
#[inline(never)]
fn filter_step(
    belief: &mut Gaussian<SIZE>,
    line: &Line<'_>,
    effort_n_per_kg: f64,
    readings: &[Option<f64>; 2],
) -> bool {
    let motion = Motion::new(line, &belief.mean, effort_n_per_kg, DT_S, Evaluate::Beginning);
    FILTER.step(belief, &motion, &OBSERVATION, readings).is_ok()
}

/// As [`rundown::tick::learning`] has it.
const LEARNING: Ukf<SIZE_WITH_GAIN, 2> = Ukf { spread: Spread::WIDE, gate: [Some(4.0); 2], reuse_points: false };
/// A tick of 10 s in sub-steps of 2.5 s.
const SUB_STEPS: u8 = 4;

/// The filter of a tick of the learning modes: predictions in sub-steps, and an update.
#[inline(never)]
fn tick_filter(
    belief: &mut Gaussian<SIZE_WITH_GAIN>,
    line: &Line<'_>,
    effort_n_per_kg: f64,
    readings: &[Option<f64>; 2],
) -> bool {
    for _ in 0..SUB_STEPS {
        let sub_step_s = DT_S / f64::from(SUB_STEPS);
        let motion = Motion::new(line, &belief.mean, effort_n_per_kg, sub_step_s, Evaluate::Midway).with_noise(0.02);
        if LEARNING.predict(belief, &motion).is_err() {
            return false;
        }
    }
    LEARNING.update(belief, &OBSERVATION, readings).is_ok()
}

/// The board's stack is too small to make a track on it, which the firmware never does.
#[entry]
fn main() -> ! {
    const WORDS: usize = 20 << 10;
    static mut STACK: [u32; WORDS] = [0; WORDS];
    let top = (&raw const STACK).cast::<u32>().wrapping_add(WORDS);
    // SAFETY: nothing else uses the words below `top`, and `measure` never returns to the stack that is left.
    unsafe { cortex_m::asm::bootstrap(top, measure as *const u32) }
}

extern "C" fn measure() -> ! {
    let [step, tick] = longest().unwrap_or([0; 2]);
    say(step);
    say(tick);
    say(wrong_doubles());
    say(wrong_copies());
    loop {
        cortex_m::asm::wfi();
    }
}

/// A train on a cruise over a track of the reference's kind.
fn longest() -> Option<[u32; 2]> {
    let mut timer = cortex_m::Peripherals::take()?.SYST;
    timer.set_clock_source(SystClkSource::Core);
    timer.set_reload(0xFF_FFFF);
    timer.clear_current();
    timer.enable_counter();
    let train = Train::try_new(TrainDescription { max_power_w: 2_036_377.8, ..TrainDescription::CASE_STUDY }).ok()?;
    let gradients = (0..32_u32).map(|i| Gradient { from_m: 1000.0 * f64::from(i), permille: f64::from(i % 5) - 2.0 });
    let track = Track::try_new(32e3, gradients).ok()?;
    let line = Line { train: &train, track: &track, direction: Direction::Up };
    let mut belief = Gaussian::independent([100.0, 38.0, 7.38e-3, 1.6e-4, 2.8e-5], [1.0, 0.0005, 1e-6, 1e-8, 1e-9]);
    let mut learning =
        Gaussian::independent([100.0, 38.0, 7.38e-3, 1.6e-4, 2.8e-5, 1.0], [4.0, 0.3, 2e-3, 5e-5, 8e-6, 0.03]);
    let mut longest = [0; 2];
    for step in 1..=STEPS {
        let time_s = DT_S * f64::from(step);
        let readings = black_box([Some(100.0 + 38.0 * time_s), Some(38.0)]);
        let done = [
            timed(|| filter_step(black_box(&mut belief), &line, black_box(0.055), &readings)),
            timed(|| tick_filter(black_box(&mut learning), &line, black_box(0.055), &readings)),
        ];
        for (longest, taken) in longest.iter_mut().zip(done) {
            *longest = taken?.max(*longest);
        }
    }
    Some(longest)
}

/// Of pairs of bits, how many the board adds, subtracts, multiplies, divides, compares or converts otherwise than the
/// integers do.
fn wrong_doubles() -> u32 {
    let mut wrong = 0;
    for [a, b] in doubles::pairs(DOUBLES) {
        let (x, y) = (black_box(f64::from_bits(a)), black_box(f64::from_bits(b)));
        let found = [x + y, x - y, x * y, x / y].map(f64::to_bits);
        let expected =
            [doubles::add(a, b), doubles::add(a, b ^ doubles::SIGN), doubles::multiply(a, b), doubles::divide(a, b)];
        wrong += found.iter().zip(&expected).filter(|(found, expected)| found != expected).count() as u32;
        let order = doubles::compare(a, b);
        let found = [x < y, x <= y, x == y, x >= y, x > y].map(black_box);
        let expected = [
            order == Some(Ordering::Less),
            matches!(order, Some(Ordering::Less | Ordering::Equal)),
            order == Some(Ordering::Equal),
            matches!(order, Some(Ordering::Greater | Ordering::Equal)),
            order == Some(Ordering::Greater),
        ];
        wrong += u32::from(found != expected);
        // The compiler may know that to a single number and back is less than all of it.
        let single = black_box(x as f32);
        wrong += u32::from(single.to_bits() != doubles::to_single(a));
        wrong += u32::from(f64::from(single).to_bits() != doubles::from_single(single.to_bits()));
        let (count, number) = (black_box(a as u32), black_box(b as i32));
        wrong += u32::from(f64::from(count).to_bits() != doubles::from_count(0, count.into()));
        wrong += u32::from(f64::from(number) as i32 != number || f64::from(count) as u32 != count);
    }
    wrong
}

/// Of copies to another list, copies within one and fills, at all places within eight bytes and up to 39 bytes long,
/// how many are wrong.
fn wrong_copies() -> u32 {
    const SIZE: usize = 48;
    let before: [u8; SIZE] = core::array::from_fn(|i| 7 * i as u8);
    let mut wrong = 0;
    for case in 0..40 * 64 {
        let (to, from, length) = (case % 8, case / 8 % 8, black_box(case / 64));
        let [mut copied, mut moved, mut filled] = black_box([before; 3]);
        copied[to..to + length].copy_from_slice(&black_box(before)[from..from + length]);
        moved.copy_within(from..from + length, to);
        filled[to..to + length].fill(black_box(0xA5));
        let right = |i: usize| {
            let inside = (to..to + length).contains(&i);
            let [expected, fill] = if inside { [before[i + from - to], 0xA5] } else { [before[i]; 2] };
            copied[i] == expected && moved[i] == expected && filled[i] == fill
        };
        wrong += u32::from(!(0..SIZE).all(right));
    }
    wrong
}

/// Counts that it took; none where it failed.
fn timed(step: impl FnOnce() -> bool) -> Option<u32> {
    let from = SYST::get_current();
    let done = step();
    // It counts down.
    let taken = from.wrapping_sub(SYST::get_current()) & 0xFF_FFFF;
    done.then_some(taken)
}

/// Over UART 0 of the board, which the emulator sends at once.
fn say(counts: u32) {
    const DATA: *mut u32 = 0x4000_4000 as *mut u32;
    const CONTROL: *mut u32 = 0x4000_4008 as *mut u32;
    const DIVIDER: *mut u32 = 0x4000_4010 as *mut u32;
    // SAFETY: registers of the UART, which nothing else touches; the transmitter is enabled before it is given a byte.
    unsafe {
        DIVIDER.write_volatile(16);
        CONTROL.write_volatile(1);
        for byte in counts.to_le_bytes() {
            DATA.write_volatile(byte.into());
            // A register holds one byte until it has gone.
            while DATA.add(1).read_volatile() & 1 != 0 {}
        }
    }
}

#[panic_handler]
fn panic(_: &PanicInfo<'_>) -> ! {
    cortex_m::asm::udf()
}
