//! Does the sequence of the STM32L4's flash lose what was learned, or refuse for ever: sticky flags, a busy controller,
//! a stale cache, power cuts at every access?

use embedded_storage::nor_flash::{NorFlash, ReadNorFlash};
use host_tests::flash::{CUT_MODES, Flash, PAGE, TornReads};
use host_tests::flash_controller::{FlashSilicon, OPTVERR, PGSERR};
use rundown::onboard::stm32l4_flash::{FlashError, MOST_WAITS, MOST_WAITS_SLOW, Stm32l4Flash, status};
use rundown::onboard::store::{Identity, Store};
use rundown::onboard::train_id::TrainId;

type Driver = Stm32l4Flash<FlashSilicon>;
type Ring = Store<Driver, 1024>;

fn identity() -> Identity {
    Identity { train: TrainId::of("2451"), layout: 1 }
}

fn payload(number: u32) -> Vec<u8> {
    (0..40 + number % 7 * 20).map(|i| (number * 31 + i) as u8).collect()
}

fn erased() -> Driver {
    Driver::new(FlashSilicon::after_reset(Flash::erased(4), 0))
}

fn boot(store: Ring, flags: u32) -> Ring {
    let mut driver = store.release();
    Ring::mount(Driver::new(driver.controller().clone().reset(flags))).unwrap()
}

fn newest(store: &mut Ring) -> Option<Vec<u8>> {
    store.newest(identity()).unwrap().map(|restored| restored.payload.to_vec())
}

fn violations(store: &mut Ring) -> Vec<&'static str> {
    assert_eq!(store.flash().clone().controller().flash.violations, 0);
    store.flash_mut().controller().violations.clone()
}

#[test]
fn flags_that_are_set_at_the_start_are_cleared_and_refuse_nothing() {
    for flag in (0..16).map(|bit| 1 << bit).filter(|bit| bit & status::ERRORS != 0).chain([OPTVERR | PGSERR]) {
        let mut driver = Driver::new(FlashSilicon::after_reset(Flash::erased(4), flag));
        driver.erase(0, PAGE as u32).unwrap_or_else(|error| panic!("flag {flag:#x}: {error:?}"));
        driver.write(0, &[7; 64]).unwrap_or_else(|error| panic!("flag {flag:#x}: {error:?}"));
        assert_eq!(driver.controller().violations, [""; 0], "flag {flag:#x}");
    }
}

#[test]
fn one_failed_operation_does_not_refuse_the_next() {
    for operation in 0..12 {
        let mut store = Ring::mount(erased()).unwrap();
        let epoch = store.advance_epoch(identity(), &payload(1)).unwrap();
        store.flash_mut().controller().fails = Some((operation, PGSERR));
        for number in 2..12 {
            store.append(identity(), &payload(number)).unwrap_or_else(|error| panic!("{operation}: {error}"));
            assert_eq!(newest(&mut store), Some(payload(number)), "{operation}");
        }
        assert_eq!(store.counters().driver_errors, 1, "{operation}");
        let mut store = boot(store, OPTVERR);
        assert!(store.advance_epoch(identity(), &payload(12)).unwrap() > epoch);
        assert_eq!(violations(&mut store), [""; 0], "{operation}");
    }
}

#[test]
fn a_word_that_reads_right_once_is_not_taken_for_written() {
    let mut driver = erased();
    driver.controller().uncertain = Some(35);
    assert_eq!(driver.write(0, &[7; 64]), Err(FlashError::ReadBack));
    assert_eq!(driver.write(64, &[7; 64]), Ok(()));
}

#[test]
fn a_flag_that_never_goes_is_named_and_what_was_stored_stays() {
    let mut store = Ring::mount(erased()).unwrap();
    store.append(identity(), &payload(1)).unwrap();
    store.flash_mut().controller().stuck_flags = OPTVERR;
    assert!(store.append(identity(), &payload(2)).is_err());
    assert_eq!(newest(&mut store), Some(payload(1)));
    assert_eq!(store.flash_mut().erase(0, PAGE as u32), Err(FlashError::Refused(OPTVERR)));
}

