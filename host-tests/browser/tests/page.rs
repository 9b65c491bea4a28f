//! Does the page show what the board says? In Chromium, with frames of simulated runs over a line that is cut.

use browser_tests::board::{Board, Said};
use browser_tests::browser::{Browser, Scheme};
use browser_tests::display::Display;
use rundown_wire::{Body, CoastArrival, CoastOutcome, Downlink, Learned, Parameters, Regime};
use sim_harness::display::demo;
use std::collections::BTreeMap;
use std::time::Duration;
use tempfile::TempDir;

/// A board, the display that listens to it, and its page in a browser.
struct Desk {
    board: Board,
    display: Display,
    browser: Browser,
    _files: TempDir,
}

impl Desk {
    async fn new(runs: usize) -> Self {
        let files = tempfile::tempdir().expect("a folder");
        let (train, track) = demo::described().expect("the scenario is built in");
        let write = |name: &str, text: Result<String, toml::ser::Error>| {
            let path = files.path().join(name);
            std::fs::write(&path, text.expect("a file that a person could write")).expect("written");
            path.into_os_string().into_string().expect("UTF-8")
        };
        let train = write("train.toml", toml::to_string(&train));
        let track = write("track.toml", toml::to_string(&track));
        Self::with(runs, &["--train", &train, "--track", &track], files).await
    }

    async fn with(runs: usize, described: &[&str], files: TempDir) -> Self {
        let mut board = Board::new(runs);
        let address = board.address().to_string();
        let display = Display::start(&[&["--tcp", &address], described].concat());
        board.accept();
        let browser = Browser::start().await;
        browser.screen(1280, 800, Scheme::Light).await;
        browser.driver().goto(&display.url).await.expect("the page");
        browser
            .wait("link-text", "an open link", |text| text.starts_with("receiving") || text.contains("no frame"))
            .await;
        Self { board, display, browser, _files: files }
    }

    /// Waits for the last tick, then compares every value on the page with the frames.
    async fn check_values(&self) {
        let said = &self.board.said;
        let estimate = said.estimate.expect("an estimate");
        let km = number(Some(estimate.location_m.value), 2, 1e-3);
        self.browser.wait("location", &km, |text| text == km).await;
        for (id, expected) in expected(said) {
            assert_eq!(self.browser.text(id).await, expected, "#{id} of {estimate:?}");
        }
        let shown: BTreeMap<String, String> =
            self.browser.ask("return {learned: document.getElementById('learned').dataset.state, old: String(document.body.classList.contains('old'))}").await;
        let learned = said.parameters.map_or(Learned::NotYet, |parameters| parameters.learned);
        assert_eq!(shown["learned"], learned.as_str());
        assert_eq!(shown["old"], "false");
    }
}

/// As the page writes a number: a dash for none, a true minus sign.
fn number(value: Option<f32>, digits: usize, scale: f64) -> String {
    value.map_or_else(|| "–".to_owned(), |value| format!("{:.digits$}", f64::from(value) * scale).replace('-', "−"))
}

/// What stands on the page, worked out from the frames by themselves.
fn expected(said: &Said) -> BTreeMap<&'static str, String> {
    let estimate = said.estimate.expect("an estimate");
    let parameters = said.parameters.expect("parameters");
    let effort = said.effort.expect("an effort");
    let r100 = parameters.at(100.0 / 3.6);
    // Half of a 95 % interval.
    let half = |sd, digits, scale: f64| format!("±{}", number(Some(sd), digits, 1.96 * scale));
    let mut all = BTreeMap::from([
        ("speed", number(Some(estimate.speed_mps.value), 0, 3.6)),
        ("speed-sd", half(estimate.speed_mps.sd, 1, 3.6)),
        ("location-sd", half(estimate.location_m.sd, 0, 1.0) + " m"),
        ("r100", number(Some(r100.value), 1, 1e3)),
        ("r100-sd", half(r100.sd, 1, 1e3)),
        ("r0", number(Some(parameters.r0.value), 2, 1e3)),
        ("r0-sd", half(parameters.r0.sd, 2, 1e3)),
        ("r1", number(Some(parameters.r1.value), 3, 1e3)),
        ("r1-sd", half(parameters.r1.sd, 3, 1e3)),
        ("r2", number(Some(parameters.r2.value), 4, 1e3)),
        ("r2-sd", half(parameters.r2.sd, 4, 1e3)),
        ("gain", number(parameters.gain.map(|gain| gain.value), 3, 1.0)),
        ("effort", number(effort.effort_n_per_kg, 0, 1e3)),
        ("effort-most", number(Some(effort.max_traction_n_per_kg), 0, 1e3)),
        ("effort-least", number(Some(-effort.max_brake_n_per_kg), 0, 1e3)),
        ("acceleration", number(effort.acceleration_mps2, 3, 1.0)),
        ("gradient", number(Some(effort.gradient_n_per_kg), 1, 1e3)),
    ]);
    if let Some(CoastOutcome::Arrives(arrival)) = said.coast_ahead.map(|ahead| ahead.outcome) {
        let CoastArrival { speed_mps, time_s, .. } = arrival;
        // A 90 % interval.
        let half = f64::from(speed_mps.sd) * 1.645 * 3.6;
        let speed = number(Some(speed_mps.value), 0, 3.6);
        all.insert("advice-speed", format!("{speed} ±{half:.0}"));
        assert!(time_s > estimate.time_s);
    }
    if let Some(features) = said.features {
        all.insert("power-most", number(features.max_power_w_per_kg, 2, 1.0));
        all.insert("cruise", number(features.cruise_speed_median_mps, 1, 3.6));
    }
    all
}

