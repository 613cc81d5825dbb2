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
    assert_is_still(browser);
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
    let program = Program::start("assets/tree.vox tests/data/axes.vox --size 128");
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
    browser.set("scene", "1");
    assert!(assert_is_renders(browser).contains("axes.vox"));
    browser.set("coverage", "center");
    assert!(assert_is_renders(browser).contains("--coverage=center"));
    browser.set("coverage", "");

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
    browser.set("scene", "0");
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
}

/// A click, a finger and a key pick the voxel that `--aov voxel` has at that pixel.
#[test]
#[ignore = "needs chromium"]
fn voxels_are_picked() {
    let program = Program::start("assets/tree.vox tests/data/axes.vox --size 128");
    let browser = &mut Browser::open(&program.address);
    browser.wait(STILL);
    for engine in ["", "machine"] {
        browser.value(&format!(
            "view.flags.engine = '{engine}'; $('scene').onchange()"
        ));
        let command = assert_is_renders(browser);
        let at = browser.value("(() => { const b = canvas.getBoundingClientRect(); return [b.left, b.top, b.width / 128]; })()");
        let [left, top, scale] = [0, 1, 2].map(|k| at[k].as_f64().unwrap());
        let picked = |browser: &mut Browser, [x, y]: [usize; 2]| {
            browser.wait("voxel && shown.whole === view.version && fast.isFree");
            let [i, j, k, level] = voxel_of(&command, [x, y], 128);
            let said = browser.text("$('voxel').innerText");
            let expected = [format!("{i}, {j}, {k}"), format!("{level} of ")];
            assert!(
                expected.iter().all(|part| said.contains(part)),
                "{expected:?}: {said}"
            );
            browser.text("$('outline').getAttribute('d')")
        };
        let place = |x: usize, y: usize| [x, y].map(|at| (at as f64 + 0.5) * scale);
        let [x, y] = place(60, 50);
        browser.drag([left + x, top + y], [left + x + 1.0, top + y], "left");
        let first = picked(browser, [60, 50]);
        browser.value("unpick()");
        let [x, y] = place(75, 70);
        let touch = |kind: &str, points| json!({ "type": kind, "touchPoints": points });
        let finger = json!([{ "x": left + x, "y": top + y }]);
        browser.input(
            "Touch",
            [touch("touchStart", finger), touch("touchEnd", json!([]))],
        );
        let second = picked(browser, [75, 70]);
        browser.value("unpick(); canvas.focus()");
        let key = |key: &str| ["keyDown", "keyUp"].map(|kind| json!({ "type": kind, "key": key }));
        browser.input("Key", key("p"));
        let third = picked(browser, [64, 64]);
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
    browser.input(
        "Key",
        ["keyDown", "keyUp"].map(|kind| json!({ "type": kind, "key": "Escape" })),
    );
    browser.wait("$('picked').hidden && !$('outline').getAttribute('d')");
}

/// The background follows the dark scheme and the choice, in the picture, its command and the address.
#[test]
#[ignore = "needs chromium"]
fn backgrounds_and_legends() {
    let program = Program::start("assets/tree.vox --size 120");
    let browser = &mut Browser::open(&program.address);
    assert!(!assert_is_renders(browser).contains("--background"));
    browser.emulate(false, true);
    browser.wait("$('command').value.includes('--background=21,24,29')");
    assert_is_renders(browser);
    browser.shot("dark.png");
    browser.set("background", "none");
    assert!(assert_is_renders(browser).contains("--background=none"));
    browser.set("background", "color");
    browser.set("color", "#102030");
    let command = assert_is_renders(browser);
    assert!(command.contains("--background=16,32,48"), "{command}");
    browser.value("globalThis.isOld = true; setTimeout(() => location.reload())");
    browser.wait("!globalThis.isOld && limits");
    assert_eq!(assert_is_renders(browser), command);
    assert_eq!(browser.text("$('color').value"), "#102030");
    // A phone: the picture stays while the settings scroll, and fingers hit them.
    browser.emulate(true, false);
    browser.wait("$('pictures').clientWidth <= 390");
    assert_is_renders(browser);
    browser.set("background", "");
    assert_is_renders(browser);
    browser.value("pickAt(0.4, 0.5)");
    browser.wait("voxel && $('unpick').offsetHeight >= 44");
    browser.shot("phone.png");
    browser.value("$('unpick').click()");
    browser.wait("$('picked').hidden");
    let seen = "document.querySelector('aside').scrollTo(0, 500); scrollTo(0, 500);
        [$('mine').getBoundingClientRect().top >= 0, $('mine').getBoundingClientRect().bottom <= innerHeight / 2 + 60,
         [...document.querySelectorAll('aside label, aside button')].every((e) => !e.offsetParent || e.offsetHeight >= 44)]";
    assert_eq!(browser.value(seen), json!([true, true, true]));
    browser.shot("phone-settings.png");
    browser.emulate(false, false);
    for (show, first, caption) in [
        ("records", "0.0", "records per pixel"),
        ("voxel", "level 8", "level drawn"),
        ("depth", "", "depth"),
        ("normal", "+x", "normal"),
    ] {
        browser.set("show", show);
        assert_is_still(browser);
        let said = browser.text("$('legend').innerText");
        assert!(said.starts_with(caption) && said.contains(first), "{said}");
        browser.shot(&format!("{show}.png"));
    }
}

/// Sections and parallel rays are those of the command, and the address keeps them.
#[test]
#[ignore = "needs chromium"]
fn sections_and_parallel_rays() {
    let program = Program::start("assets/tree.vox --size 120");
    let browser = &mut Browser::open(&program.address);
    let whole = assert_is_renders(browser);
    browser.set("section", "2<");
    let half = assert_is_renders(browser);
    assert!(half.contains("--crop=..,..,..128"), "{half}");
    browser.wait("!$('model').classList.contains('old') && $('modelled').textContent.includes('--crop=..,..,..128')");
    browser.value("$('plane').value = 64; $('plane').oninput()");
    assert!(assert_is_renders(browser).contains("--crop=..,..,..64"));
    browser.value("$('mine').dispatchEvent(new KeyboardEvent('keydown', { key: ']' }))");
    assert!(assert_is_renders(browser).contains("--crop=..,..,..69"));
    browser.value("pickAt(0.5, 0.6)");
    browser.wait("voxel && voxel.index[2] < 69");
    browser.value("$('mine').dispatchEvent(new KeyboardEvent('keydown', { key: 'o' }))");
    browser.wait("$('ortho').checked");
    let command = assert_is_renders(browser);
    assert!(
        command.contains("--ortho=") && !command.contains("--fov"),
        "{command}"
    );
    browser.shot("section.png");
    browser.value("globalThis.isOld = true; setTimeout(() => location.reload())");
    browser.wait("!globalThis.isOld && limits && $('ortho').checked && $('plane').value === '69'");
    assert_eq!(assert_is_renders(browser), command);
    browser.value("zoom(0.5)");
    let nearer = assert_is_renders(browser);
    let height = |command: &str| {
        let after = command
            .split("--ortho=")
            .nth(1)
            .and_then(|rest| rest.split(' ').next());
        after.and_then(|height| height.parse::<f64>().ok()).unwrap()
    };
    assert!(
        (height(&nearer) * 2.0 - height(&command)).abs() < 0.01,
        "{nearer}"
    );
    // Back to the first picture.
    browser.value("zoom(2); $('ortho').click()");
    browser.set("section", "");
    let back = assert_is_renders(browser);
    assert!(!back.contains("--crop") && back.contains("--fov"), "{back}");
    assert_eq!(back.split("--eye").next(), whole.split("--eye").next());
}

fn assert_is_still(browser: &mut Browser) {
    browser.wait(STILL);
    browser.wait("$('command').value.startsWith('shiftvox render')");
}

/// Each frame of the animated PNG is the picture of its camera.
#[test]
#[ignore = "needs chromium"]
fn a_turntable_is_saved() {
    let program = Program::start("assets/tree.vox --size 96x72 --aa 2");
    let browser = &mut Browser::open(&program.address);
    assert_is_renders(browser);
    // Chromium's decoder reads the file.
    let made = browser.value(
        "new Promise((done) => {
           const cameras = [], ask = slow.ask;
           slow.ask = (question, ...rest) => {
             if (question.ask === 'picture') cameras.push(question.camera);
             return ask.call(slow, question, ...rest);
           };
           download = async (file, name) => {
             const decoder = new ImageDecoder({ data: await file.arrayBuffer(), type: file.type });
             await decoder.tracks.ready;
             const count = decoder.tracks.selectedTrack.frameCount, shots = [];
             for (const at of [0, 9, 35]) {
               const { image } = await decoder.decode({ frameIndex: at });
               const canvas = new OffscreenCanvas(image.displayWidth, image.displayHeight), context = canvas.getContext('2d');
               context.drawImage(image, 0, 0);
               const { data } = context.getImageData(0, 0, canvas.width, canvas.height);
               shots.push([String(data), image.duration]);
             }
             globalThis.made = { cameras, shots };
             done([name, file.size, count, cameras.length, shots.map(([, us]) => us)]);
           };
           $('turn').click();
         })",
    );
    println!("{made}");
    assert_eq!(made[0], "turntable.png");
    assert_eq!(json!([made[2], made[3]]), json!([36, 36]));
    assert!(
        (made[4][1].as_f64().unwrap() - 1e6 / 18.0).abs() < 1000.0,
        "{made}"
    );
    for (place, at) in [0, 9, 35].iter().enumerate() {
        browser.value(&format!("view.camera = made.cameras[{at}]; changed()"));
        assert_is_renders(browser);
        let is_same = format!(
            "String(canvas.getContext('2d').getImageData(0, 0, 96, 72).data) === made.shots[{place}][0]"
        );
        assert_eq!(browser.value(&is_same), true, "frame {at}");
    }
    // Half of a turn is on the other side.
    let sum = browser.value(
        "(() => { const [a, b] = [0, 18].map((at) => add(made.cameras[at].eye, made.cameras[at].target, -1));
           return Math.hypot(...add(add(a, b), view.axis, -2 * dot(a, view.axis))) / Math.hypot(...a); })()",
    );
    assert!(sum.as_f64().unwrap() < 1e-9, "{sum}");
    // A second click ends it.
    browser.wait("$('turn').textContent === 'Turntable'");
    browser.value("download = () => { throw 'not ended' }; $('turn').click()");
    browser.value("$('turn').click()");
    browser.wait("$('turn').textContent === 'Turntable' && !frame");
}

