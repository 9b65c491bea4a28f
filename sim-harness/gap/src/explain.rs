//! What each effect is, what it does to the residuals, what it can be confused with, and which data would tell.

/// Everything to know about an effect's name.
struct Page {
    name: &'static str,
    what: &'static str,
    law: &'static str,
    parameters: &'static str,
    shows: &'static str,
    confused: &'static str,
    tells: &'static str,
}

/// All names, in the order of the catalogue.
pub const NAMES: [&str; 19] = {
    let mut names = [""; 19];
    let mut i = 0;
    while i < names.len() {
        names[i] = PAGES[i].name;
        i += 1;
    }
    names
};

/// The page of an effect; `None` when there is none of this name.
///
/// ```
/// use crate::explain::explain;
///
/// assert!(explain("steady_wind").is_some_and(|text| text.contains("other direction")));
/// assert_eq!(explain("ghost"), None);
/// ```
pub fn explain(name: &str) -> Option<String> {
    let page = PAGES.iter().find(|page| page.name == name)?;
    Some(format!(
        "{}\n\n{}\n\n  law            {}\n  parameters     {}\n  how it shows   {}\n  confused with  {}\n  what tells     {}\n",
        page.name, page.what, page.law, page.parameters, page.shows, page.confused, page.tells
    ))
}

