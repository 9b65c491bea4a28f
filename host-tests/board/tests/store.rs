//! Does what was stored survive power cuts, bit rot, wear and other people's records?

use board_tests::described::NOMINAL;
use board_tests::flash::{CUT_MODES, CutMode, Flash, PAGE, TornReads, WORD};
use board_tests::prelude::*;
use crc::{CRC_32_ISCSI, Crc};
use embedded_storage::nor_flash::NorFlash;
use rundown::model::effects::{Coordinate, Effect, Effects, TunnelDrag, Unknown, WarmUp};
use rundown::onboard::store::persisted::{LAYOUT, Lifetime, NotRestored, Persisted};
use rundown::onboard::store::{AppendError, EpochError, Identity, OVERHEAD, Refused, Store, TooFewPages};
use rundown::tick::foresight::Foresight;
use rundown::tick::memory::{Implausible, MemoryConfig};

const SLOT: usize = 1024;
const PAGES: usize = 4;
type Ring = Store<Flash, SLOT>;

fn identity() -> Identity {
    Identity { train: TrainId::of("2451"), layout: LAYOUT }
}

/// The payload of a store: its number, repeated over a length of its own.
fn payload(number: u32) -> Vec<u8> {
    let length = 4 + (number as usize * 389) % (Ring::CAPACITY - 4);
    let bytes = number.to_le_bytes();
    (0..length).map(|i| bytes[i % 4].wrapping_add((i / 4) as u8)).collect()
}

fn newest(store: &mut Ring) -> Option<Vec<u8>> {
    let restored = store.newest(identity()).unwrap_or_else(|refused| panic!("{refused}"));
    restored.map(|restored| restored.payload.to_vec())
}

/// Switches on and mounts.
fn boot(mut flash: Flash) -> Ring {
    flash.power_up();
    Ring::mount(flash).unwrap()
}

/// 70 more payloads are stored and read, with a boot after each tenth; nothing is programmed twice.
fn takes_further_stores(mut store: Ring, context: &str) {
    for number in 1000..1070 {
        store.append(identity(), &payload(number)).unwrap_or_else(|error| panic!("{context}: {error}"));
        if number % 10 == 9 {
            store = boot(store.release());
        }
        assert_eq!(newest(&mut store), Some(payload(number)), "{context}");
    }
    assert_eq!(store.release().violations, 0, "{context}");
}

#[test]
fn a_cut_before_any_operation_leaves_the_old_or_the_new_payload_and_a_store_that_works() {
    const TORN_READS: [TornReads; 3] = [TornReads::Stable, TornReads::Unstable, TornReads::Fail];
    let mut cuts = [0; CUT_MODES.len()];
    let mut before = Ring::mount(Flash::erased(PAGES)).unwrap();
    let mut stores = 0;
    while cuts[0] < 4500 {
        stores += 1;
        if stores % 5 == 0 {
            before = boot(before.release());
        }
        let old = newest(&mut before);
        let new = payload(stores);
        let mut after = before.clone();
        after.append(identity(), &new).unwrap();
        let operations = after.flash().operations - before.flash().operations;
        for (mode, count) in CUT_MODES.into_iter().zip(&mut cuts) {
            for operation in 0..operations {
                let seed = 1000 * u64::from(stores) + operation;
                let torn_reads = TORN_READS[seed as usize % 3];
                let context = format!("store {stores}, cut {mode:?} before {operation}, {torn_reads:?}");
                let mut cut = before.clone();
                cut.flash_mut().torn_reads = torn_reads;
                cut.flash_mut().cut_before(operation, mode, seed);
                assert!(cut.append(identity(), &new).is_err(), "{context}");
                let mut cut = boot(cut.release());
                // Before the very first record was whole, there may be nothing but its beginning.
                match cut.newest(identity()) {
                    Ok(found) => {
                        let found = found.map(|restored| restored.payload.to_vec());
                        assert!(found == old || found.as_ref() == Some(&new), "{context}");
                    }
                    Err(refused) => {
                        assert!(old.is_none() && matches!(refused, Refused::Damaged { .. }), "{context}: {refused}")
                    }
                }
                takes_further_stores(cut, &context);
                *count += 1;
            }
        }
        before = after;
    }
    println!("{cuts:?} cuts of {stores} stores in the modes {CUT_MODES:?}");
}

