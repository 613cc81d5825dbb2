//! The page in a real browser. `SHIFTVOX_SHOTS` is a folder for pictures of the page.

use base64::Engine;
use base64::prelude::BASE64_STANDARD;
use serde_json::json;
use shiftvox::picture::png;

use crate::chromium::Browser;
use crate::program::{Program, run_command, voxel_of};

/// True when everything that is wanted is shown.
const STILL: &str = "view.camera && shown.still === view.version && fast.isFree && !('stale' in document.body.dataset)";
/// The middle of the page's picture.
const MIDDLE: [f64; 2] = [430.0, 400.0];

/// The page's picture is that of its command, by its hash and by each pixel. Returns the command.
pub(crate) fn assert_is_renders(browser: &mut Browser) -> String {
    browser.wait(STILL);
    browser.wait("$('command').value.startsWith('shiftvox render')");
    let command = browser.text("$('command').value");
    let (file, hash) = run_command(&command);
    assert_eq!(browser.text("$('live').dataset.hash"), hash, "{command}");
    assert_canvas(browser, "mine", &file, &command);
    command
}

fn assert_canvas(browser: &mut Browser, id: &str, file: &[u8], command: &str) {
    let url = browser.text(&format!("$('{id}').toDataURL()"));
    let shown = BASE64_STANDARD.decode(&url["data:image/png;base64,".len()..]);
    let [shown, expected] = [&shown.unwrap(), file].map(|file| png::decode(file).unwrap());
    assert_eq!(shown.width, expected.width, "{command}");
    assert!(shown.rgba == expected.rgba, "{id}: {command}");
}

#[test]
#[ignore = "needs chromium"]
fn the_page_turns_compares_and_shows_what_render_draws() {
    let program = Program::start("assets/tree.vox tests/data/axes.vox --size 256");
    let browser = &mut Browser::open(&program.address);
    let mut commands = vec![assert_is_renders(browser)];

    // Mouse, wheel, keys and fingers move the camera.
    browser.drag(MIDDLE, [500.0, 360.0], "left");
    commands.push(assert_is_renders(browser));
    browser.drag(MIDDLE, [470.0, 430.0], "right");
    let [x, y] = MIDDLE;
    let wheel = json!({ "type": "mouseWheel", "x": x, "y": y, "deltaX": 0, "deltaY": -300 });
    browser.input("Mouse", [wheel]);
    commands.push(assert_is_renders(browser));
    browser.value("canvas.focus()");
    for key in ["ArrowLeft", "ArrowUp", "+"] {
        let events = ["keyDown", "keyUp"].map(|kind| json!({ "type": kind, "key": key }));
        browser.input("Key", events);
    }
    commands.push(assert_is_renders(browser));
    let finger = |x: f64| json!({ "x": x, "y": y });
    let apart = |d: f64| json!([finger(x - d), finger(x + d)]);
    let along = |d: f64| json!([finger(x + d)]);
    for [start, middle, end] in [[40.0, 50.0, 60.0].map(apart), [0.0, 30.0, 60.0].map(along)] {
        let touches = [
            ("touchStart", start),
            ("touchMove", middle),
            ("touchMove", end),
            ("touchEnd", json!([])),
        ];
        let events = touches.map(|(kind, points)| json!({ "type": kind, "touchPoints": points }));
        browser.input("Touch", events);
        commands.push(assert_is_renders(browser));
    }
    commands.sort();
    commands.dedup();
    assert_eq!(commands.len(), 6, "each moved the camera: {commands:#?}");

    // The other scene, chosen by its place; settings.
    browser.value("$('scene').value = 1; $('scene').onchange()");
    assert!(assert_is_renders(browser).contains("axes.vox"));
    browser.value("$('coverage').value = 'center'; $('coverage').onchange()");
    assert!(assert_is_renders(browser).contains("--coverage=center"));
    browser.value("$('coverage').value = ''; $('coverage').onchange()");

    // A scene chosen while a still picture of another is drawn has a camera of its own; so has the first view.
    let while_drawn = |what: &str| {
        format!(
            "new Promise((done) => {{ fast.ask = (question, act) => {{ Line.prototype.ask.call(fast, question, act);
               if (question.hash) {{ delete fast.ask; {what}; done(1); }} }}; turn(0.4, 0.2); }})"
        )
    };
    let placed = |command: &str| command.split("--eye").nth(1).unwrap().to_owned();
    browser.value("$('first').click()");
    let fitted = placed(&assert_is_renders(browser));
    browser.value(&while_drawn("$('first').click()"));
    assert_eq!(placed(&assert_is_renders(browser)), fitted);
    browser.value("$('scene').value = 0; $('scene').onchange()");
    assert!(assert_is_renders(browser).contains("tree.vox"));
    browser.value(&while_drawn("$('scene').value = 1; $('scene').onchange()"));
    let seen = assert_is_renders(browser);
    assert!(
        seen.contains("axes.vox") && placed(&seen) == fitted,
        "{seen}"
    );

    // A camera that is none.
    browser.value("place([NaN, 0, 0], [0, 0, 0], [0, 0, 1])");
    browser.wait("$('error').textContent.includes('not a finite number')");
    browser.value("$('first').click()");
    assert_is_renders(browser);
    assert_eq!(browser.text("$('error').textContent"), "");
    assert!(browser.complaints.is_empty(), "{:?}", browser.complaints);
}

