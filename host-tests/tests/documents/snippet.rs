use rundown::{Config, Davis, Direction, Estimator, Measurement, Track, Train};

/// The resistance that a run teaches, from a measurement each 10 s.
pub fn learn(train: Train, log: &[Measurement]) -> Result<Davis, Box<dyn core::error::Error>> {
    let track = Track::try_new(32e3, [])?; // 32 km, flat
    let estimator = Estimator::try_new(Config::default(), train, track)?; // set once
    let mut vehicle = estimator.new_vehicle(); // survives the run
    let mut run = estimator.begin_run(&vehicle, Direction::Up); // changes every tick
    for measurement in log {
        let estimate = estimator.step(&mut run, measurement)?;
        println!("{} s: {}", estimate.time_s, estimate.regime);
    }
    let [r0, r1, r2] = estimator.end_run(&mut run, &mut vehicle).run_davis.mean.into();
    Ok(Davis { r0, r1, r2 })
}