/// Many cuts in a row, also while recovering from the one before.
#[test]
fn after_many_cuts_the_payload_is_the_last_acknowledged_one_or_a_later_one() {
    for seed in 0..400 {
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        let mut flash = Flash::erased(PAGES);
        flash.torn_reads = [TornReads::Stable, TornReads::Unstable, TornReads::Fail][seed as usize % 3];
        let (mut acknowledged, mut attempted) = (0, 0);
        for boot_number in 0..40 {
            flash.power_up();
            let mode = CUT_MODES[random.random_range(0..CUT_MODES.len())];
            flash.cut_before(random.random_range(0..600), mode, random.random());
            let mut store = Ring::mount(flash).unwrap();
            match store.newest(identity()) {
                Ok(Some(restored)) => {
                    let among = |number| payload(number) == restored.payload;
                    assert!((acknowledged.max(1)..=attempted).any(among), "seed {seed}, boot {boot_number}");
                }
                Ok(None) | Err(Refused::Damaged { .. }) => {
                    assert_eq!(acknowledged, 0, "seed {seed}, boot {boot_number}");
                }
                Err(refused) => panic!("seed {seed}, boot {boot_number}: {refused}"),
            }
            while {
                attempted += 1;
                store.append(identity(), &payload(attempted)).is_ok()
            } {
                acknowledged = attempted;
            }
            flash = store.release();
        }
        assert_eq!(flash.violations, 0, "seed {seed}");
        assert!(acknowledged > 10, "seed {seed}: {acknowledged}");
    }
}

#[test]
fn each_flipped_bit_gives_the_newest_payload_or_the_one_before_with_its_cause() {
    let short = |number: u8| [number; 150];
    let mut store = Ring::mount(Flash::erased(PAGES)).unwrap();
    for number in 1..=6 {
        store.append(identity(), &short(number)).unwrap();
    }
    let flash = store.release();
    // The sixth record is the second of the third page. What fills its last word is not part of it.
    let start = 8 * (2 * PAGE + SLOT);
    let of_newest = start..start + 8 * (150 + OVERHEAD);
    let mut bits = 0;
    for bit in flash.programmed_bits() {
        let mut rotten = flash.clone();
        rotten.flip(bit);
        let mut store = Ring::mount(rotten).unwrap();
        let restored = store.newest(identity()).unwrap().unwrap();
        let hit = of_newest.contains(&bit);
        assert_eq!(restored.payload, short(if hit { 5 } else { 6 }), "bit {bit}");
        assert_eq!(restored.fallen_back, hit, "bit {bit}");
        bits += 1;
    }
    assert_eq!(bits, 6 * 8 * (150 + OVERHEAD).next_multiple_of(WORD));
}

#[test]
fn rot_after_the_mount_falls_back_too() {
    let mut store = Ring::mount(Flash::erased(PAGES)).unwrap();
    store.append(identity(), b"old").unwrap();
    store.append(identity(), b"new").unwrap();
    store.flash_mut().flip(8 * SLOT + 8 * 24);
    let restored = store.newest(identity()).unwrap().unwrap();
    assert_eq!((restored.payload, restored.fallen_back), (b"old".as_slice(), true));
    store.flash_mut().flip(8 * 24);
    assert!(matches!(store.newest(identity()), Err(Refused::Damaged { .. })));
}

