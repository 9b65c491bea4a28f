//! A run for the budget: traction, holding, coasting, braking, one sample each 10 s, in lockstep.

use std::io::{self, Read, Write};

/// Sends each measurement when the one before is answered.
pub fn drive(line: &mut (impl Read + Write)) -> io::Result<()> {
    frame(line)?;
    let (mut speed_mps, mut location_m) = (0.0_f64, 0.0);
    for tick in 0..90 {
        speed_mps += match tick {
            0..=20 => 1.9,
            21..=40 => 0.0,
            41..=75 => -0.5,
            _ => -5.0,
        };
        speed_mps = speed_mps.max(0.0);
        location_m += 10.0 * speed_mps;
        let values = [
            10.0 * f64::from(tick),
            location_m,
            (3.6 * speed_mps).round() / 3.6,
        ];
        let bytes: Vec<u8> = values
            .iter()
            .flat_map(|value| value.to_le_bytes())
            .collect();
        let mut coded = cobs::encode_vec(&bytes);
        coded.push(0);
        line.write_all(&coded)?;
        frame(line)?;
    }
    Ok(())
}

/// Until the end of a frame.
fn frame(line: &mut impl Read) -> io::Result<()> {
    let mut byte = [1];
    while byte != [0] {
        line.read_exact(&mut byte)?;
    }
    Ok(())
}
