//! What the board keeps over a power cut, and how it is brought back.
//!
//! Restored only if train, layout and plausible range agree; else the caller begins with defaults and has the cause.
//! The boot epoch is not here but in the header of every record: it has to outlive a change of layout.

use super::{AppendError, Identity, Refused, Store};
use crate::Real;
use crate::listed::listed;
use crate::model::effects::{Effect, Effects, MAX_EFFECTS, MAX_POINTS, Unknown};
use crate::model::resistance::Davis;
use crate::onboard::train_id::TrainId;
use crate::plain::{self, Bytes, Plain, plain};
use crate::tick::effort_reading::Column;
use crate::tick::foresight::Trust;
use crate::tick::memory::{ByGain, Implausible, MemoryConfig, Vehicle, VehicleRecord};
use crate::tick::snapshot::{InPlace, in_place};
use crate::tick::truncation::SpeedOffset;
use embedded_storage::nor_flash::NorFlash;
use heapless::Vec;
use rundown_wire::{EffectKind, errors};

/// Version of [`Persisted`]'s layout. Raised by every change of its fields, their order (last fields that older records
/// lack excepted: [`Appended`]), or [`SCALES`](crate::tick::memory::SCALES).
pub const LAYOUT: u16 = 2;

in_place! {
    /// What survives a power cut.
    #[derive(Clone, Debug, PartialEq)]
    pub struct Persisted {
        /// What is known of the train's resistance.
        pub vehicle: VehicleRecord = (VehicleRecord::ZEROED);
        /// What happened since the board was provisioned.
        pub lifetime: Lifetime = (Lifetime { resets: 0, runs: 0, stops: 0 });
        /// Effects that were added to the model, but for the unknown one.
        pub effects: Vec<StoredEffect, MAX_EFFECTS> = (in place);
        /// The unknown one.
        pub table: Option<Unknown> = (None, zeroed Some(Unknown::START));
        /// How far the vehicle may be trusted.
        pub trust: Appended<[f32; 4]> = (Appended::START);
        /// What is known of its effort column.
        pub column: Appended<Column> = (Appended::START);
        /// What is known of its speed readings.
        pub offset: Appended<SpeedOffset> = (Appended::START);
        /// Share of what it was taught that short hops taught.
        pub hops_share: Appended<f32> = (Appended::START);
        /// What its resistance has in common with the gain of the column.
        pub by_gain: Appended<ByGain> = (Appended::START);
    }
}

/// Counts over the life of the board.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Lifetime {
    /// Starts of the firmware.
    pub resets: u32,
    /// Runs.
    pub runs: u32,
    /// Stops.
    pub stops: u32,
}

plain! {
    struct Lifetime { resets, runs, stops }
}

/// What was added behind what older firmware stored; zeros where a record ends before it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Appended<T>(T);

impl From<&Trust> for Appended<[f32; 4]> {
    fn from(trust: &Trust) -> Self {
        Self([trust.coasts, trust.squares, trust.worse, trust.apart].map(|sum| sum as f32))
    }
}

impl From<Appended<[f32; 4]>> for Trust {
    fn from(Appended(sums): Appended<[f32; 4]>) -> Self {
        let [coasts, squares, worse, apart] = sums.map(Real::from);
        Self { coasts, squares, worse, apart }
    }
}

impl<T: Plain> Plain for Appended<T> {
    const START: Self = Self(T::START);

    fn pass(&mut self, bytes: &mut Bytes<'_>) {
        if bytes.are_at_end() {
            *self = Self::START;
        } else {
            self.0.pass(bytes);
        }
    }
}

/// A named effect in numbers, as in frames.
pub use rundown_wire::Effect as StoredEffect;

/// What was brought back.
#[derive(Clone, Debug, PartialEq)]
pub struct Loaded {
    /// The vehicle, checked.
    pub vehicle: Vehicle,
    /// The effects, checked.
    pub effects: Effects,
    /// All that was stored.
    pub persisted: Persisted,
    /// A newer record may be lost; see [`Restored`](super::Restored).
    pub fallen_back: bool,
}

errors! {
    /// Why nothing was brought back, though something is stored: begin with defaults and report it.
    #[non_exhaustive]
    pub enum NotRestored {
        /// The store does not give it.
        Refused(cause: Refused) => "{cause}",
        NotDecoded => "payload: expected one of layout {LAYOUT}, found another",
        /// The vehicle is not believed.
        Vehicle(cause: Implausible) => "{cause}",
        Effect { kind: u8 } => "effect: expected one of this model with its parameters in range, found kind {kind}",
    }
}