#[tokio::test]
async fn values_on_the_page_are_those_of_the_frames() {
    let mut desk = Desk::new(2).await;
    // Each phase of a run: departure, cruise, coast, brake, standing; then the second run, where all is learned.
    let mut seen = Vec::new();
    let mut arrivals = 0;
    for regime in [Regime::Traction, Regime::Cruise, Regime::Coast, Regime::Brake, Regime::Traction, Regime::Coast] {
        let mut ticks = 0;
        desk.board.play_until(|estimate| {
            ticks += u32::from(estimate.regime == regime && estimate.speed_mps.value > 15.0);
            ticks == 12 || (ticks > 2 && regime == Regime::Brake)
        });
        desk.check_values().await;
        arrivals += usize::from(expected(&desk.board.said).contains_key("advice-speed"));
        let word: String = desk.browser.ask("return document.getElementById('regime').dataset.regime").await;
        assert_eq!(word, regime.as_str());
        seen.push(desk.board.said.parameters.map(|parameters| parameters.learned));
    }
    assert!(
        seen.contains(&Some(Learned::NotYet)) && seen.contains(&Some(Learned::Learned)),
        "both are shown: {seen:?}"
    );
    assert!(arrivals > 0, "a prediction was shown");
    // The first run is over and stands in the list; a browser that comes late has the same.
    let row = "return [...document.querySelectorAll('#past tr:first-child td')].map(cell => cell.textContent)";
    let past: Vec<String> = desk.browser.ask(row).await;
    assert_eq!(past[0], "1", "{past:?}");
    assert!(past[1..].iter().all(|cell| cell != "–"), "{past:?}");
    let points: usize = desk.browser.ask("return state.points.length").await;
    assert!(points > 50, "{points}");
    desk.browser.driver().refresh().await.expect("the page once more");
    desk.check_values().await;
    assert_eq!(desk.browser.ask::<Vec<String>>(row).await, past);
    assert_eq!(desk.browser.ask::<usize>("return state.points.length").await, points);
}

/// What frames say together: worked out here from the frames once more.
#[tokio::test]
async fn learning_and_foresight_are_shown() {
    let mut desk = Desk::new(2).await;
    let mut first = None;
    let mut runs = 0;
    desk.board.play_until(|estimate| {
        runs += u32::from(estimate.dt_s == 0.0);
        runs == 2 && estimate.regime == Regime::Traction
    });
    for message in desk.board.played() {
        if let Body::Parameters(parameters) = Downlink::decode(message).expect("a frame").body {
            first.get_or_insert(parameters);
        }
    }
    let (first, now) = (first.expect("parameters"), desk.board.said.parameters.expect("parameters"));
    assert_eq!(first.learned, Learned::NotYet);
    let bits = [20.0, 60.0, 100.0, 140.0].map(|kmh: f32| (first.at(kmh / 3.6).sd / now.at(kmh / 3.6).sd).log2());
    let words = bits.map(|bits| number(Some(bits), 1, 1.0)).join(" / ");
    let expected = format!("information learned at 20 / 60 / 100 / 140 km/h: {words} bit");
    // The run that has just begun is at a place where the one before was, too: only what was learned says that its
    // frames are shown.
    desk.browser.wait("information", &expected, |text| text == expected).await;
    assert!(bits[2] > 0.5, "a run teaches: {bits:?}");
    let foreseen = desk.browser.text("foreseen").await;
    assert!(foreseen.starts_with("coasts foreseen within their 90 % interval: "), "{foreseen}");
    let sensor = "return [...document.querySelectorAll('#link div')].find((row) => row.firstChild.textContent === 'suspected sensor').lastChild.textContent";
    assert_eq!(desk.browser.ask::<String>(sensor).await, "none");
    let restarts = "return [...document.querySelectorAll('#link div')].find((row) => row.firstChild.textContent === 'board restarted').lastChild.textContent";
    assert_eq!(desk.browser.ask::<String>(restarts).await, "2", "with each run");
    let firmware = "return [...document.querySelectorAll('#link div')].find((row) => row.firstChild.textContent === 'firmware').lastChild.textContent";
    let firmware: String = desk.browser.ask(firmware).await;
    assert!(firmware.starts_with(env!("CARGO_PKG_VERSION")), "of the second run, too: {firmware}");
}

