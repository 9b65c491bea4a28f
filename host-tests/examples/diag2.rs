use host_tests::accuracy::*;
use host_tests::scenario::{Scenario, fleet};
use rundown::config::{Config, Mode};
fn main() {
    let scenario = Scenario::default();
    let est = estimator(Config::with_mode(Mode::Gated), &scenario);
    let mut v = est.new_vehicle();
    let mut errs = vec![];
    for (k, run) in fleet(&scenario, [1.0; 3], 100, 5).iter().enumerate() {
        let (e, sum) = replay(&est, &mut v, run);
        let Some(t) = run.facts.final_coast else { continue };
        let Some(c) = sum.features.final_coast else { println!("{k} none"); continue };
        let d = c.start_time_s - t.time_s;
        errs.push(d);
        if d.abs() > 17.0 {
            let row: String = run.truth.iter().enumerate().filter(|(_, s)| s.time_s > t.time_s.min(c.start_time_s) - 60.0 && s.time_s < t.time_s.max(c.start_time_s) + 60.0).map(|(i, s)| {
                let conf = e.get(i + 1).and_then(|n| n.confirmed).unwrap();
                format!("{:?}/{} ", s.regime, conf.as_str()).replace("Coast", "Co").replace("Cruise", "Cr").replace("Traction", "Tr").replace("coast", "co").replace("cruise", "cr").replace("traction", "tr")
            }).collect();
            println!("{k} {d:.1} v {:.0}: {row}", t.speed_mps * 3.6);
        }
    }
    errs.sort_by(f64::total_cmp);
    println!("{:.1?}", errs);
}
