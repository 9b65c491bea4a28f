//! Can a report be explored? In Chromium, from the disk: zoom, linked cursors, legend, axis, tables, day and night,
//! narrow screens.

use browser_tests::browser::{Browser, Scheme};
use browser_tests::reports::Reports;

/// Least and largest x of each plot.
const ENDS: &str = "return [...plots].map((u) => [u.scales.x.min, u.scales.x.max])";
/// Where the first plot is on the screen: left, top, width, height.
const PLACE: &str = "const r = [...plots][0].over.getBoundingClientRect(); return [r.left, r.top, r.width, r.height]";
const ALIVE: &str = "return document.querySelectorAll('figure.is-live').length > 1 && plots.size > 1";
const WRONG: &str = "return wrong";
/// Numbers of an axis that are cut off at the edge of their plot.
const CUT: &str = "return [...plots].flatMap((u) => {
    u.ctx.font = '12px system-ui, sans-serif';
    const width = (text) => u.ctx.measureText(text).width;
    const of = (axis) => axis._splits.map((at, i) => [at, axis._values[i]]).filter(([at, text]) => text);
    const right = of(u.axes[0]).filter(([at, text]) => u.valToPos(at, 'x') + u.bbox.left / devicePixelRatio + width(text) / 2 > u.width + 1);
    const left = of(u.axes[1]).filter(([at, text]) => width(text) > u.axes[1]._size);
    return right.concat(left).map(([at, text]) => `${u.rundown.panel.label}: ${text}`);
})";
/// White paper behind a picture.
const PAPER: &str = "return [...document.querySelectorAll('svg > rect:first-of-type')].filter((r) => getComputedStyle(r).fill !== 'none').length";

async fn browser() -> Browser {
    let browser = Browser::start().await;
    browser.screen(1400, 900, Scheme::Light).await;
    browser
}

/// Nothing went wrong, and nothing was asked for but files beside the page.
async fn check_quiet(browser: &Browser) {
    assert_eq!(browser.ask::<Vec<String>>(WRONG).await, Vec::<String>::new());
    let asked: Vec<String> = browser.ask("return performance.getEntriesByType('resource').map((r) => r.name)").await;
    assert!(asked.iter().all(|name| name.starts_with("file://") || name.starts_with("data:")), "{asked:?}");
}

#[tokio::test]
async fn the_plots_of_a_run_zoom_together_and_share_their_cursor() {
    let reports = Reports::of(2);
    reports.replay();
    let browser = browser().await;
    reports.open(&browser, "out/report.html").await;
    // The page of a run is one link away, read only now.
    browser.ask::<()>("document.querySelectorAll('#runs tbody a')[1].click()").await;
    browser.wait_for("return document.querySelector('h1').textContent === 'run002'").await;
    browser.wait_for(ALIVE).await;
    let whole: Vec<[f64; 2]> = browser.ask(ENDS).await;
    let [left, top, width, height]: [f64; 4] = browser.ask(PLACE).await;
    let at = |x: f64| [left + x * width, top + 0.5 * height];

    browser.mouse("mouseMoved", at(0.25), 0).await;
    let cursors: Vec<f64> = browser.ask("return [...plots].map((u) => u.cursor.left)").await;
    assert!(cursors.iter().all(|x| (x - 0.25 * width).abs() < 3.0), "{cursors:?} of {width}");
    let values: String = browser.ask("return [...plots][1].root.querySelector('.u-legend').textContent").await;
    assert!(values.contains("at") && values.contains("km") && values.contains("estimated1"), "{values}");

    browser.drag(at(0.25), at(0.5)).await;
    let part: Vec<[f64; 2]> = browser.ask(ENDS).await;
    for ([least, most], [from, to]) in part.iter().zip(&whole) {
        let share = (most - least) / (to - from);
        assert!((0.24..0.26).contains(&share), "{part:?} of {whole:?}");
    }
    for clicks in [1, 2] {
        browser.mouse("mousePressed", at(0.5), clicks).await;
        browser.mouse("mouseReleased", at(0.5), clicks).await;
    }
    assert_eq!(browser.ask::<Vec<[f64; 2]>>(ENDS).await, whole, "a double click shows all again");
    check_quiet(&browser).await;
}