impl Persisted {
    /// Largest number of bytes it is stored in: 8 a number, 5 a count. The unknown effect is one of the
    /// [`MAX_EFFECTS`].
    pub const MAX_SIZE: usize = 8 * 3
        + 4 * 8 * 10
        + 5
        + 3 * 5
        + 1
        + (MAX_EFFECTS - 1) * (1 + 1 + 2 * 8 + 1 + 4 * 8)
        + 1
        + 1
        + 1
        + MAX_POINTS * 2 * 4
        + 4 * 4
        + 12
        + 4 * 4
        + 4
        + 3 * 4;

    /// A vehicle and the effects of the model, nothing counted.
    pub fn new(vehicle: &Vehicle, effects: &Effects) -> Self {
        let named = effects.iter().filter(|effect| effect.table().is_none());
        Self {
            vehicle: vehicle.to_record(),
            lifetime: Lifetime::default(),
            effects: listed(named.map(Effect::to_frame)),
            table: effects.table().cloned(),
            trust: vehicle.trust().into(),
            column: Appended(vehicle.column),
            offset: Appended(vehicle.speed_offset()),
            hops_share: Appended(vehicle.hops_share),
            by_gain: Appended(vehicle.by_gain),
        }
    }

    fn effects_in(&self, effects: &mut Effects) -> Result<(), NotRestored> {
        effects.clear();
        for stored in &self.effects {
            let kind = stored.kind;
            let taken = Effect::from_frame(stored).map(|effect| effects.push(effect));
            if !matches!(taken, Ok(Ok(()))) {
                return Err(NotRestored::Effect { kind });
            }
        }
        if let Some(table) = &self.table {
            let kind = EffectKind::Unknown.number();
            effects.push(Effect::Unknown(table.clone())).map_err(|_| NotRestored::Effect { kind })?;
        }
        Ok(())
    }

    /// Brings back what was stored last. `Ok(None)`: nothing was ever stored.
    ///
    /// # Errors
    /// [`NotRestored`] says why not. Nothing is changed or erased.
    pub fn load<F: NorFlash, const SLOT: usize>(
        store: &mut Store<F, SLOT>,
        train: TrainId,
        manufacturer: &Davis,
    ) -> Result<Option<Loaded>, NotRestored> {
        let mut persisted = Self::ZEROED;
        let restored = persisted.load_in(store, train)?;
        let Some(fallen_back) = restored else {
            return Ok(None);
        };
        let mut effects = Effects::NONE;
        let mut vehicle = Vehicle::new(&MemoryConfig::default(), *manufacturer);
        persisted.vehicle_and_effects(manufacturer, &mut vehicle, &mut effects)?;
        Ok(Some(Loaded { vehicle, effects, persisted, fallen_back }))
    }

    /// The first half of [`Persisted::load`], in the place of another: whether a newer record may be lost.
    #[inline(never)]
    pub(crate) fn load_in<F: NorFlash, const SLOT: usize>(
        &mut self,
        store: &mut Store<F, SLOT>,
        train: TrainId,
    ) -> Result<Option<bool>, NotRestored> {
        let restored = store.newest(identity(train)).map_err(NotRestored::Refused)?;
        // The first boot stores its epoch with nothing.
        let Some(restored) = restored.filter(|restored| !restored.payload.is_empty()) else {
            return Ok(None);
        };
        let complete = plain::read_all(self, restored.payload);
        complete.then_some(Some(restored.fallen_back)).ok_or(NotRestored::NotDecoded)
    }

    /// The second half, in the place of others: the vehicle, if all is believed, and the effects, of which a refused
    /// record may leave some.
    #[inline(never)]
    pub(crate) fn vehicle_and_effects(
        &self,
        manufacturer: &Davis,
        vehicle: &mut Vehicle,
        effects: &mut Effects,
    ) -> Result<(), NotRestored> {
        self.effects_in(effects)?;
        *vehicle = Vehicle::from_record(&self.vehicle, manufacturer).map_err(NotRestored::Vehicle)?;
        let column = (self.column.0, self.by_gain.0);
        vehicle.recall(self.trust.into(), column, self.offset.0, self.hops_share.0);
        Ok(())
    }

    /// Stores it; at each stop.
    ///
    /// # Errors
    /// See [`Store::append`].
    pub fn save<F: NorFlash, const SLOT: usize>(
        &mut self,
        store: &mut Store<F, SLOT>,
        train: TrainId,
    ) -> Result<u32, AppendError> {
        const { assert!(Self::MAX_SIZE <= Store::<F, SLOT>::CAPACITY) };
        let mut buffer = [0; Self::MAX_SIZE];
        store.append(identity(train), self.encode(&mut buffer)?)
    }

