//! Frames a second, and how long each takes from question to picture: `docs/view.md` has the figures.
//!
//! `cargo test --release -p shiftvox-cli --test view rate -- --ignored --nocapture`

use std::time::Instant;

use serde_json::json;

use crate::browser::shot;
use crate::chromium::Browser;
use crate::program::Program;

/// Times of frames, milliseconds: the middle one, and that of 95 %.
fn told(mut times: Vec<f64>) -> String {
    times.sort_by(f64::total_cmp);
    let at = |share: f64| times[((times.len() as f64 * share) as usize).min(times.len() - 1)];
    format!("latency {:.1} ms, of 95 % {:.1} ms", at(0.5), at(0.95))
}

/// Processor time that a process has taken, milliseconds, in steps of ten.
fn processor_ms(process: u32) -> f64 {
    let line = std::fs::read_to_string(format!("/proc/{process}/stat")).unwrap();
    let (_, fields) = line.rsplit_once(") ").unwrap();
    let ticks = fields.split(' ').skip(11).take(2);
    ticks
        .map(|ticks| 10.0 * ticks.parse::<f64>().unwrap())
        .sum()
}

#[test]
#[ignore = "needs chromium"]
fn rate_of_frames_at_1024() {
    let program = Program::start(&["assets/tree.vox", "--size", "1024"]);
    let mut page = program.page();
    let (head, _) = page.ask(json!({ "size": [1024, 1024] }));
    let eye: Vec<f64> = (0..3)
        .map(|k| head["camera"]["eye"][k].as_f64().unwrap())
        .collect();
    for run in 1..=2 {
        let mut times = Vec::new();
        let (before, started) = (processor_ms(program.child.id()), Instant::now());
        for frame in 0..100 {
            let asked = Instant::now();
            let eye = [eye[0] + f64::from(frame), eye[1] - f64::from(frame), eye[2]];
            let camera = json!({ "eye": eye, "target": head["camera"]["target"], "up": [0, 0, 1], "fov": 40 });
            let (_, rgba) = page.ask(json!({ "size": [1024, 1024], "camera": camera }));
            assert_eq!(rgba.len(), 4 << 20);
            times.push(asked.elapsed().as_secs_f64() * 1e3);
        }
        let rate = times.len() as f64 / started.elapsed().as_secs_f64();
        let work = (processor_ms(program.child.id()) - before) / times.len() as f64;
        let told = told(times);
        println!(
            "socket, run {run}: {rate:.1} frames a second, {told}, {work:.1} ms of processor time"
        );
    }
    drop(page);
    let mut browser = Browser::start();
    browser.open(&program.address);
    browser.wait("view.camera && shown.still === view.version && shown.figures === view.version");
    shot(&mut browser, "page.png");
    // Turns with every frame of the screen for three seconds, as a hand does; pictures stay whole.
    let turn = "new Promise((done) => {
        const kept = [], note = noteFrame, began = performance.now();
        paces.clear();
        noteFrame = (head, ms, pace) => { note(head, ms, pace); kept.push([head.width, ms]); };
        const step = () => {
            turn(0.01, 0);
            if (performance.now() - began < 3000) return requestAnimationFrame(step);
            noteFrame = note;
            done({ kept, seconds: (performance.now() - began) / 1000 });
        };
        step();
    })";
    for run in 1..=2 {
        let result = browser.value(turn);
        let kept = result["kept"].as_array().unwrap();
        let whole: Vec<f64> = kept
            .iter()
            .filter(|f| f[0] == 1024)
            .filter_map(|f| f[1].as_f64())
            .collect();
        let rate = kept.len() as f64 / result["seconds"].as_f64().unwrap();
        println!(
            "browser, run {run}: {rate:.1} frames a second, {} of {} of them whole; whole ones: {}",
            whole.len(),
            kept.len(),
            if whole.is_empty() {
                String::new()
            } else {
                told(whole.clone())
            }
        );
        browser.wait("shown.still === view.version");
    }
}