/// What is seen here is docs/pictures/report.png.
#[tokio::test]
async fn the_values_under_the_cursor_stand_above_each_plot() {
    let reports = Reports::of(2);
    reports.replay();
    let browser = browser().await;
    browser.screen(900, 1330, Scheme::Light).await;
    reports.open(&browser, "out/report/run0001.html").await;
    let motion =
        "const all = [...document.querySelectorAll('section')].find((s) => s.textContent.startsWith('Motion and'));";
    browser.ask::<()>(&format!("{motion} all.scrollIntoView()")).await;
    browser.wait_for(&format!("{motion} return all.querySelectorAll('.plot').length === 6")).await;
    let place =
        "const r = all.querySelector('.u-over').getBoundingClientRect(); return [r.left, r.top, r.width, r.height]";
    let [left, top, width, height]: [f64; 4] = browser.ask(&format!("{motion} {place}")).await;
    browser.mouse("mouseMoved", [left + 0.8 * width, top + 0.6 * height], 0).await;
    tokio::time::sleep(std::time::Duration::from_millis(300)).await;
    let values = "return [...all.querySelectorAll('.u-legend')].map((legend) => legend.textContent)";
    let values: Vec<String> = browser.ask(&format!("{motion} {values}")).await;
    let estimated = ["estimated1", "before\u{2212}0.0", "before0.0", "estimated7.", "estimated1.", "estimated2."];
    for (text, estimated) in values.iter().zip(estimated) {
        assert!(text.contains("at25.") && text.contains(estimated), "{estimated}: {text}");
    }
    assert_eq!(values.len(), 6);
    browser.picture("run_900x1330_light").await;
    check_quiet(&browser).await;
}

#[tokio::test]
async fn two_fingers_zoom_and_one_scrolls() {
    let reports = Reports::of(1);
    reports.replay();
    let browser = browser().await;
    browser.screen(400, 700, Scheme::Light).await;
    reports.open(&browser, "out/report/run0001.html").await;
    browser.wait_for(ALIVE).await;
    browser.ask::<()>("[...plots][0].over.scrollIntoView({block: 'center'})").await;
    let whole: Vec<[f64; 2]> = browser.ask(ENDS).await;
    let [left, top, width, height]: [f64; 4] = browser.ask(PLACE).await;
    let at = |x: f64| [left + x * width, top + 0.5 * height];

    // From a quarter of the axis to half of it under the fingers: what they hold stays under them.
    browser.touch("touchStart", &[at(0.375), at(0.625)]).await;
    browser.touch("touchMove", &[at(0.25), at(0.75)]).await;
    browser.touch("touchEnd", &[]).await;
    let part: Vec<[f64; 2]> = browser.ask(ENDS).await;
    for ([least, most], [from, to]) in part.iter().zip(&whole) {
        let [begin, end] = [least, most].map(|x| (x - from) / (to - from));
        assert!((begin - 0.25).abs() < 0.02 && (end - 0.75).abs() < 0.02, "{part:?} of {whole:?}");
    }
    // Together to the left: the axis is shifted and keeps its length.
    browser.touch("touchStart", &[at(0.5), at(0.9)]).await;
    browser.touch("touchMove", &[at(0.3), at(0.7)]).await;
    browser.touch("touchEnd", &[]).await;
    let shifted: Vec<[f64; 2]> = browser.ask(ENDS).await;
    let [[least, most], [from, to]] = [shifted[0], whole[0]];
    assert!(((least - from) / (to - from) - 0.35).abs() < 0.02, "{shifted:?} of {whole:?}");
    assert!(((most - least) / (to - from) - 0.5).abs() < 0.02, "{shifted:?} of {whole:?}");

    let [x, y] = at(0.5);
    browser.touch("touchStart", &[[x, y]]).await;
    browser.touch("touchMove", &[[x, y - 100.0]]).await;
    browser.touch("touchEnd", &[]).await;
    assert_eq!(browser.ask::<Vec<[f64; 2]>>(ENDS).await, shifted, "one finger does not zoom");
    check_quiet(&browser).await;
}

