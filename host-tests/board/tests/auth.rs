//! Who may change the board: nobody without the key, nobody twice, nobody after a reboot with what was recorded before
//! it.

use board_tests::flash::Flash;
use rundown::onboard::auth::{
    Freshness, Key, KeySource, Provisioning, ProvisioningError, Refusal, SealError, Signer, TRAILER, Verifier,
};
use rundown::onboard::store::{AppendError, EpochError, Identity, Store};
use rundown::onboard::train_id::TrainId;
use std::cell::Cell;

const TRACK: u16 = 2;
const EFFECT: u16 = 3;
type Ring = Store<Flash, 1024>;

fn provisioning() -> Provisioning {
    Provisioning { key_id: 1, key: Key::new(core::array::from_fn(|i| i as u8)), train: TrainId::of("2451") }
}

fn board(epoch: u32) -> Verifier {
    Verifier::new(Ok(provisioning()), Ok(epoch))
}

fn desk(board: &Verifier) -> Signer {
    Signer::new(&provisioning(), &board.announcement().unwrap()).unwrap()
}

fn sealed(desk: &mut Signer, message: &[u8]) -> Vec<u8> {
    let mut buffer = [0; 256];
    desk.seal(TRACK, message, &mut buffer).unwrap().to_vec()
}

/// A key that is kept beside its source would stand in the variables, where a probe reads it.
#[test]
fn the_key_is_read_each_time_it_is_used() {
    struct Page<'a>(&'a Cell<Result<Provisioning, ProvisioningError>>);
    impl KeySource for Page<'_> {
        fn provisioning(&self) -> Result<Provisioning, ProvisioningError> {
            self.0.get()
        }
    }
    let page = Cell::new(Ok(provisioning()));
    let mut board = Verifier::new(Page(&page), Ok(3));
    let mut desk = Signer::new(&provisioning(), &board.announcement().unwrap()).unwrap();
    let [before, after] = [b"before", b"after!"].map(|message| sealed(&mut desk, message));
    assert_eq!(board.open(TRACK, &before), Ok(b"before".as_slice()));
    page.set(Ok(Provisioning { key: Key::new([9; 16]), ..provisioning() }));
    assert_eq!(board.open(TRACK, &after), Err(Refusal::WrongMac));
    page.set(Err(ProvisioningError::Unreadable));
    assert_eq!(board.open(TRACK, &after), Err(Refusal::Unprovisioned(ProvisioningError::Unreadable)));
    assert_eq!(board.announcement(), None);
    page.set(Ok(provisioning()));
    assert_eq!(board.open(TRACK, &after), Ok(b"after!".as_slice()));
}

/// MACs by OpenSSL 3.0.19: `openssl mac -macopt cipher:AES-128-CBC -macopt hexkey:000102...0f -in FILE CMAC`, FILE made
/// by Python's `struct.pack("<BHQII", direction, data_id, 0xca146bb2fe747401, epoch, counter) + message`, first 8
/// bytes.
#[test]
fn secured_messages_are_these_bytes() {
    let board = board(3);
    let announced = [3, 0, 0, 0, 0, 0, 0, 0, 0x08, 0xEA, 0x25, 0x41, 0xB4, 0x2C, 0x19, 0x78];
    assert_eq!(board.announcement(), Some(announced));
    let mut expected = b"new track".to_vec();
    expected.extend([3, 0, 0, 0, 1, 0, 0, 0]);
    expected.extend([0x97, 0x27, 0xA9, 0x33, 0x18, 0x96, 0x33, 0xE8]);
    assert_eq!(sealed(&mut desk(&board), b"new track"), expected);
}