/// A click, a finger and a key pick the voxel that `--aov voxel` has at that pixel.
#[test]
#[ignore = "needs chromium"]
fn voxels_are_picked() {
    let program = Program::start("assets/tree.vox tests/data/axes.vox --size 256");
    let browser = &mut Browser::open(&program.address);
    browser.wait(STILL);
    for engine in ["", "machine"] {
        browser.value(&format!(
            "view.flags.engine = '{engine}'; $('scene').onchange()"
        ));
        let command = assert_is_renders(browser);
        let at = browser.value("(() => { const b = canvas.getBoundingClientRect(); return [b.left, b.top, b.width / 256]; })()");
        let [left, top, scale] = [0, 1, 2].map(|k| at[k].as_f64().unwrap());
        let picked = |browser: &mut Browser, [x, y]: [usize; 2]| {
            browser.wait("voxel && shown.whole === view.version && fast.isFree");
            let [i, j, k, level] = voxel_of(&command, [x, y], 256);
            let said = browser.text("$('voxel').innerText");
            let expected = [format!("{i}, {j}, {k}"), format!("{level} of ")];
            assert!(expected.iter().all(|part| said.contains(part)), "{expected:?}: {said}");
            browser.text("$('outline').getAttribute('d')")
        };
        let place = |x: usize, y: usize| [x, y].map(|at| (at as f64 + 0.5) * scale);
        let [x, y] = place(120, 100);
        browser.drag([left + x, top + y], [left + x + 1.0, top + y], "left");
        let first = picked(browser, [120, 100]);
        browser.value("unpick()");
        let [x, y] = place(150, 140);
        let touch = |kind: &str, points| json!({ "type": kind, "touchPoints": points });
        let finger = json!([{ "x": left + x, "y": top + y }]);
        browser.input("Touch", [touch("touchStart", finger), touch("touchEnd", json!([]))]);
        let second = picked(browser, [150, 140]);
        browser.value("unpick(); canvas.focus()");
        let key = |key: &str| ["keyDown", "keyUp"].map(|kind| json!({ "type": kind, "key": key }));
        browser.input("Key", key("p"));
        let third = picked(browser, [128, 128]);
        assert!(first.starts_with('M') && first != second && second != third);
        assert_eq!(assert_is_renders(browser), command, "the view did not move");
    }
    browser.shot("picked.png");
    // The mark follows the view. Another scene ends it, and so does Escape.
    let outline = browser.text("$('outline').getAttribute('d')");
    browser.value("$('around').click()");
    assert_is_renders(browser);
    assert_ne!(browser.text("$('outline').getAttribute('d')"), outline);
    browser.value("canvas.focus()");
    browser.input("Key", ["keyDown", "keyUp"].map(|kind| json!({ "type": kind, "key": "Escape" })));
    browser.wait("$('picked').hidden && !$('outline').getAttribute('d')");
    assert!(browser.complaints.is_empty(), "{:?}", browser.complaints);
}

#[test]
#[ignore = "needs chromium"]
fn the_slider_shows_the_papers_rule() {
    let program = Program::start("assets/tree.vox --size 360x330");
    let browser = &mut Browser::open(&program.address);
    let whole =
        "shown.paperWhole === view.version && $('difference').textContent.includes('differ')";
    let command = assert_is_renders(browser);
    browser.value("$('compare').click()");
    browser.wait(whole);
    let (paper, _) = run_command(&command.replace("--size", "--paper --size"));
    assert_canvas(browser, "paper", &paper, "the paper's");
    let (mine, _) = run_command(&command);
    let [mine, paper] = [mine, paper].map(|file| png::decode(&file).unwrap().rgba);
    let differ = mine.iter().zip(&paper).filter(|(a, b)| a != b).count();
    let said = browser.text("$('difference').textContent").replace(',', "");
    let is_told = said.starts_with(&format!("{differ} of 118800 "));
    assert!(differ > 100 && is_told, "{differ}: {said}");
    // The edge follows the hand.
    let at = browser.value(
        "(() => { const b = $('slider').getBoundingClientRect(); return [b.left, b.width, b.top + b.height / 2]; })()",
    );
    let [left, width, y] = [0, 1, 2].map(|k| at[k].as_f64().unwrap());
    browser.drag([left + width / 2.0, y], [left + width / 4.0, y], "left");
    let edge = browser.value("parseFloat($('edge').style.left)");
    assert!((edge.as_f64().unwrap() - 25.0).abs() < 3.0, "{edge}");
    let clip = browser.text("$('paper').style.clipPath");
    assert!(clip.ends_with(&format!("{edge}%)")), "{clip} {edge}");
    // Figures of the model came on the side.
    browser.wait("$('model').innerText.includes('energy')");
    browser.value("$('slider').value = 500; compare()");
    browser.shot("view.png");
    // A refusal stays while other things are answered, and nothing old is said of it.
    let bits = |bits: &str| format!("$('bits').value = '{bits}'; $('bits').onchange()");
    browser.value(&bits("99"));
    browser.wait("shown.still === view.version && shown.figures === view.version && slow.isFree");
    let error = browser.text("$('error').textContent");
    assert!(error.contains("16 to 64"), "{error}");
    assert_eq!(browser.text("$('command').value"), "");
    let said = browser.text("$('difference').textContent");
    assert_eq!(said, "one of them is not drawn");
    browser.value(&bits(""));
    browser.wait(whole);
    assert_eq!(browser.text("$('error').textContent"), "");
    // Only the rule differs: with the paper's own there is no difference.
    browser.value(
        "view.aa = 2; view.flags = { bits: '40', lod: '2', coverage: 'any', cage: 'corners', tolerance: 'inf' };
         changed()",
    );
    browser.wait(whole);
    let said = browser.text("$('difference').textContent");
    assert!(said.starts_with("0 of 118,800"), "{said}");
    assert!(browser.complaints.is_empty(), "{:?}", browser.complaints);
}