    /// Cannot fail as long as [`Persisted::MAX_SIZE`] is right.
    fn encode<'a>(&mut self, buffer: &'a mut [u8; Self::MAX_SIZE]) -> Result<&'a [u8], AppendError> {
        let too_long = AppendError::TooLong { most: Self::MAX_SIZE, found: Self::MAX_SIZE + 1 };
        plain::write(self, buffer).ok_or(too_long)
    }
}

fn identity(train: TrainId) -> Identity {
    Identity { train, layout: LAYOUT }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::effects::Coordinate;
    use nalgebra::Vector3;

    #[test]
    fn largest_size_is_the_one_stated() {
        let davis = Davis { r0: 7.38e-3, r1: 1.6e-4, r2: 2.8e-5 };
        let vehicle = Vehicle::new(&MemoryConfig::default(), davis);
        let mut full = Persisted::new(&vehicle, &Effects::NONE);
        full.vehicle.runs = u32::MAX;
        full.lifetime = Lifetime { resets: u32::MAX, runs: u32::MAX, stops: u32::MAX };
        let effect =
            StoredEffect { kind: u8::MAX, section_m: Some([f64::MAX; 2]), values: [f64::MAX; 4].into_iter().collect() };
        full.effects = core::iter::repeat_n(effect, MAX_EFFECTS - 1).collect();
        full.table = Some(Unknown {
            coordinate: Coordinate::Day,
            table: core::iter::repeat_n((f32::MAX, f32::MAX), MAX_POINTS).collect(),
        });
        full.column = Appended(Column { steps: [u16::MAX, 16_383, u16::MAX, 16_383, 16_383] });
        let mut buffer = [0; Persisted::MAX_SIZE];
        assert_eq!(full.encode(&mut buffer).unwrap().len(), Persisted::MAX_SIZE);
    }

    /// Trust came first, then the effort column, the speed readings, the share of short hops, what goes with the
    /// column's gain.
    #[test]
    fn a_record_of_older_firmware_ends_before_what_came_later() {
        let davis = Davis { r0: 7.38e-3, r1: 1.6e-4, r2: 2.8e-5 };
        let mut vehicle = Vehicle::new(&MemoryConfig::default(), davis);
        let trust = Trust { coasts: 3.0, squares: 2.5, worse: -1.75, apart: 0.25 };
        let column = Column { steps: [300, 40, 65_436, 20, 1000] };
        let offset = SpeedOffset { runs: 3.5, information: 900.0, vector: 120.0, squares: 17.0 };
        let by_gain = ByGain::of(&Vector3::new(3.5, -2.0, 7.25));
        vehicle.recall(trust, (column, by_gain), offset, 0.75);
        let mut buffer = [0; Persisted::MAX_SIZE];
        let bytes = Persisted::new(&vehicle, &Effects::NONE).encode(&mut buffer).unwrap();
        let gain_from = bytes.len() - 12;
        let hops_from = gain_from - 4;
        let offset_from = hops_from - 16;
        let column_from = offset_from - (2 + 1 + 3 + 1 + 2);
        let read = |end: usize| {
            let mut stored = Persisted::ZEROED;
            plain::read_all(&mut stored, &bytes[..end]).then(|| {
                let mut restored = Vehicle::new(&MemoryConfig::default(), davis);
                stored.vehicle_and_effects(&davis, &mut restored, &mut Effects::NONE.clone()).unwrap();
                let column = (restored.column(), restored.by_gain);
                (*restored.trust(), column, restored.speed_offset(), restored.hops_share)
            })
        };
        let none = SpeedOffset::default();
        let (alone, unknown) = ((column, ByGain::default()), (Column::default(), ByGain::default()));
        assert_eq!(read(bytes.len()), Some((trust, (column, by_gain), offset, 0.75)));
        assert_eq!(read(gain_from), Some((trust, alone, offset, 0.75)));
        assert_eq!(read(hops_from), Some((trust, alone, offset, 0.0)));
        assert_eq!(read(offset_from), Some((trust, alone, none, 0.0)));
        assert_eq!(read(column_from), Some((trust, unknown, none, 0.0)));
        assert_eq!(read(column_from - 16), Some((Trust::NONE, unknown, none, 0.0)));
        for cut in [1, 5, 11, 13, 17, 24, 33, 40, 42, 56] {
            assert_eq!(read(bytes.len() - cut), None, "without its last {cut} bytes");
        }
    }
}