#[tokio::test]
async fn several_units_stand_side_by_side_and_a_swipe_goes_on() {
    let files = tempfile::tempdir().expect("a folder");
    let other = files.path().join("other.frames");
    let frames = Board::new(1);
    std::fs::write(&other, frames.recording()).expect("written");
    let other = other.into_os_string().into_string().expect("UTF-8");
    let mut desk = Desk::with(2, &["--beside", &other], files).await;
    desk.board.play_until(|estimate| estimate.regime == Regime::Cruise);
    desk.check_values().await;
    desk.browser.wait_for("return document.body.classList.contains('several')").await;
    desk.browser.press("7").await;
    let rows = "return [...document.querySelectorAll('#units tr')].map((row) => [...row.cells].map((cell) => cell.textContent))";
    let shown = "const r = document.querySelectorAll('#units tr'); return r.length === 2 && [...r].every((row) => row.cells[1].textContent !== '–')";
    desk.browser.wait_for(shown).await;
    let rows: Vec<Vec<String>> = desk.browser.ask(rows).await;
    let r100 = |parameters: Parameters| number(Some(parameters.at(100.0 / 3.6).value), 1, 1e3);
    assert_eq!(rows[0][1], r100(desk.board.said.parameters.expect("parameters")), "{rows:?}");
    assert_eq!((rows[1][0].as_str(), &rows[1][1]), (other.as_str(), &r100(frames.last_parameters())), "{rows:?}");
    assert_ne!(rows[0][1], rows[1][1], "two units");
    desk.browser.picture("units_1280x800_light").await;

    desk.browser.screen(400, 800, Scheme::Dark).await;
    let swipe = async |from: f64, to: f64| {
        desk.browser.touch("touchStart", &[[from, 400.0]]).await;
        desk.browser.touch("touchMove", &[[to, 402.0]]).await;
        desk.browser.touch("touchEnd", &[]).await;
        desk.browser.ask::<String>("return document.body.dataset.view").await
    };
    assert_eq!(swipe(100.0, 300.0).await, "6", "to the right: the one before");
    assert_eq!(swipe(300.0, 100.0).await, "7");
    assert_eq!(swipe(300.0, 280.0).await, "7", "too short");
    tokio::time::sleep(Duration::from_millis(300)).await;
    desk.browser.picture("units_400x800_dark").await;
    let wide: u32 = desk.browser.ask("return document.documentElement.scrollWidth").await;
    assert!(wide <= 400, "{wide} px wide");
}

#[tokio::test]
async fn without_a_description_the_page_says_what_is_missing() {
    let files = tempfile::tempdir().expect("a folder");
    let mut desk = Desk::with(1, &[], files).await;
    desk.board.play_until(|estimate| estimate.regime == Regime::Cruise);
    desk.check_values().await;
    let strip = "return getComputedStyle(document.getElementById('gradients'), '::before').content";
    let words: String = desk.browser.ask(strip).await;
    assert!(words.contains("--track K.toml"), "{words}");
    for id in ["r0-described", "r1-described", "r2-described", "effort-kn"] {
        assert_eq!(desk.browser.text(id).await, "", "#{id}");
    }
    // The chart's words are drawn, not written.
    let words: String = desk.browser.ask("return manufacturerWords(null)").await;
    assert!(words.contains("--train T.toml"), "{words}");
    desk.browser.picture("undescribed_1280x800_light").await;
}

