//! A page's picture is that of `render`.

use serde_json::{Value, json};
use shiftvox::picture::png;

use crate::program::{Page, Program, run_command, shiftvox};

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

#[test]
fn a_picture_is_that_of_its_command() {
    let program = Program::start(&["assets/tree.vox", "gen:menger,depth=3"]);
    let mut page = program.page();
    assert_eq!(
        page.hello["scenes"],
        json!(["assets/tree.vox", "gen:menger,depth=3"])
    );
    let fitted = assert_is_renders(&mut page, json!({}));
    let near = json!({ "eye": [170.5, -300.25, 228.0], "target": [-10, -11, 128], "up": [0, 0, 1], "fov": 33.5 });
    let mut hashes = vec![fitted["hash"].clone()];
    for fields in [
        json!({ "camera": near }),
        json!({ "camera": near, "aa": 2, "size": [77, 130] }),
        json!({ "camera": near, "flags": { "coverage": "any", "cage": "corners", "tolerance": "inf" } }),
        json!({ "camera": near, "flags": { "lod": "4", "shade": "flat", "background": "none" } }),
        json!({ "camera": near, "flags": { "engine": "machine", "bits": "32", "frac": "9" } }),
        json!({ "scene": 1 }),
    ] {
        hashes.push(assert_is_renders(&mut page, fields)["hash"].clone());
    }
    hashes.sort_by_key(Value::to_string);
    hashes.dedup();
    assert_eq!(hashes.len(), 7, "different settings are different pictures");
}

#[test]
fn meshes_and_their_methods_are_drawn_as_render_draws_them() {
    let folder = tempfile::tempdir().unwrap();
    let made = |name: &str, words: &str| {
        let path = folder.path().join(name).to_str().unwrap().to_owned();
        let line = format!("convert assets/knot.obj --quiet {path} {words}");
        assert!(shiftvox(&line).status.success());
        path
    };
    let far = made("knot.far", "--rays 1000 --leaf-triangles 500");
    let tvx = made("knot.tvx", "--grid 8 --texels 4");
    let program = Program::start(&["assets/knot.obj", &far, &tvx, "--lod", "2"]);
    let mut page = program.page();
    assert_eq!(page.hello["flags"], json!({ "lod": "2" }));
    for scene in 0..3 {
        assert_is_renders(
            &mut page,
            json!({ "scene": scene, "flags": { "lod": "1.5" } }),
        );
    }
    // The mesh gets the opacities that this rule blends.
    let opaque = assert_is_renders(&mut page, json!({}));
    let blended = assert_is_renders(&mut page, json!({ "flags": { "coverage": "alpha" } }));
    assert_ne!(opaque["hash"], blended["hash"]);
    let camera = json!({ "eye": [3, 4, 5], "target": [0, 0, 0], "up": [0, 0, 1], "fov": 40 });
    for (fields, reason) in [
        (
            json!({ "scene": 1, "flags": { "coverage": "any" } }),
            "--coverage changes nothing",
        ),
        (
            json!({ "scene": 2, "show": "normal" }),
            "has no --aov normal",
        ),
        (
            json!({ "scene": 1, "ask": "figures", "camera": camera }),
            "has none",
        ),
    ] {
        let (head, _) = page.ask(fields);
        assert!(head["error"].as_str().unwrap().contains(reason), "{head}");
    }
}

#[test]
fn the_flags_of_the_command_line_begin() {
    let line = "tests/data/axes.vox --paper --bits 40 --shade flat --size 60x50 --aa 2 --azimuth 10 --mesh-up y";
    let program = Program::start(&line.split(' ').collect::<Vec<_>>());
    let mut page = program.page();
    let flags = json!({ "bits": "40", "cage": "corners", "coverage": "any", "shade": "flat", "tolerance": "inf" });
    assert_eq!(page.hello["flags"], flags);
    assert_eq!(
        (&page.hello["size"], &page.hello["aa"]),
        (&json!([60, 50]), &json!(2))
    );
    let head = assert_is_renders(
        &mut page,
        json!({ "size": [60, 50], "aa": 2, "flags": flags }),
    );
    assert_eq!(head["axis"], json!([0.0, 1.0, 0.0]));
    assert!(
        head["command"].as_str().unwrap().contains("--mesh-up=y"),
        "{head}"
    );
}

#[test]
fn overlays_are_buffers_as_colours() {
    let program = Program::start(&["gen:menger,depth=3"]);
    let mut page = program.page();
    let mut seen = Vec::new();
    for show in ["color", "records", "voxel", "depth", "normal"] {
        let (head, rgba) = page.ask(json!({ "show": show, "hash": true, "size": [64, 64] }));
        assert_eq!(rgba.len(), 64 * 64 * 4, "{head}");
        assert_eq!(
            head["ends"].is_null(),
            ["color", "normal"].contains(&show),
            "{head}"
        );
        seen.push(rgba);
        // The buffer that is shown does not change the picture's hash.
        assert_eq!(
            head["hash"],
            run_command(head["command"].as_str().unwrap()).1
        );
    }
    seen.sort();
    seen.dedup();
    assert_eq!(seen.len(), 5);
}

#[test]
fn figures_are_those_of_the_model() {
    let program = Program::start(&["gen:menger,depth=3"]);
    let mut page = program.page();
    let (picture, _) = page.ask(json!({ "size": [1024, 512], "flags": { "cage": "corners" } }));
    let camera = &picture["camera"];
    let camera = json!({ "eye": camera["eye"], "target": camera["target"], "up": camera["up"], "fov": camera["fov_degrees"] });
    let (head, body) = page.ask(
        json!({ "ask": "figures", "size": [1024, 512], "camera": camera, "flags": { "cage": "corners", "shade": "flat" } }),
    );
    assert!(body.is_empty());
    assert_eq!(
        (&head["width"], &head["height"]),
        (&json!(256), &json!(128)),
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
    let part = |name: &str| model["cost"][name]["total"].as_f64().unwrap();
    let energy = 1e-6 * (part("operations") + part("on_chip") + part("outer"));
    assert!((figures["energy_uj"]["value"].as_f64().unwrap() / energy - 1.0).abs() < 1e-9);
    assert!(figures["records"].as_u64().unwrap() > 1000, "{figures}");
}

#[test]
fn two_pages_have_cameras_of_their_own() {
    let program = Program::start(&["assets/tree.vox"]);
    let camera = |x: f64| json!({ "eye": [x, -359, 228], "target": [-10, -11, 128], "up": [0, 0, 1], "fov": 40 });
    let ask =
        |x: f64| crate::program::question(json!({ "camera": camera(x), "hash": true })).to_string();
    let (mut one, mut two) = (program.page(), program.page());
    for round in 0..5 {
        let eyes = [190.0 + f64::from(round), -150.0 - f64::from(round)];
        one.send(&ask(eyes[0]));
        two.send(&ask(eyes[1]));
        let heads = [one.answer().0, two.answer().0];
        for (head, eye) in heads.iter().zip(eyes) {
            assert_eq!(head["camera"]["eye"][0], eye);
        }
        assert_ne!(heads[0]["hash"], heads[1]["hash"]);
        if round == 4 {
            for head in heads {
                assert_eq!(
                    head["hash"],
                    run_command(head["command"].as_str().unwrap()).1
                );
            }
        }
    }
}