/// The view is within limits: the eye does not enter the target, nor leave the scene far behind.
#[test]
#[ignore = "needs chromium"]
fn files_are_dropped_and_zoom_has_limits() {
    let program = Program::start("assets/tree.vox --size 128");
    let browser = &mut Browser::open(&program.address);
    let fitted = assert_is_renders(browser);
    let distance = "Math.hypot(...add(view.camera.eye, view.camera.target, -1)) / view.fit";
    for (by, least, most) in [(1e-9, 0.0002, 0.0003), (1e9, 7.9, 8.1)] {
        browser.value(&format!("for (let k = 0; k < 3; k++) zoom({by})"));
        let at = browser.value(distance).as_f64().unwrap();
        assert!(at > least && at < most, "{at}");
        assert_is_renders(browser);
    }
    browser.value("$('first').click()");
    assert_eq!(assert_is_renders(browser), fitted);

    let drop = |bytes: &[u8], name: &str| {
        format!(
            "document.ondrop({{ preventDefault() {{}}, dataTransfer: {{ files: [new File([Uint8Array.from(atob('{}'),
             (c) => c.charCodeAt(0))], '{name}')] }} }})",
            BASE64_STANDARD.encode(bytes)
        )
    };
    let root = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let axes = std::fs::read(root.join("tests/data/axes.vox")).unwrap();
    browser.value(&drop(&axes, "tests/data/axes.vox"));
    browser.wait("document.title.startsWith('tests/data/axes.vox')");
    assert!(assert_is_renders(browser).contains("axes.vox"));
    let mesh = std::fs::read(root.join("assets/knot.obj")).unwrap();
    for (bytes, name) in [(&b"nonsense"[..], "wrong.vox"), (&mesh, "knot.obj")] {
        browser.value(&drop(bytes, name));
        browser.wait(&format!("$('of-file').textContent.startsWith('{name}: ') && !$('of-file').textContent.endsWith('reading')"));
        println!("{}", browser.text("$('of-file').textContent"));
        assert_eq!(browser.value("$('scene').options.length"), 2);
    }
    browser.value("take({ name: 'large.vox', size: 300 << 20 })");
    browser.wait("$('of-file').textContent.includes('256 MB')");
    browser.value("turn(0.3, 0)");
    assert!(assert_is_renders(browser).contains("axes.vox"));
}