#[tokio::test]
async fn a_frame_is_on_the_page_within_a_second() {
    let mut desk = Desk::new(1).await;
    for _ in 0..10 {
        let mut last = None;
        desk.board.play_until(|estimate| {
            last = Some(*estimate);
            estimate.regime != Regime::Standstill
        });
        let time = last.expect("an estimate").time_s;
        let waiting = std::time::Instant::now();
        while desk.browser.ask::<Option<f64>>("return state.now.estimate?.time_s ?? null").await != Some(time) {
            assert!(waiting.elapsed() < Duration::from_secs(1), "{:?}", waiting.elapsed());
        }
    }
}

#[tokio::test]
async fn the_page_survives_a_cut_and_noise() {
    let mut desk = Desk::new(1).await;
    desk.board.play_until(|estimate| estimate.regime == Regime::Traction && estimate.speed_mps.value > 20.0);
    desk.check_values().await;
    let before = desk.browser.text("speed").await;

    desk.board.cut();
    desk.browser.wait("link-text", "a lost link", |text| text.starts_with("link lost")).await;
    assert!(desk.browser.ask::<bool>("return document.body.classList.contains('old')").await, "old values are marked");
    assert!(desk.browser.text("validity").await.contains("these values are old"));
    assert_eq!(desk.browser.text("speed").await, before, "they are still there");

    // The display comes back by itself; frames that were sent meanwhile are lost, and the line begins with the rest of
    // one.
    desk.board.accept();
    let lost = 1 + desk.board.lose(7);
    desk.board.noise(&[0x13, 0x55, 0xFF, 0x00, 0xA0, 0x01]);
    desk.board.noise(&[0x00]);
    desk.board.play_until(|estimate| estimate.regime == Regime::Cruise);
    desk.check_values().await;
    assert_eq!(desk.browser.text("lost").await, lost.to_string());
    assert_eq!(desk.browser.text("damaged").await, "2");
    let reconnects: u32 = desk.browser.ask("return state.link.reconnects").await;
    assert_eq!(reconnects, 1);
    let gaps: usize = desk.browser.ask("return state.points.filter(point => point[8]).length").await;
    assert_eq!(gaps, 1, "no line is drawn over what was not heard");

    // Garbage for a while, without a zero, then with many.
    desk.board.noise(&vec![0xA5; 20_000]);
    desk.board.noise(&vec![0; 1000]);
    desk.board.play_until(|estimate| estimate.regime == Regime::Coast);
    desk.check_values().await;
}

#[tokio::test]
async fn the_page_says_when_the_display_has_gone() {
    let mut desk = Desk::new(1).await;
    desk.board.play_until(|estimate| estimate.speed_mps.value > 5.0);
    desk.check_values().await;
    drop(desk.display);
    desk.browser.wait("validity", "the end", |text| text.contains("has ended")).await;
    assert!(desk.browser.ask::<bool>("return document.body.classList.contains('old')").await);
}

/// Where every part is: nothing moves when values come.
const PLACES: &str = "return Object.fromEntries([...document.querySelectorAll('header > *, section, section > *, footer > *, nav button, #parameters tr, #brake tr')]
    .map((e, i) => [i + ' ' + (e.id || e.className || e.tagName), e]).filter(([name, e]) => e.offsetParent && !(e instanceof HTMLDListElement))
    .map(([name, e]) => { const r = e.getBoundingClientRect(); return [name, [r.x, r.y, r.width, r.height].map(Math.round).join(' ')]; }))";

/// Words and numbers that are cut off; the one line that may be is the small one below a number. Wide values are filled
/// in: few runs have all.
const OUTSIDE: &str = "for (const row of document.getElementById('brake').rows) [row.cells[1].textContent, row.cells[2].textContent] = ['0.56', 's.d. 0.08'];
    for (const [id, text] of [['acceleration', '\u{2212}0.139'], ['power-most-mw', '2.03 MW'], ['power-mean-sd', 's.d. 0.72']]) document.getElementById(id).textContent = text;
    return [...document.querySelectorAll('header b, header small, header .label, #regime i, #legend > span, nav button, .counts b, td, th')].filter(e => e.offsetParent && e.textContent.trim()).filter(e => {
        const inner = document.createRange(); inner.selectNodeContents(e);
        const r = inner.getBoundingClientRect(), place = e.closest('header > *, section, footer').getBoundingClientRect(), cell = e.closest('td, th')?.getBoundingClientRect() ?? place;
        return r.left < Math.max(place.left, cell.left) - 1 || r.right > Math.min(place.right, cell.right) + 1;
    }).map(e => e.id + ' ' + e.textContent)";

