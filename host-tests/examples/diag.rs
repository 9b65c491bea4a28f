use host_tests::accuracy::*;
use host_tests::scenario::{Scenario, fleet};
use rundown::config::{Config, Mode};
fn main() {
    let arg = |i: usize| std::env::args().nth(i).and_then(|a| a.parse::<f64>().ok());
    let wind = arg(1).unwrap_or(0.0);
    let mut config = Config::with_mode(Mode::Gated);
    if let Some(q) = arg(2) { config.learning.acceleration_noise_mps2 = q; }
    if let Some(q) = arg(3) { config.learning.end_probability = q; }
    if let Some(q) = arg(4) { config.learning.end_cut_s = q; }
    let mut table = vec![[[0.0f64; 3]; 7]; 3];
    let n = 8;
    for i in 0..n {
        let c = 0.8 + 0.4 * (i as f64) / (n as f64 - 1.0);
        let scale = [c * (1.0 + 0.07 * f64::from(i % 3 - 1)), c * (1.0 + 0.07 * f64::from((i / 2) % 3 - 1)), c * (1.0 - 0.05 * f64::from(i % 2))];
        let scenario = Scenario { wind_sd_mps: wind, ..Scenario::default() };
        let est = estimator(config, &scenario);
        let mut v = est.new_vehicle();
        for (k, run) in fleet(&scenario, scale, 67, 9 + 100 * i as u64).iter().enumerate() {
            let (_, _sum) = replay(&est, &mut v, run);
            let slot = match k { 0 => 0, 9 => 1, 66 => 2, _ => continue };
            for (j, kmh) in (20..=140).step_by(20).enumerate() {
                let truth = rundown::resistance::Davis { r0: NOMINAL.r0 * scale[0], r1: NOMINAL.r1 * scale[1], r2: NOMINAL.r2 * scale[2] }.resistance_n_per_kg(kmh as f64 / 3.6);
                let (r, sd) = resistance(&v.davis(), kmh as f64);
                let e = r / truth - 1.0;
                let t = &mut table[slot][j];
                t[0] += e; t[1] += e * e; t[2] += ((r - truth) / sd).powi(2);
            }
            if k == 66 { println!("scale {:.2?}: wind {:.2}", scale, v.wind_sd_mps(&config.memory)); }
        }
    }
    for (slot, t) in table.iter().enumerate() {
        println!("slot {slot}: (bias %, rmse %, z) {:.2?}", t.iter().map(|t| [100.0 * t[0] / n as f64, 100.0 * (t[1] / n as f64).sqrt(), (t[2] / n as f64).sqrt()]).collect::<Vec<_>>());
    }
}