#[test]
fn blank_and_zeroed_flash_other_trains_and_older_layouts_are_distinguished() {
    let mut blank = Ring::mount(Flash::erased(PAGES)).unwrap();
    assert_eq!(blank.newest(identity()), Ok(None));

    let mut zeroed = Ring::mount(Flash::filled(PAGES, 0)).unwrap();
    assert_eq!(zeroed.newest(identity()), Err(Refused::Damaged { slots: 8 }));
    assert_eq!(zeroed.counters().damaged_slots, 8);
    takes_further_stores(zeroed, "zeroed");

    let mut store = Ring::mount(Flash::erased(PAGES)).unwrap();
    store.append(identity(), b"mine").unwrap();
    let expected = Identity { train: TrainId::of("2452"), ..identity() };
    let found = identity();
    assert_eq!(store.newest(expected), Err(Refused::OtherTrain { expected, found }));
    let expected = Identity { layout: LAYOUT + 1, ..identity() };
    assert_eq!(store.newest(expected), Err(Refused::OtherLayout { expected, found }));

    let few = Ring::mount(Flash::erased(3)).map(|_| ());
    assert_eq!(few, Err(TooFewPages { least: 4, found: 3 }));
}

#[test]
fn payloads_from_empty_to_the_whole_slot_are_stored_and_longer_ones_named() {
    let mut store = Ring::mount(Flash::erased(PAGES)).unwrap();
    for length in [0, 1, 3, 4, 5, Ring::CAPACITY - 1, Ring::CAPACITY] {
        let payload = vec![0xA5; length];
        store.append(identity(), &payload).unwrap();
        store = boot(store.release());
        assert_eq!(newest(&mut store), Some(payload));
    }
    let (most, found) = (Ring::CAPACITY, Ring::CAPACITY + 1);
    assert_eq!(store.append(identity(), &vec![0; found]), Err(AppendError::TooLong { most, found }));
}

/// The emulator's flash: acknowledges and forgets.
#[test]
fn flash_that_swallows_writes_is_named_and_counted() {
    let mut reads_erased = Flash::erased(PAGES);
    reads_erased.swallows = true;
    let mut store = Ring::mount(reads_erased).unwrap();
    let error = AppendError::NotWritten { page: 1, slot: 0 };
    assert_eq!(store.append(identity(), b"lost"), Err(error));
    assert_eq!(store.counters().not_written, 2);
    assert_eq!(store.newest(identity()), Ok(None));
    assert!(matches!(
        store.advance_epoch(identity(), b"lost"),
        Err(EpochError::NotStored(AppendError::NotWritten { .. }))
    ));

    let mut reads_zero = Flash::filled(PAGES, 0);
    reads_zero.swallows = true;
    let mut store = Ring::mount(reads_zero).unwrap();
    assert_eq!(store.append(identity(), b"lost"), Err(AppendError::NotErased { page: 1 }));
    assert_eq!(store.counters().not_erased, 2);
    assert_eq!(store.counters().stored, 0);
}

#[test]
fn a_worn_word_costs_one_page_and_no_payload() {
    let mut flash = Flash::erased(PAGES);
    flash.stuck_words = vec![PAGE / WORD + 3];
    let mut store = Ring::mount(flash).unwrap();
    for number in 0..50 {
        store.append(identity(), &payload(number)).unwrap();
        assert_eq!(newest(&mut store), Some(payload(number)));
    }
    assert!(store.counters().not_written > 5);
    assert_eq!(store.counters().stored, 50);
    assert_eq!(store.release().violations, 0);
}

#[test]
fn the_newest_payload_stays_when_every_other_page_is_worn_out() {
    let mut store = Ring::mount(Flash::erased(PAGES)).unwrap();
    store.append(identity(), b"before").unwrap();
    store.append(identity(), b"newest").unwrap();
    store.flash_mut().stuck_words = (0..PAGES).map(|page| page * PAGE / WORD).collect();
    for _ in 0..20 {
        assert!(matches!(store.append(identity(), b"fails"), Err(AppendError::NotWritten { .. })));
        assert_eq!(newest(&mut store), Some(b"newest".to_vec()));
        let mut after_boot = boot(store.flash().clone());
        assert_eq!(newest(&mut after_boot), Some(b"newest".to_vec()));
    }
}

