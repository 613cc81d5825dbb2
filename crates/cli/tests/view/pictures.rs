//! A page's picture is that of `render`.

use serde_json::{Value, json};
use shiftvox::picture::png;

use crate::program::{Page, Program, question, run_command, shiftvox, voxel_of};

/// Asks for a picture as bytes and as PNG, and compares both, and the hash, with the command's.
fn assert_is_renders(page: &mut Page, mut fields: Value) -> Value {
    fields["hash"] = json!(true);
    let (head, rgba) = page.ask(fields.clone());
    fields["png"] = json!(true);
    let (_, file) = page.ask(fields);
    let command = head["command"].as_str().unwrap_or_else(|| panic!("{head}"));
    let (expected, hash) = run_command(command);
    assert_eq!(head["hash"], hash, "{command}");
    assert!(file == expected, "{command}");
    let decoded = png::decode(&expected).unwrap();
    assert!(rgba == decoded.rgba.as_flattened(), "{command}");
    head
}

fn camera(eye: [f64; 3]) -> Value {
    json!({ "eye": eye, "target": [-10, -11, 128], "up": [0, 0, 1], "fov": 33.5 })
}

#[test]
fn a_picture_is_that_of_its_command() {
    let program = Program::start("assets/tree.vox gen:menger,depth=3");
    let mut page = program.page();
    let scenes = json!(["assets/tree.vox", "gen:menger,depth=3"]);
    assert_eq!(page.hello["scenes"], scenes);
    let near = camera([170.5, -300.25, 228.0]);
    let mut hashes = Vec::new();
    for fields in [
        json!({}),
        json!({ "camera": near }),
        json!({ "camera": near, "aa": 2, "size": [77, 130] }),
        json!({ "camera": near, "flags": { "coverage": "any", "cage": "corners", "tolerance": "inf" } }),
        json!({ "camera": near, "flags": { "lod": "4", "shade": "flat", "background": "none" } }),
        json!({ "camera": near, "flags": { "engine": "machine", "bits": "32", "frac": "9" } }),
        json!({ "scene": 1 }),
    ] {
        hashes.push(assert_is_renders(&mut page, fields)["hash"].to_string());
    }
    hashes.sort();
    hashes.dedup();
    assert_eq!(hashes.len(), 7, "different settings are different pictures");
}

#[test]
fn meshes_and_their_methods_are_drawn_as_render_draws_them() {
    let folder = tempfile::tempdir().unwrap();
    let made = |name: &str, words: &str| {
        let path = folder.path().join(name).display().to_string();
        let line = format!("convert assets/wires.obj --quiet {path} {words}");
        assert!(shiftvox(&line).status.success());
        path
    };
    let far = made("wires.far", "--rays 1000 --leaf-triangles 50");
    let tvx = made("wires.tvx", "--grid 8 --texels 4");
    let program = Program::start(&format!("assets/wires.obj {far} {tvx} --lod 2"));
    let mut page = program.page();
    assert_eq!(page.hello["flags"], json!({ "lod": "2" }));
    for scene in 0..3 {
        let fields = json!({ "scene": scene, "flags": { "lod": "1.5" } });
        assert_is_renders(&mut page, fields);
    }
    // The mesh gets the opacities that this rule blends.
    let opaque = assert_is_renders(&mut page, json!({}));
    let blended = assert_is_renders(&mut page, json!({ "flags": { "coverage": "alpha" } }));
    assert_ne!(opaque["hash"], blended["hash"]);
    let figures = json!({ "scene": 1, "ask": "figures", "camera": camera([3.0, 4.0, 5.0]) });
    let any = json!({ "scene": 1, "flags": { "coverage": "any" } });
    let normal = json!({ "scene": 2, "show": "normal" });
    for (fields, reason) in [
        (any, "--coverage changes nothing"),
        (normal, "has no --aov normal"),
        (figures, "has none"),
    ] {
        let (head, _) = page.ask(fields);
        assert!(head["error"].as_str().unwrap().contains(reason), "{head}");
    }
}

#[test]
fn the_flags_of_the_command_line_begin() {
    let rules = "--paper --bits 40 --shade flat";
    let line = format!("tests/data/axes.vox {rules} --size 60x50 --aa 2 --azimuth 10 --mesh-up y");
    let program = Program::start(&line);
    let mut page = program.page();
    let flags = json!({ "bits": "40", "cage": "corners", "coverage": "any", "shade": "flat", "tolerance": "inf" });
    let begin = json!({ "size": [60, 50], "aa": 2, "flags": flags });
    for (key, value) in begin.as_object().unwrap() {
        assert_eq!(page.hello[key], *value);
    }
    let head = assert_is_renders(&mut page, begin);
    assert_eq!(head["axis"], json!([0.0, 1.0, 0.0]));
    let command = head["command"].as_str().unwrap();
    assert!(command.contains("--mesh-up=y"), "{head}");
}

