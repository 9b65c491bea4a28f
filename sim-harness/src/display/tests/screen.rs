//! The view in a terminal.

use super::{MESSAGES, hub, on_the_line, shown};
use crate::display::terminal;
use ratatui::{Terminal, backend::TestBackend};
use rundown_wire::Value;

#[test]
fn the_terminal_shows_the_values_of_the_frames() {
    for (width, height) in [(120, 40), (80, 24)] {
        let hub = shown(&on_the_line(&MESSAGES[..MESSAGES.len() - 10]));
        let text = hub.view(|view| {
            let mut screen = Terminal::new(TestBackend::new(width, height)).unwrap();
            screen.draw(|frame| terminal::draw(frame, &view)).unwrap();
            screen.backend().to_string()
        });
        let estimate = hub.view(|view| view.state.now.estimate).unwrap();
        let speed = format!("{:.1} ±{:.1} km/h", estimate.speed_mps.value * 3.6, 1.96 * estimate.speed_mps.sd * 3.6);
        assert!(text.contains(&speed), "{speed} is not in\n{text}");
        assert!(text.contains(&estimate.regime.as_str().to_uppercase()));
        let parameters = hub.view(|view| view.state.now.parameters).unwrap();
        let Value { value, sd } = parameters.at(100.0 / 3.6);
        let effort = hub.view(|view| view.state.now.effort).unwrap();
        let whole = [
            format!("r(100) {value:.5} ±{:.5} N/kg", 1.96 * sd),
            format!("r2    {:>10.3e} ±{:.1e}", parameters.r2.value, 1.96 * parameters.r2.sd),
            format!("most traction  {:>8.4} N/kg", effort.max_traction_n_per_kg),
            "> 130   ".to_owned(),
            "run  coast s  brake s  learned s".to_owned(),
            "q: quit".to_owned(),
        ];
        for words in whole {
            assert!(text.contains(&words), "`{words}` is not in\n{text}");
        }
    }
    // And before anything has come.
    let empty = hub();
    let mut screen = Terminal::new(TestBackend::new(80, 24)).unwrap();
    empty.view(|view| screen.draw(|frame| terminal::draw(frame, &view)).map(drop)).unwrap();
    let text = screen.backend().to_string();
    assert!(text.contains("no run yet") && text.contains("OLD VALUES"), "{text}");
}