/// They are the same at each start: what comes behind them must be reached, or no start would have an epoch again.
#[test]
fn pages_that_are_worn_out_side_by_side_end_neither_storing_nor_the_epochs() {
    const BOARD_PAGES: usize = 8;
    for first_worn in 0..BOARD_PAGES {
        for worn in 1..=BOARD_PAGES / 2 - 1 {
            let mut store = Ring::mount(Flash::erased(BOARD_PAGES)).unwrap();
            let mut epoch = store.advance_epoch(identity(), b"").unwrap();
            let word = |page: usize| (first_worn + page) % BOARD_PAGES * PAGE / WORD;
            store.flash_mut().stuck_words = (0..worn).map(word).collect();
            for number in 0..3 * BOARD_PAGES as u32 {
                store = boot(store.release());
                let context = format!("{worn} from {first_worn} on, boot {number}");
                let next = store.advance_epoch(identity(), b"").unwrap_or_else(|error| panic!("{context}: {error}"));
                assert!(next > epoch, "{context}");
                epoch = next;
                store.append(identity(), &payload(number)).unwrap_or_else(|error| panic!("{context}: {error}"));
                assert_eq!(newest(&mut store), Some(payload(number)), "{context}");
            }
        }
    }
}

/// A record that was torn by a cut can fail one read and pass a later one.
#[test]
fn a_record_that_can_be_read_again_later_does_not_hide_what_was_stored_meanwhile() {
    let mut store = Ring::mount(Flash::erased(PAGES)).unwrap();
    store.append(identity(), b"first").unwrap();
    store.append(identity(), b"torn").unwrap();
    store.flash_mut().flip(8 * SLOT);
    let mut store = boot(store.release());
    assert_eq!(newest(&mut store), Some(b"first".to_vec()));
    store.append(identity(), b"after").unwrap();
    store.flash_mut().flip(8 * SLOT);
    let mut store = boot(store.release());
    assert_eq!(newest(&mut store), Some(b"after".to_vec()));
}

/// A record made by hand from the documented layout.
fn record_by_hand(sequence: u32, epoch: u32, payload: &[u8]) -> Vec<u8> {
    let mut record = b"RDst".to_vec();
    record.extend(identity().layout.to_le_bytes());
    record.extend((payload.len() as u16).to_le_bytes());
    record.extend(sequence.to_le_bytes());
    record.extend(epoch.to_le_bytes());
    record.extend(identity().train.0.to_le_bytes());
    record.extend(payload);
    let crc = Crc::<u32>::new(&CRC_32_ISCSI).checksum(&record);
    record.extend(crc.to_le_bytes());
    record.resize(record.len().next_multiple_of(WORD), 0xFF);
    record
}

#[test]
fn the_sequence_wraps_without_a_gap() {
    let mut flash = Flash::erased(PAGES);
    flash.write(0, &record_by_hand(u32::MAX - 8, 0, b"by hand")).unwrap();
    let mut store = Ring::mount(flash).unwrap();
    assert_eq!(newest(&mut store), Some(b"by hand".to_vec()));
    let mut wrapped = false;
    for number in 0..30 {
        wrapped |= store.append(identity(), &payload(number)).unwrap() < 100;
        if number % 3 == 0 {
            store = boot(store.release());
        }
        assert_eq!(newest(&mut store), Some(payload(number)));
    }
    assert!(wrapped);
}

