//! The page in a real browser. `SHIFTVOX_SHOTS` is a folder for pictures of the page.

use base64::Engine;
use base64::prelude::BASE64_STANDARD;
use serde_json::{Value, json};
use shiftvox::picture::png;

use crate::chromium::Browser;
use crate::program::{Program, run_command};

/// True when everything that is wanted is shown.
const STILL: &str = "view.camera && shown.still === view.version && fast.isFree";
/// The middle of the page's picture.
const MIDDLE: [f64; 2] = [430.0, 400.0];

/// Keeps a picture of the page, where one is wanted.
pub(crate) fn shot(browser: &mut Browser, name: &str) {
    let Some(folder) = std::env::var_os("SHIFTVOX_SHOTS") else {
        return;
    };
    let bytes = BASE64_STANDARD.decode(browser.screenshot()).unwrap();
    std::fs::write(std::path::Path::new(&folder).join(name), bytes).unwrap();
}

/// FNV-1a of a canvas's pixels.
fn canvas(browser: &mut Browser, id: &str) -> (Value, u32) {
    let script = format!(
        "(() => {{ const c = $('{id}'), d = c.getContext('2d').getImageData(0, 0, c.width, c.height).data;
           let h = 0x811c9dc5; for (const b of d) h = Math.imul(h ^ b, 0x01000193);
           return [[c.width, c.height], h >>> 0]; }})()"
    );
    let value = browser.value(&script);
    (value[0].clone(), value[1].as_u64().unwrap() as u32)
}

fn fnv(bytes: &[u8]) -> u32 {
    let step = |hash: u32, &byte: &u8| (hash ^ u32::from(byte)).wrapping_mul(0x0100_0193);
    bytes.iter().fold(0x811c_9dc5, step)
}

/// The page's picture is that of its command, by its hash and by each pixel. Returns the command.
fn assert_is_renders(browser: &mut Browser) -> String {
    browser.wait(STILL);
    browser.wait("$('command').value.startsWith('shiftvox render')");
    let command = browser.value("$('command').value");
    let command = command.as_str().unwrap().to_owned();
    let (file, hash) = run_command(&command);
    assert_eq!(browser.value("$('live').dataset.hash"), hash, "{command}");
    assert_canvas(browser, "mine", &file, &command);
    command
}

fn assert_canvas(browser: &mut Browser, id: &str, file: &[u8], command: &str) {
    let expected = png::decode(file).unwrap();
    let (size, found) = canvas(browser, id);
    assert_eq!(size, json!([expected.width, expected.height]), "{command}");
    assert_eq!(found, fnv(expected.rgba.as_flattened()), "{id}: {command}");
}

#[test]
#[ignore = "needs chromium"]
fn the_page_turns_compares_and_shows_what_render_draws() {
    let browser = &mut Browser::start();
    let program = Program::start(&["assets/tree.vox", "tests/data/axes.vox", "--size", "256"]);
    browser.open(&program.address);
    let fitted = assert_is_renders(browser);

    // Mouse, wheel, keys and fingers move the camera.
    let mut commands = vec![fitted];
    browser.drag(MIDDLE, [500.0, 360.0], "left");
    commands.push(assert_is_renders(browser));
    browser.drag(MIDDLE, [470.0, 430.0], "right");
    browser.wheel(MIDDLE, -300.0);
    commands.push(assert_is_renders(browser));
    browser.value("canvas.focus()");
    for key in ["ArrowLeft", "ArrowUp", "+"] {
        browser.key(key);
    }
    commands.push(assert_is_renders(browser));
    let [x, y] = MIDDLE;
    let apart = |d: f64| vec![[x - d, y], [x + d, y]];
    browser.touch(&[apart(40.0), apart(50.0), apart(60.0)]);
    commands.push(assert_is_renders(browser));
    browser.touch(&[vec![MIDDLE], vec![[x + 30.0, y]], vec![[x + 60.0, y]]]);
    commands.push(assert_is_renders(browser));
    commands.sort();
    commands.dedup();
    assert_eq!(commands.len(), 6, "each moved the camera: {commands:#?}");

    // The other scene, chosen by its place; settings.
    browser.value("$('scene').value = 1; $('scene').onchange()");
    assert!(assert_is_renders(browser).contains("axes.vox"));
    browser.value("$('coverage').value = 'center'; $('coverage').onchange()");
    assert!(assert_is_renders(browser).contains("--coverage=center"));

    // A scene chosen while a still picture of another is drawn has a camera of its own; so has the first view.
    let while_drawn = |what: &str| {
        format!(
            "new Promise((done) => {{ fast.ask = (question, act) => {{ Line.prototype.ask.call(fast, question, act);
               if (question.hash) {{ delete fast.ask; {what}; done(1); }} }}; turn(0.4, 0.2); }})"
        )
    };
    let first = browser.value("$('first').click()");
    assert!(first.is_null());
    let placed = |command: &str| command.split("--eye").nth(1).unwrap().to_owned();
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

    // A second page, with a camera of its own.
    let first = browser.page.clone();
    browser.open(&program.address);
    browser.wait(STILL);
    browser.value("turn(1, 0.1); turn(0.5, 0)");
    let seen = assert_is_renders(browser);
    assert!(seen.contains("tree.vox") && !commands.contains(&seen));
    browser.page = first;
    assert!(assert_is_renders(browser).contains("axes.vox"));

    // A camera that is none.
    browser.value("place([NaN, 0, 0], [0, 0, 0], [0, 0, 1])");
    browser.wait("$('error').textContent.includes('not a finite number')");
    browser.value("$('first').click()");
    assert_is_renders(browser);
    assert_eq!(browser.value("$('error').textContent"), "");
    assert!(browser.complaints.is_empty(), "{:?}", browser.complaints);
}