#[tokio::test]
async fn a_series_is_switched_off_and_the_axis_is_location_or_time() {
    let reports = Reports::of(1);
    reports.replay();
    let browser = browser().await;
    reports.open(&browser, "out/report/run0001.html").await;
    browser.wait_for(ALIVE).await;
    let ink = "const c = [...plots][1].ctx.canvas, d = c.getContext('2d').getImageData(0, 0, c.width, c.height).data; \
               let n = 0; for (let i = 0; i < d.length; i += 4) n += d[i] > 180 && d[i + 1] < 80 && d[i + 3] > 200; return n";
    let before: u32 = browser.ask(ink).await;
    browser.ask::<()>("[...plots][1].root.querySelectorAll('.u-series th')[1].click()").await;
    browser.wait_for("return ![...plots][1].series[1].show").await;
    tokio::time::sleep(std::time::Duration::from_millis(100)).await;
    let after: u32 = browser.ask(ink).await;
    assert!(before > 200 && after < before / 10, "red dots of the estimate: {before} before, {after} after");

    let minutes =
        "[...document.querySelectorAll('.toolbar button')].find((b) => b.textContent === 'over time').click()";
    browser.ask::<()>(minutes).await;
    browser.wait_for("return [...plots].every((u) => u.rundown.figure.x_label.startsWith('time'))").await;
    assert!(browser.ask::<bool>("return ![...plots][1].series[1].show").await, "it stays off");
    let off = "return [...plots].flatMap((u) => u.series.filter((s) => !s.show).map((s) => [u.rundown.panel.label, s.label]))";
    let off: Vec<[String; 2]> = browser.ask(off).await;
    assert_eq!(off.len(), 1, "in its panel alone: {off:?}");
    let ends: Vec<[f64; 2]> = browser.ask(ENDS).await;
    assert!(ends.iter().all(|[from, to]| *from == 0.0 && (5.0..60.0).contains(to)), "{ends:?}");

    let svg = "let made; URL.createObjectURL = (blob) => { made = blob; return 'data:,'; }; \
               [...document.querySelectorAll('.toolbar button')].find((b) => b.textContent === 'SVG').click(); return made.text()";
    let svg: String = browser.ask(svg).await;
    assert!(svg.starts_with("<svg xmlns=\"http://www.w3.org/2000/svg\"") && svg.contains("coast "), "{svg:.200}");
    check_quiet(&browser).await;
}

#[tokio::test]
async fn every_area_has_its_colour_in_the_legend() {
    let reports = Reports::of(1);
    reports.replay();
    let browser = browser().await;
    // Figures far below the screen are not live.
    browser.screen(1400, 9000, Scheme::Light).await;
    reports.open(&browser, "out/report/run0001.html").await;
    let bars = "return [...plots].some((u) => u.rundown.panel.layers.some((l) => l.kind === 'bars' && l.legend))";
    browser.wait_for(bars).await;
    let areas = "return [...document.querySelectorAll('.u-series.area .u-marker')].map((m) => getComputedStyle(m).backgroundColor)";
    let areas: Vec<String> = browser.ask(areas).await;
    assert!(!areas.is_empty() && areas.iter().all(|colour| colour != "rgba(0, 0, 0, 0)"), "{areas:?}");
}

#[tokio::test]
async fn a_table_sorts_by_any_column_and_filters() {
    let reports = Reports::of(12);
    reports.replay();
    let browser = browser().await;
    reports.open(&browser, "out/report.html").await;
    let names = "return [...document.querySelectorAll('#runs tbody tr')].filter((r) => !r.hidden).map((r) => r.cells[0].textContent)";
    let minutes =
        "return [...document.querySelectorAll('#runs tbody tr')].map((r) => parseFloat(r.cells[1].textContent))";
    let written: Vec<String> = browser.ask(names).await;
    assert_eq!(written.len(), 12);
    let click = "document.querySelectorAll('#runs thead th')[1].click()";
    browser.ask::<()>(click).await;
    let rising: Vec<f64> = browser.ask(minutes).await;
    assert!(rising.is_sorted(), "{rising:?}");
    browser.ask::<()>(click).await;
    let falling: Vec<f64> = browser.ask(minutes).await;
    assert!(falling.iter().rev().is_sorted() && falling != rising, "{falling:?}");
    // The second row of the head: a column below a group.
    browser
        .ask::<()>("[...document.querySelectorAll('#runs thead th')].find((h) => h.textContent === 'coast').click()")
        .await;
    let shares: Vec<f64> = browser
        .ask("return [...document.querySelectorAll('#runs tbody tr')].map((r) => parseFloat(r.cells[12].textContent))")
        .await;
    assert!(shares.is_sorted(), "{shares:?}");

    let search = browser.driver().find(thirtyfour::By::Css("input[type=search]")).await.expect("a field");
    search.send_keys("run01").await.expect("keys");
    let mut found: Vec<String> = browser.ask(names).await;
    found.sort();
    assert_eq!(found, ["run010", "run011", "run012"]);
    browser.wait_for("return document.querySelector('.filter output').textContent === '3 of 12'").await;
    check_quiet(&browser).await;
}

