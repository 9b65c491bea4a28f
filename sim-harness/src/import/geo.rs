//! Distances and directions on the ellipsoid, good over a few kilometres.

use rundown_files::ellipsoid::metres_of_radian;

/// Latitude and longitude, degrees.
pub type Fix = (f64, f64);

/// Where `to` lies from `from`: north and east, m.
pub fn offset_m(from: Fix, to: Fix) -> (f64, f64) {
    let (meridian_m, parallel_m) = metres_of_radian(0.5 * (from.0 + to.0));
    ((to.0 - from.0).to_radians() * meridian_m, (to.1 - from.1).to_radians() * parallel_m)
}

pub fn distance_m(from: Fix, to: Fix) -> f64 {
    let (north, east) = offset_m(from, to);
    north.hypot(east)
}

/// The place `north` and `east` of `from`, m.
pub fn moved(from: Fix, (north, east): (f64, f64)) -> Fix {
    let unit = offset_m(from, (from.0 + 1e-4, from.1 + 1e-4));
    (from.0 + 1e-4 * north / unit.0, from.1 + 1e-4 * east / unit.1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_offset_leads_back() {
        let from = (51.0, 5.0);
        let (north, east) = offset_m(from, moved(from, (300.0, -40.0)));
        assert!((north - 300.0).abs() < 0.1 && (east + 40.0).abs() < 0.1);
        assert!((distance_m((51.0, 5.0), (51.01, 5.0)) - 1112.5).abs() < 0.1);
    }
}