#[test]
#[ignore = "needs chromium"]
fn the_slider_shows_the_papers_rule() {
    let browser = &mut Browser::start();
    let program = Program::start(&["assets/tree.vox", "--size", "360x330"]);
    browser.open(&program.address);
    let command = assert_is_renders(browser);
    browser.value("$('compare').click()");
    browser.wait(
        "shown.paperWhole === view.version && $('difference').textContent.includes('differ')",
    );
    let (paper, _) = run_command(&command.replace("--size", "--paper --size"));
    assert_canvas(browser, "paper", &paper, "the paper's");
    let (mine, _) = run_command(&command);
    let [mine, paper] = [mine, paper].map(|file| png::decode(&file).unwrap().rgba);
    let differ = mine.iter().zip(&paper).filter(|(a, b)| a != b).count();
    let said = browser.value("$('difference').textContent");
    let said = said.as_str().unwrap().replace(',', "");
    assert!(
        differ > 100 && said.starts_with(&format!("{differ} of 118800 ")),
        "{differ}: {said}"
    );
    // The edge follows the hand.
    let at = browser.value("(() => { const b = $('slider').getBoundingClientRect(); return [b.left, b.width, b.top + b.height / 2]; })()",
    );
    let [left, width, y] = [0, 1, 2].map(|k| at[k].as_f64().unwrap());
    browser.drag([left + width / 2.0, y], [left + width / 4.0, y], "left");
    let edge = browser
        .value("parseFloat($('edge').style.left)")
        .as_f64()
        .unwrap();
    assert!((edge - 25.0).abs() < 3.0, "{edge}");
    let clip = browser.value("$('paper').style.clipPath");
    assert!(
        clip.as_str().unwrap().ends_with(&format!("{edge}%)")),
        "{clip} {edge}"
    );
    // Figures of the model came on the side.
    browser.wait("$('model').innerText.includes('energy')");
    browser.value("$('slider').value = 500; compare()");
    shot(browser, "view.png");
    // A refusal stays while other things are answered, and nothing old is said of it.
    let bits = |bits: &str| format!("$('bits').value = '{bits}'; $('bits').onchange()");
    let whole =
        "shown.paperWhole === view.version && $('difference').textContent.includes('differ')";
    browser.value(&bits("99"));
    browser.wait("shown.still === view.version && shown.figures === view.version && slow.isFree");
    let error = browser.value("$('error').textContent");
    assert!(error.as_str().unwrap().contains("16 to 64"), "{error}");
    assert_eq!(browser.value("$('command').value"), "");
    let said = browser.value("$('difference').textContent");
    assert_eq!(said, "one of them is not drawn");
    browser.value(&bits(""));
    browser.wait(whole);
    assert_eq!(browser.value("$('error').textContent"), "");
    // Nothing but the rule differs: with the paper's own there is nothing.
    browser.value("view.aa = 2; view.flags = { bits: '40', lod: '2', coverage: 'any', cage: 'corners', tolerance: 'inf' };
         changed()",
    );
    browser.wait(whole);
    let said = browser.value("$('difference').textContent");
    assert!(said.as_str().unwrap().starts_with("0 of 118,800"), "{said}");
    assert!(browser.complaints.is_empty(), "{:?}", browser.complaints);
}