#[test]
fn overlays_are_buffers_as_colours() {
    let program = Program::start("gen:menger,depth=3");
    let mut page = program.page();
    let mut seen = Vec::new();
    for show in ["color", "records", "voxel", "depth", "normal"] {
        let (head, rgba) = page.ask(json!({ "show": show, "hash": true, "size": [64, 64] }));
        assert_eq!(rgba.len(), 64 * 64 * 4, "{head}");
        let legend = head["legend"].as_array().map_or(0, Vec::len);
        assert_eq!(legend > 0, show != "color", "{head}");
        seen.push(rgba);
        // The buffer that is shown does not change the picture's hash.
        let (_, hash) = run_command(head["command"].as_str().unwrap());
        assert_eq!(head["hash"], hash);
    }
    seen.sort();
    seen.dedup();
    assert_eq!(seen.len(), 5);
}

#[test]
fn a_picked_voxel_is_that_of_the_buffer() {
    let program = Program::start("assets/tree.vox gen:menger,depth=3 assets/knot.obj --depth 7");
    let mut page = program.page();
    for (scene, engine, lod) in [
        (0, "fast", "0"),
        (0, "machine", "0"),
        (0, "rays", "4"),
        (1, "fast", "0"),
        (2, "fast", "2"),
    ] {
        let mut fields =
            json!({ "scene": scene, "aa": 2, "flags": { "engine": engine, "lod": lod } });
        let command = page.ask(fields.clone()).0["command"].take();
        let command = command.as_str().unwrap_or_else(|| panic!("{command}"));
        fields["ask"] = json!("pick");
        let mut count = 0;
        for at in [[60, 45], [50, 40], [70, 60], [1, 1]] {
            fields["at"] = json!(at);
            let (head, _) = page.ask(fields.clone());
            let voxel = voxel_of(command, at, 120);
            if voxel[3] < 0 {
                assert!(head["voxel"].is_null() && head["error"].is_null(), "{head}");
                continue;
            }
            count += 1;
            let picked = &head["voxel"];
            assert_eq!(picked["index"], json!(voxel[..3]), "{command} {head}");
            assert_eq!(picked["level"], voxel[3], "{head}");
            let [levels, level] = ["levels", "level"].map(|name| picked[name].as_u64().unwrap());
            if scene == 0 {
                assert_eq!(picked["side"], 2f64.powi((levels - level) as i32), "{head}");
            }
        }
        assert!(count > 0, "{command}");
    }
    let outside = json!({ "ask": "pick", "at": [120, 0] });
    assert!(
        page.ask(outside).0["error"]
            .as_str()
            .unwrap()
            .contains("outside")
    );
}

#[test]
fn figures_are_those_of_the_model() {
    let program = Program::start("gen:menger,depth=3");
    let mut page = program.page();
    let cage = json!({ "cage": "corners", "shade": "flat" });
    let mut fields = json!({ "size": [1024, 512], "flags": cage });
    let placed = page.ask(fields.clone()).0["camera"].take();
    fields["ask"] = json!("figures");
    fields["camera"] = json!({ "eye": placed["eye"], "target": placed["target"], "up": placed["up"], "fov": placed["fov_degrees"] });
    let (head, body) = page.ask(fields);
    assert!(body.is_empty());
    assert_eq!(
        json!([head["width"], head["height"]]),
        json!([256, 128]),
        "{head}"
    );
    let command = head["command"].as_str().unwrap();
    let line = format!("{} --json", command.strip_prefix("shiftvox ").unwrap());
    let model: Value = serde_json::from_slice(&shiftvox(&line).stdout).unwrap();
    let figures = &head["figures"];
    let operations = model["operations"].as_array().unwrap().iter();
    let operations: u64 = operations.map(|row| row["times"].as_u64().unwrap()).sum();
    assert_eq!(figures["operations"], operations);
    assert_eq!(figures["cycles"], model["simulated"]["cycles"]["cycles"]);
    let parts = ["operations", "on_chip", "outer", "leakage", "clock"];
    let energy = parts.map(|part| model["cost"][part]["total"].as_f64().unwrap());
    let energy = 1e-6 * energy.iter().sum::<f64>();
    assert!((figures["energy_uj"].as_f64().unwrap() / energy - 1.0).abs() < 1e-9);
    assert!(figures["records"].as_u64().unwrap() > 1000, "{figures}");
}

#[test]
fn two_pages_have_cameras_of_their_own() {
    let program = Program::start("assets/tree.vox");
    let mut pages = [program.page(), program.page()];
    for round in 0..3 {
        let eyes = [190.0 + f64::from(round), -150.0 - f64::from(round)];
        for (page, x) in pages.iter_mut().zip(eyes) {
            page.send(question(
                json!({ "camera": camera([x, -359.0, 228.0]), "hash": true }),
            ));
        }
        for (page, x) in pages.iter_mut().zip(eyes) {
            let (head, _) = page.answer();
            assert_eq!(head["camera"]["eye"][0], x);
            let (_, hash) = run_command(head["command"].as_str().unwrap());
            assert_eq!(head["hash"], hash);
        }
    }
}