/// Cuts at random, and between two granted epochs one bit of the flash rots.
#[test]
fn an_epoch_is_never_granted_twice() {
    for seed in 0..400 {
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        let mut store = Ring::mount(Flash::erased(PAGES)).unwrap();
        let mut last = store.advance_epoch(identity(), b"").unwrap();
        let mut flash = store.release();
        let mut granted = 0;
        for boot_number in 0..60 {
            flash.power_up();
            if random.random_bool(0.5) {
                let mode = CUT_MODES[random.random_range(0..CUT_MODES.len())];
                flash.cut_before(random.random_range(0..80), mode, random.random());
            }
            let mut store = Ring::mount(flash).unwrap();
            let epoch = store.advance_epoch(identity(), &payload(boot_number));
            let stops = random.random_range(0..4);
            for stop in 0..stops {
                // Cut or not, the epoch is what counts here.
                let _ = store.append(identity(), &payload(stop));
            }
            flash = store.release();
            match epoch {
                Ok(epoch) => {
                    assert!(epoch > last, "seed {seed}, boot {boot_number}: {epoch} after {last}");
                    last = epoch;
                    granted += 1;
                    flash.flip(random.random_range(0..8 * PAGES * PAGE));
                }
                Err(error) => {
                    assert!(matches!(error, EpochError::NotStored(_)), "seed {seed}, boot {boot_number}: {error}")
                }
            }
        }
        assert!(granted > 20, "seed {seed}: {granted}");
    }
}

/// Whatever was cut at the first start, there is an epoch at the next one, and none that was given out before.
#[test]
fn a_first_start_that_is_cut_leaves_a_board_that_has_epochs() {
    let operations = {
        let mut store = Ring::mount(Flash::erased(PAGES)).unwrap();
        store.advance_epoch(identity(), b"").unwrap();
        store.flash().operations
    };
    for torn_reads in [TornReads::Stable, TornReads::Unstable, TornReads::Fail] {
        for (mode, operation) in CUT_MODES.into_iter().flat_map(|mode| (0..operations).map(move |at| (mode, at))) {
            let mut flash = Flash::erased(PAGES);
            // The second start is cut there, too.
            for seed in 0..2 {
                flash.torn_reads = torn_reads;
                flash.power_up();
                flash.cut_before(operation, mode, seed);
                let mut store = Ring::mount(flash).unwrap();
                assert!(store.advance_epoch(identity(), b"").is_err());
                flash = store.release();
            }
            let mut last = 0;
            for _ in 0..3 {
                let mut store = boot(flash);
                let epoch = store.advance_epoch(identity(), b"");
                let context = format!("{torn_reads:?}, {mode:?} at {operation}");
                let epoch = epoch.unwrap_or_else(|error| panic!("{context}: {error}"));
                assert!(epoch > last, "{context}");
                last = epoch;
                flash = store.release();
            }
        }
    }
}

/// Both records of the first epoch rot: it may have been given out, and is not given out again.
#[test]
fn the_epoch_of_the_first_start_is_not_given_out_again_when_its_records_are_gone() {
    let mut store = Ring::mount(Flash::erased(PAGES)).unwrap();
    assert_eq!(store.advance_epoch(identity(), b""), Ok(1));
    let mut flash = store.release();
    flash.flip(8 * 10);
    flash.flip(8 * (SLOT + 10));
    assert_eq!(boot(flash).advance_epoch(identity(), b""), Ok(2));
}

#[test]
fn an_epoch_outlives_a_change_of_layout_and_train_and_fails_closed_when_lost_or_used_up() {
    let mut store = Ring::mount(Flash::erased(PAGES)).unwrap();
    assert_eq!(store.advance_epoch(identity(), b""), Ok(1));
    let other = Identity { train: TrainId::of("2452"), layout: LAYOUT + 1 };
    let mut store = boot(store.release());
    assert_eq!(store.advance_epoch(other, b""), Ok(2));

    let lost = Err(EpochError::Lost { damaged_slots: 8 });
    let mut store = Ring::mount(Flash::filled(PAGES, 0)).unwrap();
    assert_eq!(store.advance_epoch(identity(), b""), lost);
    // Payloads are stored on, and do not make the board forget that it lost its epoch.
    for number in 0..20 {
        store.append(identity(), &payload(number)).unwrap();
    }
    let mut store = boot(store.release());
    assert_eq!(newest(&mut store), Some(payload(19)));
    assert!(matches!(store.advance_epoch(identity(), b""), Err(EpochError::Lost { .. })));

    let mut flash = Flash::erased(PAGES);
    flash.write(0, &record_by_hand(1, u32::MAX, b"")).unwrap();
    let mut store = Ring::mount(flash).unwrap();
    assert_eq!(store.advance_epoch(identity(), b""), Err(EpochError::Exhausted));
    let mut store = boot(store.release());
    assert_eq!(store.advance_epoch(identity(), b""), Err(EpochError::Exhausted));
}