#[test]
fn a_controller_that_stays_busy_costs_bounded_polls_and_the_next_store_works() {
    // Wait states of the slow clock, and of the fast one.
    for (latency, most) in [(0, MOST_WAITS_SLOW), (4, MOST_WAITS)] {
        let mut store = Ring::mount(erased()).unwrap();
        store.flash_mut().controller().access |= latency;
        store.append(identity(), &payload(1)).unwrap();
        store.flash_mut().controller().busy_polls = 5 * MOST_WAITS;
        let before = store.flash_mut().controller().accesses;
        assert!(store.append(identity(), &payload(2)).is_err());
        let polls = store.flash_mut().controller().accesses - before;
        let most = u64::from(most);
        assert!((most..2 * most + 5_000).contains(&polls), "{polls}");
        // Reading waits for what is under way, as the bus does.
        assert_eq!(newest(&mut store), Some(payload(1)));
        store.flash_mut().controller().busy_polls = 3;
        store.append(identity(), &payload(3)).unwrap();
        assert_eq!(newest(&mut store), Some(payload(3)));
        assert_eq!(violations(&mut store), [""; 0]);
    }
}

#[test]
fn what_the_cache_held_before_is_not_read_after() {
    let mut driver = erased();
    let mut bytes = [0; PAGE];
    for round in 0..4 {
        driver.read(0, &mut bytes).unwrap();
        driver.erase(0, PAGE as u32).unwrap();
        driver.read(0, &mut bytes).unwrap();
        assert_eq!(bytes, [0xFF; PAGE]);
        driver.write(0, &[round; PAGE]).unwrap();
        driver.read(0, &mut bytes).unwrap();
        assert_eq!(bytes, [round; PAGE]);
        // Another page's bytes are not touched by an operation beside them.
        driver.erase(PAGE as u32, 2 * PAGE as u32).unwrap();
        driver.read(0, &mut bytes).unwrap();
        assert_eq!(bytes, [round; PAGE]);
    }
    assert_eq!(driver.controller().violations, [""; 0]);
}

/// What is cut: a record, or the two of a boot's epoch.
type Work = fn(&mut Ring, &[u8]) -> bool;

const WORKS: [(&str, Work); 2] = [
    ("record", |store, payload| store.append(identity(), payload).is_ok()),
    ("epoch", |store, payload| store.advance_epoch(identity(), payload).is_ok()),
];

#[test]
fn a_cut_at_any_access_leaves_the_old_or_the_new_and_epochs_rise() {
    for torn_reads in [TornReads::Stable, TornReads::Unstable, TornReads::Fail] {
        let mut before = Ring::mount(erased()).unwrap();
        let mut epoch = before.advance_epoch(identity(), &payload(0)).unwrap();
        // As many stores as modes: each access is cut in all of them.
        for number in 1..=CUT_MODES.len() as u32 {
            before.flash_mut().controller().flash.torn_reads = torn_reads;
            let (old, new) = (payload(number - 1), payload(number));
            for (what, work) in WORKS {
                let accesses = {
                    let mut whole = before.clone();
                    let start = whole.flash_mut().controller().accesses;
                    assert!(work(&mut whole, &new));
                    whole.flash_mut().controller().accesses - start
                };
                for access in 0..accesses {
                    let mode = CUT_MODES[(access + u64::from(number)) as usize % CUT_MODES.len()];
                    let context = format!("{torn_reads:?}, {what} {number}, cut {mode:?} at {access} of {accesses}");
                    let mut cut = before.clone();
                    cut.flash_mut().controller().cut_at(access, mode, access);
                    assert!(!work(&mut cut, &new), "{context}");
                    assert_goes_on(cut, [&old, &new], epoch, access, &context);
                }
            }
            before.append(identity(), &new).unwrap();
            before = boot(before, PGSERR);
            epoch = before.advance_epoch(identity(), &new).unwrap();
        }
    }
}

/// After a cut: one of the payloads is there, the epoch rises, and storing works.
fn assert_goes_on(cut: Ring, payloads: [&[u8]; 2], epoch: u32, access: u64, context: &str) {
    let mut cut = boot(cut, if access.is_multiple_of(2) { OPTVERR } else { PGSERR });
    let found = newest(&mut cut).unwrap();
    assert!(payloads.contains(&found.as_slice()), "{context}");
    let next = cut.advance_epoch(identity(), &found).unwrap_or_else(|error| panic!("{context}: {error}"));
    assert!(next > epoch, "{context}");
    for number in 100..103 {
        cut.append(identity(), &payload(number)).unwrap_or_else(|error| panic!("{context}: {error}"));
        assert_eq!(newest(&mut cut), Some(payload(number)), "{context}");
    }
    assert_eq!(violations(&mut cut), [""; 0], "{context}");
}
