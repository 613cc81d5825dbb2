//! All methods of a mesh side by side.

use serde_json::Value;

use crate::program::{Folder, number};

/// A fan of thin blades, as a Wavefront file.
fn blades() -> String {
    let blade = |i: i32| {
        let (s, c) = (f64::from(i) * 2.4).sin_cos();
        let out = 0.2 + f64::from(i) * 0.02;
        let up = 1.0 + f64::from(i % 7) * 0.1;
        let [x, z, far_x, far_z] = [c * 0.1, s * 0.1, c * out, s * out];
        let [side_x, side_z] = [x - z, z + x];
        format!("v {x} 0 {z}\nv {far_x} {up} {far_z}\nv {side_x} 0.1 {side_z}\nf -3 -2 -1\n")
    };
    (0..40).map(blade).collect()
}

/// The row of a method, and of a height of the picture.
fn row<'r>(rows: &'r Value, method: &str, height: u64) -> &'r Value {
    let mut rows = rows["rows"].as_array().unwrap().iter();
    let found = rows.find(|row| row["method"] == method && row["height"] == height);
    found.unwrap_or_else(|| panic!("{method}, {height}"))
}

#[test]
fn all_methods_at_all_distances() {
    let folder = Folder::new();
    folder.put("blades.obj", blades());
    let line = "bench quality blades.obj --heights 64,32,16 --depth 6 --runs 1 --frames 2 --motions pan \
        --export-csv m.csv --export-svg m.svg";
    let document = folder.json(line);
    let rows = document["rows"].as_array().unwrap();
    // Of 40 triangles none are left of 64 or more.
    let of_height = rows.iter().filter(|row| row["height"] == 64);
    assert_eq!(of_height.count(), 3 + 6 + 4 + 6 + 6 + 4 + 1);
    let of = |method: &str, height, name: &str| number(&row(&document, method, height)[name]);
    let distance = |height| of("exact frame", height, "distance");
    assert!((distance(16) / distance(64) - 4.0).abs() < 1e-9);
    for height in [64, 32, 16] {
        let of = |method: &str, name: &str| of(method, height, name);
        let error = |method: &str| of(method, "rms_linear");
        let nearly = |a: &str, b: &str, most: f64| (error(a) / error(b) - 1.0).abs() < most;
        // More samples, less error; nothing below the noise.
        assert!(error("triangles 16") < error("triangles 4"));
        assert!(error("triangles 4") < error("triangles 1"));
        assert!(error("decimated 1/4, 16") > error("triangles 16"));
        assert!(nearly("hybrid 16", "triangles 16", 0.1));
        assert!(nearly("far six aa 4", "triangles 16", 0.1));
        assert!(of("hybrid 16", "ahead") > -0.5);
        // So few triangles are one leaf, which far voxels draw as they are.
        assert!(nearly("far six", "triangles 1", 0.01));
        assert_eq!(of("textured 16 eroded 0", "primitives"), 0.0);
        assert_eq!(of("exact frame", "scene_triangles"), 40.0);
        let noise = error("noise floor");
        let of_height = rows.iter().filter(|row| row["height"] == height);
        for row in of_height.filter(|row| row["method"] != "noise floor") {
            let [rms, flicker, work] =
                ["rms_linear", "flicker_pan", "work"].map(|name| number(&row[name]));
            assert!(rms > noise && flicker > 0.0 && work > 0.0, "{row}");
        }
    }
    assert_eq!(folder.text("m.csv").lines().count(), 1 + rows.len());
    let svg = folder.text("m.svg");
    let shown = ["noise floor", "rms, linear light", "64x64"].map(|text| svg.contains(text));
    assert_eq!(shown, [true; 3]);
}