#[tokio::test]
async fn every_page_fits_by_day_and_by_night() {
    let reports = Reports::of(8);
    reports.replay();
    reports.rundown(&["check", "--out", "check", "set/runs"]);
    reports.rundown(&["study", "--count", "3", "--out", "study"]);
    reports.gap();
    let browser = browser().await;
    let pages = [
        "out/report.html",
        "out/report/run0002.html",
        "check/report.html",
        "check/report/run0002.html",
        "study/report.html",
        "study/report/run0003.html",
        "gap/report.html",
        "gap/report/run0001.html",
    ];
    for page in pages {
        for (width, scheme) in [(400, Scheme::Light), (400, Scheme::Dark), (900, Scheme::Light), (1400, Scheme::Dark)] {
            browser.screen(width, 1000, scheme).await;
            reports.open(&browser, page).await;
            browser.wait_for("return plots.size > 0").await;
            tokio::time::sleep(std::time::Duration::from_millis(200)).await;
            let wide: u32 = browser.ask("return document.documentElement.scrollWidth").await;
            assert!(wide <= width, "{page} is {wide} px wide on a screen of {width}");
            if page == "out/report.html" && width == 1400 {
                let beyond =
                    "const wide = document.querySelector('#runs .wide'); return wide.scrollWidth - wide.clientWidth";
                assert_eq!(browser.ask::<u32>(beyond).await, 0, "the table of runs has more columns than fit");
            }
            if page == "check/report.html" {
                // What was measured is there whole, and of each run what was found begins on the screen.
                let cut = "const edges = (rows, column) => [...document.querySelectorAll(rows)].map((row) => row.cells[column].getBoundingClientRect()); \
                           return [edges('#recorder-1 > .wide:first-of-type tbody tr', 3).filter((e) => e.right > innerWidth).length, \
                                   edges('#runs tbody tr', 2).filter((e) => e.left > innerWidth / 2).length]";
                assert_eq!(browser.ask::<[u32; 2]>(cut).await, [0; 2], "cells that are cut off at {width} px");
            }
            let ground: String = browser.ask("return getComputedStyle(document.documentElement).backgroundColor").await;
            let expected = if scheme == Scheme::Dark { "rgb(20, 23, 27)" } else { "rgb(255, 255, 255)" };
            assert_eq!(ground, expected, "{page}");
            check_quiet(&browser).await;
            assert_eq!(browser.ask::<Vec<String>>(CUT).await, Vec::<String>::new(), "{page} at {width} px");
            assert_eq!(browser.ask::<u32>(PAPER).await, 0, "{page}");
            let name = page.replace('/', "_").replace(".html", "");
            browser.picture(&format!("{name}_{width}_{}", scheme.word())).await;
        }
    }
    // What the reader chooses is stronger than what the system prefers.
    browser.ask::<()>("document.getElementById('scheme').click()").await;
    let ground: String = browser.ask("return getComputedStyle(document.documentElement).backgroundColor").await;
    assert_eq!(ground, "rgb(255, 255, 255)");
}