const PAGES: [Page; 19] = [
    Page {
        name: "tunnel_drag",
        what: "Air drag is larger in a tunnel, for the part of the train that is inside.",
        law: "resistance + k v² x (length inside / train length)",
        parameters: "from_m, to_m; k in N/(kg (m/s)²)",
        shows: "more resistance in one section in both directions, growing with the square of the speed; its edges are as soft as the train is long",
        confused: "gradient_error, where all runs go in one direction at similar speeds",
        tells: "runs in the other direction, runs at another speed, a tunnel in the track file",
    },
    Page {
        name: "curve_resistance",
        what: "Curves cost resistance that the model does not have.",
        law: "resistance + coefficient x Roeckl's formula of the radii, mean under the train",
        parameters: "coefficient_roeckl, 1 for the formula as it stands",
        shows: "more resistance in every curve of the track file, the same at every speed, as much as the curve is tight",
        confused: "gradient_error, on a line with a single curve; davis_error (r0), where the whole line is curved alike",
        tells: "the radii in the track file; several curves with straight track between them",
    },
    Page {
        name: "gradient_error",
        what: "The described gradient is wrong in a section.",
        law: "gradient + delta, mean under the train; in the other direction with the other sign",
        parameters: "from_m, to_m; delta_permille, uphill in the `up` direction positive",
        shows: "a constant force in one section that changes its sign with the direction",
        confused: "tunnel_drag and bad track (`unknown` over location), where all runs go in one direction",
        tells: "runs in the other direction; another survey of the heights",
    },
    Page {
        name: "steady_wind",
        what: "A headwind that all runs have.",
        law: "r2 (v + w)² instead of r2 v²; w changes its sign with the direction",
        parameters: "wind_mps, against the `up` direction positive",
        shows: "a difference that grows with the speed, one way in one direction and the other way in the other",
        confused: "davis_error (r1 above all), where all runs go in one direction",
        tells: "runs in the other direction; a weather station",
    },
    Page {
        name: "run_wind",
        what: "Wind that differs from run to run.",
        law: "r2 (v + w)² with another w in every run",
        parameters: "sd_mps of w between the runs; each run's own w is in `per_run`",
        shows: "each run has its own difference, which grows with the speed, and the mean over the runs is none",
        confused: "loads that differ (a difference under effort, not with the speed)",
        tells: "the wind of each day; an effort column, which shows the load",
    },
    Page {
        name: "mass_error",
        what: "The train is heavier or lighter than described.",
        law: "inertia, gravity and rolling resistance in newton times 1 + relative; effort and air drag in newton stay",
        parameters: "relative: true mass / described mass - 1",
        shows: "the train answers less (or more) to its effort, pulling and braking alike; gradients stay as they are",
        confused: "without an effort column with davis_error (less air drag) and traction_scale; with one, with an effort that is shown too large",
        tells: "an effort column that is calibrated; a weighing",
    },
    Page {
        name: "dragging_brake",
        what: "A brake does not come off after its first application, in some runs.",
        law: "resistance + constant, from the first application on",
        parameters: "drag_n_per_kg; the runs in which it acts",
        shows: "more resistance at every speed after the first braking, in some runs and not in others",
        confused: "a load that differs; warm_up with the other sign",
        tells: "runs that go on after a braking; temperatures of axle boxes and discs",
    },
    Page {
        name: "power_limit_section",
        what: "The supply gives less power in a feeding section.",
        law: "maximum power x factor while the front of the train is inside",
        parameters: "from_m, to_m; factor",
        shows: "at full power the train reaches a part of the described power in one section and all of it elsewhere",
        confused: "traction_scale, where all pulling is done in the section; drivers who ask for less there",
        tells: "pulls at full power inside and outside; the line voltage",
    },
    Page {
        name: "traction_scale",
        what: "The traction gives less (or more) everywhere: a motor is cut out.",
        law: "maximum effort and maximum power x factor",
        parameters: "factor",
        shows: "no pull goes beyond this share of the described limit, at any speed and place",
        confused: "drivers who never ask for everything; mass_error without an effort column",
        tells: "the position of the controller; the number of motors at work",
    },
    Page {
        name: "low_adhesion",
        what: "Wheels slip at low speed, on some days.",
        law: "maximum effort x factor below a speed",
        parameters: "factor, below_kmh; the runs in which it acts",
        shows: "in some runs the effort stays far below its limit at low speed and is normal above",
        confused: "traction_scale, where it acts in all runs; drivers who start gently",
        tells: "records of slip control and sanding; rain",
    },
    Page {
        name: "speed_scale",
        what: "The speed shows too much or too little: a worn wheel, a wrong diameter; or the locations go by another measure.",
        law: "measured speed = factor x true speed",
        parameters: "measured_over_true",
        shows: "the location grows slower (or faster) than the speed says, everywhere alike; or, where the odometer gives the location too, a run's ways between its stops are longer (or shorter) than those of the other runs: then the run is named",
        confused: "a line whose chainage is stretched, in the logs of one vehicle alone; a speed and a location that both come from a receiver cannot show a wheel at all",
        tells: "a satellite receiver beside the odometer; another vehicle on the same line; stops with known chainage",
    },
    Page {
        name: "location_lag",
        what: "The location is late: a slow receiver or a slow bus.",
        law: "location shown at t = true location at t - lag",
        parameters: "lag_s",
        shows: "the location lags behind in proportion to the speed, so it jumps ahead when the train brakes",
        confused: "train_length_error, where only gradients tell",
        tells: "strong accelerations and brakings; the time stamp of the receiver itself",
    },
    Page {
        name: "temperature_resistance",
        what: "Bearings and grease: r0 depends on the ambient temperature.",
        law: "r0 + dr0_per_degC x (temperature - ref_c)",
        parameters: "dr0_per_degC in N/kg per degree; ref_c is a choice of origin",
        shows: "each run has its own constant difference, in line with its temperature",
        confused: "seasonal_drift, where temperature and date go together",
        tells: "another season; days on which temperature and date do not agree; a column ambient_temperature_c",
    },
    Page {
        name: "seasonal_drift",
        what: "r0 drifts over the dates of the runs: wear, or what nobody recorded.",
        law: "r0 + dr0_over_period x (day - first day) / period",
        parameters: "dr0_over_period in N/kg",
        shows: "each run has its own constant difference, in line with its date",
        confused: "temperature_resistance, where temperature and date go together",
        tells: "another season; runs after a workshop visit",
    },
    Page {
        name: "brake_fade",
        what: "Brakes lose effort at high speed.",
        law: "brake effort x (1 - fade x (v - from) / (140 km/h - from)) above the speed `from`",
        parameters: "fade_at_140, from_kmh",
        shows: "an applied brake slows the train less than its effort says, the more the faster it is",
        confused: "davis_error at high speed, in braking only",
        tells: "an effort column (of the demanded brake effort); without one it cannot be seen",
    },
    Page {
        name: "train_length_error",
        what: "The train is longer or shorter than described, so the gradient under it is averaged over another length.",
        law: "gradient mean over the true length",
        parameters: "true_length_m",
        shows: "differences at every change of gradient, up and down with the change of slope",
        confused: "location_lag, which shifts the gradients by the distance of the lag; a location of the antenna instead of the front",
        tells: "both directions; a line with short steep gradients; the list of the vehicles",
    },
    Page {
        name: "warm_up",
        what: "Cold bearings and gears: r0 is larger in the first minutes.",
        law: "r0 + amplitude x exp(-t / tau), t since the departure",
        parameters: "amplitude in N/kg, tau_s",
        shows: "more resistance early in every run, at every place and speed, fading with time",
        confused: "a difference at the first kilometres, where all runs begin at one station; less traction, without an effort column",
        tells: "runs that begin elsewhere; long halts; warm starts after a short turn-round",
    },
    Page {
        name: "davis_error",
        what: "The described Davis coefficients are wrong.",
        law: "r0 + dr0, r1 + dr1, r2 + dr2",
        parameters: "dr0 in N/kg, dr1 in N/(kg m/s), dr2 in N/(kg (m/s)²)",
        shows: "a smooth difference over speed, the same at every place, in every run, in both directions",
        confused: "steady_wind in one direction; mass_error without an effort column. The three parts hide in each other: their sum over the speeds of the runs is what is known",
        tells: "runs in the other direction; a wide range of speeds",
    },
    Page {
        name: "unknown",
        what: "Something that is none of these: a table of extra resistance over the coordinate that explains it best.",
        law: "resistance + table(coordinate), straight between its points",
        parameters: "coordinate: location, speed, time since departure, temperature or day; table in N/kg",
        shows: "as in its table",
        confused: "a named effect that these data show only in part",
        tells: "the picture of the table; then somebody who knows the train and the line",
    },
];

#[cfg(test)]
mod tests {
    use super::*;
    use rundown::model::effects::Effect;

    #[test]
    fn every_effect_of_the_board_has_its_page() {
        let refused = serde_json::from_str::<Effect>(r#"{"name": "ghost"}"#).unwrap_err();
        let text = refused.to_string();
        let mut words = text.split('`').skip(1).step_by(2).filter(|w| *w != "ghost");
        assert!(NAMES.iter().all(|name| words.next() == Some(name)), "{text}");
        assert_eq!(words.next(), None);
        assert!(NAMES.iter().all(|name| explain(name).is_some()));
    }
}