/// 100 stops and 3 boots a day. Endurance of the STM32L4 family's flash by its data sheet: 10 000 erases a page.
#[test]
fn wear_of_a_year_is_even_and_its_size_is_known() {
    const ENDURANCE: f64 = 10_000.0;
    println!("pages   kB  erases per page and year  years to 10 000");
    for pages in [4, 16, 64] {
        let mut flash = Flash::erased(pages);
        for day in 0..365 {
            for boot in 0..3 {
                let mut store = Ring::mount(flash).unwrap();
                store.advance_epoch(identity(), b"boot").unwrap();
                for stop in 0..if boot == 0 { 34 } else { 33 } {
                    store.append(identity(), &[stop; 100]).unwrap();
                }
                let restored = store.newest(identity()).unwrap().unwrap();
                assert_eq!(restored.payload[0], if boot == 0 { 33 } else { 32 }, "day {day}");
                flash = store.release();
            }
        }
        assert_eq!(flash.violations, 0);
        let most = *flash.erases.iter().max().unwrap();
        let least = *flash.erases.iter().min().unwrap();
        assert!(most - least <= 1, "{least} to {most}");
        // A day: 3 boots of 2 records, 100 stops, 2 records a page, and 2 pages left half empty by a boot.
        let erases: u64 = flash.erases.iter().sum();
        assert_eq!(erases, 365 * 54, "{pages} pages");
        println!("{pages:5} {:4} {most:25} {:17.1}", pages * PAGE / 1024, ENDURANCE / most as f64);
    }
}

fn learned() -> (Vehicle, Persisted) {
    let config = MemoryConfig::default();
    let mut vehicle = Vehicle::new(&config, NOMINAL);
    let begin = vehicle.constants(&config, 0.03);
    let mut end = begin;
    end.mean *= 0.9;
    end.covariance *= 0.2;
    vehicle.learn(&config, [&begin, &end], vehicle.column(), &Foresight::NONE, 0.0);
    let effects = [
        Effect::WarmUp(WarmUp { amplitude: 3e-3, tau_s: 300.0 }),
        Effect::Unknown(Unknown {
            coordinate: Coordinate::Speed,
            table: [(10.0, 0.0), (40.0, 1e-3)].into_iter().collect(),
        }),
        Effect::TunnelDrag(TunnelDrag { from_m: 4e3, to_m: 9e3, k: 1e-5 }),
    ];
    let mut persisted = Persisted::new(&vehicle, &Effects::try_new(effects).unwrap());
    persisted.lifetime = Lifetime { resets: 3, runs: 70_000, stops: 1_000_000 };
    (vehicle, persisted)
}

#[test]
fn what_was_learned_comes_back_bit_for_bit_after_a_boot() {
    let train = TrainId::of("2451");
    let (vehicle, mut persisted) = learned();
    let mut store = Ring::mount(Flash::erased(PAGES)).unwrap();
    assert_eq!(Persisted::load(&mut store, train, &NOMINAL), Ok(None));
    persisted.save(&mut store, train).unwrap();
    let mut store = boot(store.release());
    let loaded = Persisted::load(&mut store, train, &NOMINAL).unwrap().unwrap();
    assert_eq!(loaded.vehicle, vehicle);
    assert_eq!(loaded.persisted, persisted);
    let names: Vec<_> = loaded.effects.iter().map(Effect::name).collect();
    assert_eq!(names, ["warm_up", "tunnel_drag", "unknown"]);
    assert!(!loaded.fallen_back);
}