#[tokio::test]
async fn each_run_of_a_study_and_of_a_gap_has_its_page() {
    let reports = Reports::of(8);
    reports.rundown(&["study", "--count", "3", "--out", "study"]);
    reports.gap();
    let browser = browser().await;
    for (first, runs) in [("study/report.html", 3), ("gap/report.html", 8)] {
        reports.open(&browser, first).await;
        let links = "return [...document.querySelectorAll('#runs tbody th a')].map((a) => a.textContent)";
        let names: Vec<String> = browser.ask(links).await;
        assert_eq!(names.len(), runs, "{first}");
        browser.ask::<()>("document.querySelector('#runs tbody th a').click()").await;
        // From page to page, to the last one and back to the table.
        for name in &names {
            browser.wait_for(&format!("return document.querySelector('h1').textContent === '{name}'")).await;
            browser.wait_for("return plots.size > 1").await;
            check_quiet(&browser).await;
            let next = "const a = [...document.querySelectorAll('a')].find((a) => a.textContent.startsWith('next: ')); a && a.click()";
            browser.ask::<()>(next).await;
        }
        browser.ask::<()>("document.querySelector('a[href$=\"report.html#runs\"]').click()").await;
        browser.wait_for("return location.hash === '#runs'").await;
    }
    reports.rundown(&["study", "--count", "3", "--out", "bare", "--no-run-pages"]);
    assert!(!reports.has("bare/report"));
    reports.open(&browser, "bare/report.html").await;
    browser.wait_for("return document.querySelectorAll('#runs tbody th').length === 3").await;
    let rows = "return document.querySelectorAll('#runs tbody th').length - document.querySelectorAll('#runs tbody th a').length";
    assert_eq!(browser.ask::<u32>(rows).await, 3, "names without links");
}

#[tokio::test]
async fn a_long_name_of_a_log_takes_one_line_and_hides_no_column() {
    let reports = Reports::of(2);
    let long = "EMU_4711_2025-01-31T10_34_56_Gross-Kleinstadt_Hauptbahnhof_nach_Neustadt_am_Fluss_recorder_B_run001";
    reports.rename_first(long);
    reports.replay();
    let browser = browser().await;
    reports.open(&browser, "out/report.html").await;
    browser.wait_for("return plots.size > 0").await;
    let heights = "return [...document.querySelectorAll('#runs tbody tr')].map((row) => Math.round(row.getBoundingClientRect().height))";
    let heights: Vec<u32> = browser.ask(heights).await;
    assert!(heights[0].abs_diff(heights[1]) <= 1, "{heights:?}");
    let wide = "const wide = document.querySelector('#runs .wide'); return wide.scrollWidth - wide.clientWidth";
    assert_eq!(browser.ask::<u32>(wide).await, 0, "columns beyond the edge");
    let name = "const name = document.querySelector('#runs .name'); return [name.title, name.textContent]";
    assert_eq!(browser.ask::<[String; 2]>(name).await, [long, long], "all of it under the cursor, and for the filter");
    // Two runs: between them there is nothing on the axis of runs.
    let counts =
        "return [...plots].filter((u) => u.rundown.figure.is_count).flatMap((u) => u.axes[0]._values.filter(Boolean))";
    assert_eq!(browser.ask::<Vec<String>>(counts).await, ["1", "2"]);
    check_quiet(&browser).await;
}

#[tokio::test]
async fn a_thousand_runs_open_in_three_seconds() {
    let reports = Reports::of(1000);
    reports.replay();
    let browser = browser().await;
    reports.open(&browser, "out/report.html").await;
    browser.wait_for("return document.querySelector('.filter output') !== null").await;
    let shown: f64 = browser.ask("return performance.getEntriesByType('navigation')[0].domContentLoadedEventEnd").await;
    let rows: u32 = browser.ask("return document.querySelectorAll('#runs tbody tr').length").await;
    assert_eq!(rows, 1000);
    reports.open(&browser, "out/report/run1000.html").await;
    browser.wait_for(ALIVE).await;
    let run: f64 = browser.ask("return performance.getEntriesByType('navigation')[0].domContentLoadedEventEnd").await;
    println!(
        "1000 runs: table after {shown:.0} ms, {} kB; page of a run after {run:.0} ms, {} kB",
        reports.size("out/report.html") / 1000,
        reports.size("out/report/run1000.html") / 1000
    );
    // A busy machine may be slow; a page that draws every run at once takes far longer.
    assert!(shown < 3000.0 && run < 3000.0, "table after {shown} ms, run after {run} ms");
}