/// A page shows why it is closed, and continues with a restarted program.
#[test]
#[ignore = "needs chromium"]
fn pages_wait_for_a_place_and_for_the_program() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("token");
    let scenes = "tests/data/axes.vox assets/tree.vox --size 128";
    let line = format!("{scenes} --token-file {}", file.display());
    let program = Program::start(&line);
    let others: Vec<_> = (0..8).map(|_| program.page()).collect();
    let browser = &mut Browser::open(&program.address);
    browser.wait("$('error').textContent.startsWith('Too many pages')");
    drop(others);
    assert_is_renders(browser);
    browser.set("scene", "1");
    assert_is_renders(browser);
    browser.value("turn(0.4, 0.1)");
    let command = assert_is_renders(browser);
    browser.value("globalThis.isSame = true");
    let (address, host) = (program.address.clone(), program.host.clone());
    drop(program);
    browser.wait("$('error').textContent.startsWith('The program has ended')");
    let port = host.rsplit(':').next().unwrap();
    // The list has another order now.
    let scenes = "assets/tree.vox tests/data/axes.vox --size 128";
    let line = format!("{scenes} --port {port}");
    let other = Program::start(&line);
    browser.wait("$('error').textContent.includes('another address')");
    drop(other);
    let program = Program::start(&format!("{line} --token-file {}", file.display()));
    assert_eq!(program.address, address);
    browser.wait("fast.isOpen && slow.isOpen && $('error').textContent === ''");
    assert_eq!(assert_is_renders(browser), command);
    assert_eq!(browser.value("isSame"), true);
    // Of lost connections.
    browser.complaints.clear();
}