/// The board's AES and CMAC beside those of the crates `aes` and `cmac`: keys without order, messages of every length
/// up to some blocks.
#[test]
fn macs_are_as_another_implementation_has_them() {
    use cmac::{Cmac, KeyInit, Mac};
    use rand::{RngExt, SeedableRng};
    let mut random = rand_chacha::ChaCha8Rng::seed_from_u64(1);
    for length in (0..100).cycle().take(1000) {
        let (key, epoch): ([u8; 16], u32) = (random.random(), random.random());
        let message: Vec<u8> = (0..length).map(|_| random.random()).collect();
        let provisioning = Provisioning { key: Key::new(key), ..provisioning() };
        let announced = Verifier::new(Ok(provisioning), Ok(epoch)).announcement().unwrap();
        let secured = sealed(&mut Signer::new(&provisioning, &announced).unwrap(), &message);
        let mut expected = Cmac::<aes::Aes128>::new(&key.into());
        expected.update(&[1]);
        expected.update(&TRACK.to_le_bytes());
        expected.update(&provisioning.train.0.to_le_bytes());
        expected.update(&secured[length..length + 8]);
        expected.update(&message);
        assert_eq!(secured[length + 8..], expected.finalize().into_bytes()[..8], "{message:x?} with {key:x?}");
    }
}

#[test]
fn every_forged_byte_is_refused_and_changes_nothing() {
    let mut board = board(3);
    let good = sealed(&mut desk(&board), b"new track, 9 gradients");
    let before = board.freshness();
    for at in 0..good.len() {
        for value in 0..=u8::MAX {
            if value == good[at] {
                continue;
            }
            let mut forged = good.clone();
            forged[at] = value;
            assert_eq!(board.open(TRACK, &forged), Err(Refusal::WrongMac), "byte {at} = {value}");
        }
    }
    for length in 0..good.len() {
        let cut = board.open(TRACK, &good[..length]);
        let expected =
            if length < TRAILER { Refusal::WrongLength { least: TRAILER, found: length } } else { Refusal::WrongMac };
        assert_eq!(cut, Err(expected), "{length} bytes");
    }
    let longer = [good.as_slice(), &[0]].concat();
    assert_eq!(board.open(TRACK, &longer), Err(Refusal::WrongMac));
    assert_eq!(board.open(EFFECT, &good), Err(Refusal::WrongMac), "another kind");
    assert_eq!(board.freshness(), before);
    assert_eq!(board.open(TRACK, &good), Ok(b"new track, 9 gradients".as_slice()));
}

#[test]
fn a_message_is_accepted_once_and_never_after_a_later_one() {
    let mut board = board(3);
    let mut desk = desk(&board);
    let messages = [b"one", b"two", b"six"].map(|message| sealed(&mut desk, message));
    assert_eq!(board.open(TRACK, &messages[1]), Ok(b"two".as_slice()));
    for (counter, message) in (1..).zip(&messages[..2]) {
        let stale = Refusal::Stale { last: 2, found: counter };
        assert_eq!(board.open(TRACK, message), Err(stale));
    }
    assert_eq!(board.open(TRACK, &messages[2]), Ok(b"six".as_slice()));
    assert_eq!(board.freshness(), Some(Freshness { epoch: 3, counter: 3 }));
}

/// One start of a board: mounts, takes an epoch, listens.
fn start(mut flash: Flash) -> (Verifier, Flash) {
    flash.power_up();
    let mut store = Ring::mount(flash).unwrap();
    let identity = Identity { train: provisioning().train, layout: 1 };
    let epoch = store.advance_epoch(identity, b"parameters");
    (Verifier::new(Ok(provisioning()), epoch), store.release())
}

#[test]
fn what_was_recorded_before_a_reboot_is_refused_after_it() {
    let (mut board, flash) = start(Flash::erased(4));
    let mut desk = desk(&board);
    let accepted = sealed(&mut desk, b"accepted");
    let held_back = sealed(&mut desk, b"held back");
    board.open(TRACK, &accepted).unwrap();

    let (mut board, _) = start(flash);
    let (expected, found) = (2, 1);
    for message in [accepted, held_back] {
        let refused = board.open(TRACK, &message);
        assert_eq!(refused, Err(Refusal::OtherEpoch { expected, found }));
    }
    // The desk has to hear the new epoch first.
    let still_old = sealed(&mut desk, b"still old");
    assert!(matches!(board.open(TRACK, &still_old), Err(Refusal::OtherEpoch { .. })));
    desk.hear(&board.announcement().unwrap()).unwrap();
    let again = sealed(&mut desk, b"again");
    assert_eq!(board.open(TRACK, &again), Ok(b"again".as_slice()));
}

