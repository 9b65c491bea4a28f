//! Does a board that is switched off after every run learn what one learns that is never switched off?

use host_tests::accuracy::{NOMINAL, estimator, replay};
use host_tests::flash::Flash;
use host_tests::prelude::*;
use rundown::onboard::store::Store;
use rundown::onboard::store::persisted::Persisted;
use rundown_truth::scenario::fleet;

/// Every learned vehicle is believed again, bit for bit: in each mode, for trains far off their description, in calm
/// and in wind.
#[test]
fn a_boot_after_every_run_changes_no_bit_of_what_is_learned() {
    let train = TrainId::of("2451");
    for mode in [Mode::Gated, Mode::Measured, Mode::Paper] {
        for (scale, wind_sd_mps) in [([0.65; 3], 0.0), ([1.35, 0.8, 1.3], 2.0), ([0.8, 1.4, 0.7], 4.0)] {
            let scenario = Scenario { wind_sd_mps, ..Scenario::default() };
            let estimator = estimator(Config::with_mode(mode), &scenario);
            let mut always_on = estimator.new_vehicle();
            let mut flash = Flash::erased(4);
            for (index, run) in fleet(&scenario, scale, 12, 77).iter().enumerate() {
                let context = format!("{mode:?}, scale {scale:?}, wind {wind_sd_mps}, run {index}");
                let mut store = Store::<_, 1024>::mount(flash).unwrap();
                let loaded =
                    Persisted::load(&mut store, train, &NOMINAL).unwrap_or_else(|cause| panic!("{context}: {cause}"));
                assert_eq!(loaded.is_none(), index == 0, "{context}");
                let mut vehicle = loaded.map_or_else(|| estimator.new_vehicle(), |loaded| loaded.vehicle);
                assert_eq!(vehicle, always_on, "{context}");

                replay(&estimator, &mut vehicle, run);
                replay(&estimator, &mut always_on, run);
                Persisted::new(&vehicle, estimator.effects()).save(&mut store, train).unwrap();
                flash = store.release();
            }
        }
    }
}
