//! What would tell two effects apart that the data at hand do not.

/// What the data at hand have already.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Have {
    /// An effort column.
    pub effort: bool,
    /// Runs in both directions.
    pub both_directions: bool,
}

const OTHER_DIRECTION: &str = "runs in the other direction";
const OTHER_SPEED: &str = "runs at another speed";
const EFFORT: &str = "an effort column";

/// What to look for next. Never what the data have already.
pub fn separates(a: &str, b: &str, have: Have) -> &'static str {
    let pair = |x: &str, y: &str| (a == x && b == y) || (a == y && b == x);
    let place =
        |name: &str| matches!(name, "tunnel_drag" | "gradient_error" | "curve_resistance" | "train_length_error");
    // A gradient changes its sign with the direction, so does a wind; nothing else does.
    let turns = |name: &str| matches!(name, "gradient_error" | "steady_wind" | "train_length_error");
    if !have.both_directions && turns(a) != turns(b) {
        return OTHER_DIRECTION;
    }
    if pair("seasonal_drift", "temperature_resistance") {
        return "another season";
    }
    if pair("speed_scale", "location_lag") {
        return "a location that does not come from the wheel";
    }
    if pair("run_wind", "dragging_brake") {
        return "longer coasting, from high speed to low";
    }
    if pair("warm_up", "unknown") || pair("warm_up", "davis_error") {
        return "runs that begin at another place or speed";
    }
    let by_effort = |name: &str| matches!(name, "mass_error" | "traction_scale" | "power_limit_section" | "brake_fade");
    if !have.effort && (by_effort(a) || by_effort(b)) {
        return EFFORT;
    }
    if place(a) || place(b) || pair("davis_error", "unknown") || pair("davis_error", "steady_wind") {
        return OTHER_SPEED;
    }
    if have.effort { "more runs" } else { EFFORT }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_the_data_have_is_not_asked_for() {
        let names = crate::explain::NAMES;
        for effort in [false, true] {
            for both_directions in [false, true] {
                let have = Have { effort, both_directions };
                for (a, b) in names.iter().flat_map(|a| names.iter().map(move |b| (a, b))) {
                    let advice = separates(a, b, have);
                    assert_eq!(advice, separates(b, a, have));
                    assert!(!(both_directions && advice == OTHER_DIRECTION), "{a} {b}");
                    assert!(!(effort && advice == EFFORT), "{a} {b}");
                }
            }
        }
    }

    #[test]
    fn a_tunnel_and_a_gradient_are_told_by_the_other_direction_first() {
        let have = |both_directions| Have { effort: true, both_directions };
        assert_eq!(separates("tunnel_drag", "gradient_error", have(false)), OTHER_DIRECTION);
        assert_eq!(separates("tunnel_drag", "gradient_error", have(true)), OTHER_SPEED);
    }
}