/// Screens on which the page is looked at, px.
const SCREENS: [(u32, u32); 12] = [
    (1920, 1080),
    (1600, 900),
    (1280, 1024),
    (1280, 900),
    (1280, 800),
    (1024, 768),
    (800, 1280),
    (800, 480),
    (720, 480),
    (640, 480),
    (500, 800),
    (400, 800),
];
/// Narrower ones have the layout of a phone.
const PHONE: u32 = 800;

#[tokio::test]
async fn the_page_looks_right_on_every_screen() {
    let mut desk = Desk::new(2).await;
    let browser = &desk.browser;
    let mut empty = BTreeMap::new();
    for (width, height) in SCREENS {
        browser.screen(width, height, Scheme::Light).await;
        let places: BTreeMap<String, String> = browser.ask(PLACES).await;
        empty.insert((width, height), places);
    }
    browser.picture("waiting_800x480_light").await;
    assert_eq!(browser.text("learned").await, "not learned yet");
    assert_eq!(browser.text("speed").await, "–");

    let mut coasting = 0;
    desk.board.play_until(|estimate| {
        coasting += u32::from(estimate.regime == Regime::Coast && estimate.speed_mps.value > 20.0);
        estimate.time_s > 0.0 && coasting == 60
    });
    desk.check_values().await;
    for (width, height) in SCREENS {
        for scheme in [Scheme::Light, Scheme::Dark] {
            browser.screen(width, height, scheme).await;
            browser.press("0").await;
            let places: BTreeMap<String, String> = browser.ask(PLACES).await;
            let moved: Vec<_> =
                places.iter().filter(|(name, place)| empty[&(width, height)].get(*name) != Some(*place)).collect();
            assert!(moved.is_empty(), "{width}x{height}: {moved:?} from {:?}", empty[&(width, height)]);
            let outside: Vec<String> = browser.ask(OUTSIDE).await;
            assert_eq!(outside, Vec::<String>::new(), "{width}x{height}: all is inside its place");
            let regimes: u32 = browser
                .ask("return [...document.querySelectorAll('#legend > span')].filter((e) => e.offsetParent).length")
                .await;
            assert_eq!(regimes, 5, "{width}x{height}: the legend has every regime");
            let wide: u32 = browser.ask("return document.documentElement.scrollWidth").await;
            assert!(wide <= width, "{wide} px wide on a screen of {width}");
            for view in 0..=6 {
                browser.press(&view.to_string()).await;
                tokio::time::sleep(Duration::from_millis(250)).await;
                let found: String = browser.ask("return document.body.dataset.view").await;
                assert_eq!(found, view.to_string());
                if width < PHONE {
                    let outside: Vec<String> = browser.ask(OUTSIDE).await;
                    assert_eq!(outside, Vec::<String>::new(), "part {view} on a phone");
                }
                let png = browser.picture(&format!("{view}_{width}x{height}_{}", scheme.word())).await;
                // Width and height stand behind the signature and the name of the first chunk.
                assert_eq!(png[16..24], [width.to_be_bytes(), height.to_be_bytes()].concat());
            }
        }
    }
    // By keys alone: n changes the colours, Tab reaches every button.
    browser.screen(1280, 800, Scheme::Light).await;
    browser.wait_for("return document.documentElement.dataset.scheme === 'day'").await;
    browser.press("n").await;
    browser.wait_for("return document.documentElement.dataset.scheme === 'night'").await;
    let mut reached = Vec::new();
    for _ in 0..20 {
        browser.driver().action_chain().send_keys(thirtyfour::Key::Tab).perform().await.expect("Tab");
        reached.push(
            browser.ask::<String>("return document.activeElement.dataset?.go ?? document.activeElement.id").await,
        );
    }
    for button in ["0", "1", "2", "3", "4", "5", "6", "scheme"] {
        assert!(reached.iter().any(|id| id == button), "{button} is not among {reached:?}");
    }
    // Nothing comes from elsewhere, and nothing went wrong.
    let foreign: Vec<String> = browser.ask("return performance.getEntriesByType('resource').map(r => r.name).filter(n => !n.startsWith(location.origin))").await;
    assert_eq!(foreign, Vec::<String>::new());
}
