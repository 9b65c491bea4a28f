//! Curves: so many times Roeckl's formula of the curves of the line.

use super::*;
use crate::line::{Curve, Line};
use crate::train::GRAVITY_MPS2;

parameters!(CurveResistance { coefficient_roeckl: f64 });

impl Law for CurveResistance {
    fn check(&self, expect: &Expect) -> Result<(), EffectError> {
        expect.curves()
    }

    fn extra_n_per_kg(&self, setting: &Setting, at: &Moment) -> f64 {
        let mean = roeckl_under(setting.line, at.motion.location_m, setting.train.length_m);
        self.coefficient_roeckl * mean * GRAVITY_MPS2 / setting.train.gamma
    }
}

/// Roeckl's curve resistance as a share of the weight: 0.65/(R - 55 m) from 300 m on, 0.5/(R - 30 m) below.
fn roeckl(radius_m: f64) -> f64 {
    if radius_m < 300.0 { 0.5 / (radius_m.max(50.0) - 30.0) } else { 0.65 / (radius_m - 55.0) }
}

/// Mean of Roeckl's formula along the train.
fn roeckl_under(line: &Line, front_m: f64, length_m: f64) -> f64 {
    let tail_m = front_m - length_m;
    let part = |curve: &Curve| {
        let inside_m = front_m.min(curve.to_m) - tail_m.max(curve.from_m);
        inside_m.max(0.0) * roeckl(curve.radius_m)
    };
    line.curves().iter().take_while(|curve| curve.from_m < front_m).map(part).sum::<f64>() / length_m
}
