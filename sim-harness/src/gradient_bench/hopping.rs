//! Trains that hop and hold speeds on right gradients: hardly a stretch is coasted, and a held speed looks like a coast
//! on a level line.

use crate::accuracy_bench::{
    fleets::{self, Fleet},
    scales,
};
use crate::gap_bench::draw::{Set, SetRequest, Size};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, Normal};
use rundown_truth::habits::DriverKind;
use rundown_truth::line::Line;
use rundown_truth::plan::Headings;

/// Trains and services, by the names of the accuracy bench.
const FLEETS: [&str; 6] = ["metro", "tram", "suburban", "suburban-1s", "freight", "holding"];
const DRIVERS: [DriverKind; 2] = [DriverKind::ShortHop, DriverKind::HopAndCoast];

/// The fleet of a seed: a service of the accuracy bench on a line of its own, or a set of the gap bench that hides
/// nothing, with drivers who hop.
pub fn fleet(seed: u64) -> Result<Fleet, String> {
    let mut random = ChaCha8Rng::seed_from_u64(seed ^ 0x4055);
    let name = FLEETS[random.random_range(0..FLEETS.len())];
    let mut fleet = fleets::all().into_iter().find(|fleet| fleet.name == name).ok_or("no fleet of this name")?;
    let driver = DRIVERS[random.random_range(0..DRIVERS.len())];
    if random.random_bool(0.5) {
        let [dirty, rough] = [0; 2].map(|_| random.random_bool(0.4));
        let (kinds, size, driver, runs) = (Vec::new(), Size::Clear, Some(driver), super::RUNS);
        let request = SetRequest { kinds, size, effort: false, dirty, rough, driver, nuisance: None, runs, seed };
        fleet.what = "a train of the gap bench, with drivers who hop";
        fleet.scenario = Set::draw(request)?.scenario;
        return Ok(fleet);
    }
    let scenario = &mut fleet.scenario;
    scenario.line = undulating(&scenario.line, &mut random)?;
    if name != "freight" && random.random_bool(0.3) {
        scenario.driver = driver;
    }
    scenario.cycle_share = random.random_range(0.0..0.5);
    scenario.davis_scale = scales(50)[random.random_range(0..50)];
    scenario.wind_sd_mps = random.random_range(0.0..2.0);
    scenario.load_sd = random.random_range(0.0..0.03);
    if random.random_bool(0.5) {
        scenario.headings = Headings::Both;
    }
    Ok(fleet)
}

/// The same on a level line.
pub fn on_level(fleet: &Fleet) -> Fleet {
    let mut fleet = fleet.clone();
    fleet.scenario.line = with_gradients(&fleet.scenario.line, vec![(0.0, 0.0)]);
    fleet
}

/// The same line with slopes of 1 to 6 permille, standard deviation, that do not climb all the way.
fn undulating(line: &Line, random: &mut ChaCha8Rng) -> Result<Line, String> {
    let slope = Normal::new(0.0, random.random_range(1.0..6.0)).map_err(|error| error.to_string())?;
    let mut gradients = vec![(0.0, 0.0)];
    let (mut at_m, mut height_m) = (300.0, 0.0);
    while at_m < line.length_m() - 300.0 {
        let extent_m = f64::from(random.random_range(2..=12)) * 100.0;
        let drawn: f64 = slope.sample(random) - 0.1 * height_m;
        let permille = (10.0 * drawn).round() / 10.0;
        gradients.push((at_m, permille));
        at_m += extent_m;
        height_m += extent_m * permille / 1000.0;
    }
    gradients.push((at_m, 0.0));
    Ok(with_gradients(line, gradients))
}

fn with_gradients(line: &Line, gradients: Vec<(f64, f64)>) -> Line {
    let mut other = Line::new(line.length_m(), gradients, line.limits_kmh().to_vec());
    other.set_calls(line.calls_m().to_vec());
    other
}