#[test]
fn without_a_stored_epoch_everything_secured_is_refused_with_the_cause() {
    let mut flash = Flash::erased(4);
    flash.swallows = true;
    let (mut board, _) = start(flash);
    let message = sealed(&mut desk(&self::board(1)), b"new track");
    let cause = EpochError::NotStored(AppendError::NotWritten { page: 1, slot: 0 });
    assert_eq!(board.open(TRACK, &message), Err(Refusal::NoEpoch(cause)));
    assert_eq!((board.freshness(), board.announcement()), (None, None));

    let (mut board, _) = start(Flash::filled(4, 0));
    let cause = EpochError::Lost { damaged_slots: 8 };
    assert_eq!(board.open(TRACK, &message), Err(Refusal::NoEpoch(cause)));
}

#[test]
fn without_a_key_everything_secured_is_refused_even_by_a_key_of_erased_flash() {
    let unprovisioned = Provisioning::from_bytes(&[0xFF; 64]);
    let mut board = Verifier::new(unprovisioned, Ok(1));
    let mut of_erased_key = provisioning();
    of_erased_key.key = Key::new([0xFF; 16]);
    let announcement = Verifier::new(Ok(of_erased_key), Ok(1)).announcement().unwrap();
    let mut forger = Signer::new(&of_erased_key, &announcement).unwrap();
    let refused = Err(Refusal::Unprovisioned(ProvisioningError::Unprovisioned));
    assert_eq!(board.open(TRACK, &sealed(&mut forger, b"mine now")), refused);
    assert_eq!(board.announcement(), None);
}

#[test]
fn messages_for_another_train_or_of_another_key_are_refused() {
    let mut board = board(3);
    let other_train = Provisioning { train: TrainId::of("2452"), ..provisioning() };
    let other_key = Provisioning { key: Key::new([9; 16]), ..provisioning() };
    for other in [other_train, other_key] {
        let announcement = Verifier::new(Ok(other), Ok(3)).announcement().unwrap();
        let message = sealed(&mut Signer::new(&other, &announcement).unwrap(), b"new track");
        assert_eq!(board.open(TRACK, &message), Err(Refusal::WrongMac));
        // Nor does the desk of this train believe that board.
        let refused = Signer::new(&provisioning(), &announcement).map(|_| ());
        assert_eq!(refused, Err(Refusal::WrongMac));
    }
}

/// Else a forger could have a message signed for the next boot, hold it back, and play it then.
#[test]
fn a_forged_announcement_does_not_make_the_desk_sign_for_a_later_epoch() {
    let board = board(3);
    let mut desk = desk(&board);
    let announcement = board.announcement().unwrap();
    for at in 0..TRAILER {
        for bit in 0..8 {
            let mut forged = announcement;
            forged[at] ^= 1 << bit;
            assert_eq!(desk.hear(&forged), Err(Refusal::WrongMac), "byte {at} bit {bit}");
        }
    }
    let message = sealed(&mut desk, b"");
    assert_eq!(message[..8], [3, 0, 0, 0, 1, 0, 0, 0], "epoch and counter of the board");
    // An empty message to the board and an announcement look alike but for the direction.
    let trailer: [u8; TRAILER] = message.try_into().unwrap();
    assert_eq!(desk.hear(&trailer), Err(Refusal::WrongMac));
    let mut board = board;
    assert_eq!(board.open(0, &announcement), Err(Refusal::WrongMac));
}

#[test]
fn an_older_announcement_does_not_set_the_desk_back() {
    let mut board = board(3);
    let old = board.announcement().unwrap();
    let mut desk = desk(&board);
    for _ in 0..5 {
        let message = sealed(&mut desk, b"new track");
        desk.hear(&old).unwrap();
        board.open(TRACK, &message).unwrap();
    }
}

#[test]
fn a_buffer_too_short_is_named_and_uses_up_no_counter() {
    let mut desk = desk(&board(3));
    let (least, found) = (5 + TRAILER, 20);
    assert_eq!(desk.seal(TRACK, b"track", &mut [0; 20]), Err(SealError::BufferTooShort { least, found }));
    assert_eq!(sealed(&mut desk, b"track")[9], 1);
}
