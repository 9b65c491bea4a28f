//! WGS 84: how long a degree is.

const SEMI_MAJOR_M: f64 = 6_378_137.0;
const ECCENTRICITY_SQUARED: f64 = 6.694_379_990_14e-3;

/// Metres of a radian along the meridian and along the parallel, at a latitude in degrees.
///
/// ```
/// use rundown_files::ellipsoid::metres_of_radian;
///
/// let (north, east) = metres_of_radian(60.0);
/// assert!((north.to_radians() - 111_412.0).abs() < 1.0 && (east.to_radians() - 55_800.0).abs() < 1.0);
/// ```
pub fn metres_of_radian(latitude_deg: f64) -> (f64, f64) {
    let (sin, cos) = latitude_deg.to_radians().sin_cos();
    let flattened = 1.0 - ECCENTRICITY_SQUARED * sin * sin;
    let meridian_m = SEMI_MAJOR_M * (1.0 - ECCENTRICITY_SQUARED) / flattened.powf(1.5);
    (meridian_m, SEMI_MAJOR_M / flattened.sqrt() * cos)
}