#[test]
fn what_cannot_be_believed_is_not_restored_and_the_cause_is_named() {
    let train = TrainId::of("2451");
    let (_, good) = learned();
    let stored = |change: fn(&mut Persisted), davis: &Davis| {
        let mut persisted = good.clone();
        change(&mut persisted);
        let mut store = Ring::mount(Flash::erased(PAGES)).unwrap();
        persisted.save(&mut store, train).unwrap();
        Persisted::load(&mut store, train, davis).unwrap_err()
    };
    let heavier = Davis { r0: 8.0 * NOMINAL.r0, ..NOMINAL };
    assert!(matches!(stored(|_| {}, &heavier), NotRestored::Vehicle(Implausible::Resistance { speed_mps: 5.0, .. })));
    assert_eq!(
        stored(|p| p.vehicle.hypotheses[1].covariance[0] = f64::NAN, &NOMINAL),
        NotRestored::Vehicle(Implausible::NotFinite)
    );
    assert_eq!(stored(|p| p.effects[0].values[1] = f64::INFINITY, &NOMINAL), NotRestored::Effect { kind: 17 });
    assert_eq!(stored(|p| p.effects[1].kind = 200, &NOMINAL), NotRestored::Effect { kind: 200 });

    let mut store = Ring::mount(Flash::erased(PAGES)).unwrap();
    // What the first boot stores: its epoch, nothing learned yet.
    store.append(identity(), &[]).unwrap();
    assert_eq!(Persisted::load(&mut store, train, &NOMINAL), Ok(None));
    for not_a_payload in [&[1, 2, 3][..], &[0xFF; 990]] {
        store.append(identity(), not_a_payload).unwrap();
        assert_eq!(Persisted::load(&mut store, train, &NOMINAL), Err(NotRestored::NotDecoded));
    }
    let other = Persisted::load(&mut store, TrainId::of("2452"), &NOMINAL);
    assert!(matches!(other, Err(NotRestored::Refused(Refused::OtherTrain { .. }))));
}

/// The mock itself: without these the tests above would prove little.
#[test]
fn the_mock_cuts_tears_and_notices_double_programming() {
    let mut flash = Flash::erased(PAGES);
    flash.write(0, &[0; WORD]).unwrap();
    assert_eq!(flash.violations, 0);
    flash.write(0, &[0; WORD]).unwrap();
    assert_eq!(flash.violations, 1);

    flash.cut_before(1, CutMode::HalfDone, 7);
    assert!(flash.write(WORD as u32, &[0; 3 * WORD]).is_err());
    assert!(flash.power_up());
    let words: Vec<u8> = {
        use embedded_storage::nor_flash::ReadNorFlash;
        let mut words = vec![0; 3 * WORD];
        flash.read(WORD as u32, &mut words).unwrap();
        words
    };
    assert_eq!(words[..WORD], [0; WORD]);
    assert_eq!(words[WORD..2 * WORD], [0, 0, 0, 0, 0xFF, 0xFF, 0xFF, 0xFF]);
    assert_eq!(words[2 * WORD..], [0xFF; WORD]);
    // A torn word counts as not erased, whatever it reads as.
    flash.write(2 * WORD as u32, &[0xFF; WORD]).unwrap();
    assert_eq!(flash.violations, 2);

    flash.cut_before(0, CutMode::Indeterminate, 7);
    assert!(flash.erase(0, PAGE as u32).is_err());
    flash.power_up();
    flash.write(100 * WORD as u32, &[0; WORD]).unwrap();
    assert_eq!(flash.violations, 3);
    flash.erase(0, PAGE as u32).unwrap();
    flash.write(100 * WORD as u32, &[0; WORD]).unwrap();
    assert_eq!(flash.violations, 3);
}