/// The paper's rule takes the machine minutes at this size, longer than this test waits.
#[test]
#[ignore = "needs chromium"]
fn a_new_input_ends_a_slow_drawing() {
    let program = Program::start("assets/tree.vox tests/data/axes.vox --size 2048");
    let browser = &mut Browser::open(&program.address);
    let command = assert_is_renders(browser);
    browser.value("$('copy').click()");
    browser.wait("$('copy').textContent === 'Copied'");
    let slow = "$('coverage').value = 'any'; $('coverage').onchange()";
    let is_marked = "document.body.dataset.stale === '' && $('copy').disabled";
    for inputs in [
        "$('coverage').value = ''; $('coverage').onchange()",
        "$('coverage').value = ''; turn(0.3, 0.1)",
        "$('scene').value = 1; $('coverage').value = view.flags.coverage = ''; $('scene').onchange()",
    ] {
        // Figures of the old picture are marked at once, and the work is shown.
        browser.value(&format!("{slow}; globalThis.wasMarked = {is_marked}"));
        assert_eq!(browser.value("wasMarked"), true);
        browser.wait("!$('busy').hidden");
        assert_eq!(browser.value(is_marked), true);
        browser.value(&format!("view.flags.coverage = ''; {inputs}"));
        assert!(!assert_is_renders(browser).contains("coverage"));
        browser.wait("$('busy').hidden");
    }
    assert!(
        browser
            .text("document.title")
            .starts_with("tests/data/axes.vox")
    );

    // A picture that is kept is not said to have taken no time.
    browser.value("changed()");
    assert_is_renders(browser);
    browser.wait("$('live').innerText.includes('kept')");

    // View and settings survive a reload.
    browser.value("turn(0.5, 0.2); $('lod').value = '2'; $('lod').onchange()");
    let turned = assert_is_renders(browser);
    assert!(turned.contains("--lod=2") && turned != command, "{turned}");
    browser.value("globalThis.isOld = true; setTimeout(() => location.reload())");
    browser.wait("!globalThis.isOld && limits");
    assert_eq!(assert_is_renders(browser), turned);
    assert!(browser.complaints.is_empty(), "{:?}", browser.complaints);
}

/// Turns with every frame of the screen for three seconds, as a hand does, and prints the figures of `docs/view.md`.
#[test]
#[ignore = "needs chromium"]
fn rate_of_frames_at_1024() {
    let program = Program::start("assets/tree.vox --size 1024");
    let browser = &mut Browser::open(&program.address);
    browser.wait("view.camera && shown.still === view.version && shown.figures === view.version");
    let turn = "new Promise((done) => {
        const kept = [], note = noteFrame, began = performance.now();
        paces.clear();
        noteFrame = (head, ms, pace) => { note(head, ms, pace); kept.push([head.width, ms]); };
        const step = () => {
            turn(0.01, 0);
            if (performance.now() - began < 3000) return requestAnimationFrame(step);
            noteFrame = note;
            done(kept);
        };
        step();
    })";
    for _ in 0..2 {
        let kept = browser.value(turn);
        let frames = kept.as_array().unwrap();
        let whole = frames.iter().filter(|frame| frame[0] == 1024);
        let mut times: Vec<f64> = whole.filter_map(|frame| frame[1].as_f64()).collect();
        times.sort_by(f64::total_cmp);
        let (rate, count) = (frames.len() as f64 / 3.0, times.len());
        assert!(rate > 1.0, "{rate} frames per second");
        let middle = times.get(count / 2);
        println!("{rate:.1} frames per second, {count} whole ones after {middle:?} ms");
        browser.wait("shown.still === view.version");
    }
}