#[test]
#[ignore = "needs chromium"]
fn the_slider_shows_the_papers_rule() {
    let program = Program::start("assets/tree.vox --size 180x165");
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
    let is_told = said.starts_with(&format!("{differ} of 29700 "));
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
    browser.set("bits", "99");
    browser.wait("shown.still === view.version && shown.figures === view.version && slow.isFree");
    let error = browser.text("$('error').textContent");
    assert!(error.contains("16 to 64"), "{error}");
    assert_eq!(browser.text("$('command').value"), "");
    let said = browser.text("$('difference').textContent");
    assert_eq!(said, "one of them is not drawn");
    browser.set("bits", "");
    browser.wait(whole);
    assert_eq!(browser.text("$('error').textContent"), "");
    // Only the rule differs: with the paper's own there is no difference.
    browser.value(
        "view.aa = 2; view.size = '150x100'; view.flags = { bits: '40', lod: '2', coverage: 'any', cage: 'corners', tolerance: 'inf' };
         changed()",
    );
    browser.wait(whole);
    let said = browser.text("$('difference').textContent");
    assert!(said.starts_with("0 of 15,000"), "{said}");
}

/// With 16 samples per pixel the paper's rule takes the machine minutes, longer than this test waits.
#[test]
#[ignore = "needs chromium"]
fn a_new_input_ends_a_slow_drawing() {
    let program = Program::start("assets/tree.vox tests/data/axes.vox --size 700");
    let browser = &mut Browser::open(&program.address);
    let command = assert_is_renders(browser);
    browser.value("$('copy').click()");
    browser.wait("$('copy').textContent === 'Copied'");
    let slow = "view.aa = 4; $('coverage').value = 'any'; $('coverage').onchange()";
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
        browser.value(&format!("view.aa = 1; view.flags.coverage = ''; {inputs}"));
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
}

/// Turns with every frame of the screen for three seconds, as a hand does, and prints the figures of `docs/view.md`.
#[test]
#[ignore = "needs chromium, and measures"]
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
