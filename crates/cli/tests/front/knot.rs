//! The bundled mesh, `assets/knot.obj`: a trefoil of our own making, so that every printed command about meshes can run.

use std::f64::consts::TAU;
use std::fmt::Write;
use std::fs;
use std::path::Path;

/// Rings along the knot, and corners of each.
const RINGS: usize = 96;
const CORNERS: usize = 8;
/// Radius of the tube.
const TUBE: f64 = 0.55;
/// Bands of a colour along the knot; the colours take turns.
const BANDS: usize = 12;
const COLORS: [(&str, [f64; 3]); 3] = [
    ("copper", [0.72, 0.38, 0.20]),
    ("teal", [0.10, 0.45, 0.47]),
    ("bone", [0.88, 0.84, 0.74]),
];

fn knot(t: f64) -> [f64; 3] {
    let wide = 2.0 + (3.0 * t).cos();
    [
        wide * (2.0 * t).cos(),
        wide * (2.0 * t).sin(),
        (3.0 * t).sin(),
    ]
}

fn unit(v: [f64; 3]) -> [f64; 3] {
    let length = v.iter().map(|c| c * c).sum::<f64>().sqrt();
    v.map(|c| c / length)
}

fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [0, 1, 2].map(|k| a[(k + 1) % 3] * b[(k + 2) % 3] - a[(k + 2) % 3] * b[(k + 1) % 3])
}

fn obj() -> String {
    let mut text =
        "# A trefoil knot, made by tests/front/knot.rs; +Y is up\nmtllib knot.mtl\n".to_owned();
    for ring in 0..RINGS {
        let t = TAU * ring as f64 / RINGS as f64;
        let [before, here, after] = [t - 1e-3, t, t + 1e-3].map(knot);
        let ahead = unit([0, 1, 2].map(|k| after[k] - before[k]));
        // The torus has its axis along z: away from it is a side that never meets the way ahead.
        let side = unit(cross(ahead, [0.0, 0.0, 1.0]));
        let up = cross(side, ahead);
        for corner in 0..CORNERS {
            let (sine, cosine) = (TAU * corner as f64 / CORNERS as f64).sin_cos();
            let [x, y, z] = [0, 1, 2].map(|k| here[k] + TUBE * (cosine * side[k] + sine * up[k]));
            writeln!(text, "v {x:.3} {y:.3} {z:.3}").unwrap();
        }
    }
    for ring in 0..RINGS {
        if ring % (RINGS / BANDS) == 0 {
            writeln!(
                text,
                "usemtl {}",
                COLORS[ring * BANDS / RINGS % COLORS.len()].0
            )
            .unwrap();
        }
        for corner in 0..CORNERS {
            let at = |ring: usize, corner: usize| ring % RINGS * CORNERS + corner % CORNERS + 1;
            let (a, b) = (at(ring, corner), at(ring + 1, corner));
            let (c, d) = (at(ring + 1, corner + 1), at(ring, corner + 1));
            writeln!(text, "f {a} {b} {c} {d}").unwrap();
        }
    }
    text
}

fn mtl() -> String {
    let material =
        |(name, [r, g, b]): (&str, [f64; 3])| format!("newmtl {name}\nKd {r:.2} {g:.2} {b:.2}\n");
    COLORS.map(material).concat()
}

#[test]
fn the_bundled_mesh_is_the_one_that_is_made_here() {
    let assets = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../..")).join("assets");
    for (name, made) in [("knot.obj", obj()), ("knot.mtl", mtl())] {
        let path = assets.join(name);
        if std::env::var_os("SHIFTVOX_BLESS").is_some() {
            fs::write(&path, &made).unwrap();
        }
        assert!(
            fs::read_to_string(&path).unwrap() == made,
            "{name}: SHIFTVOX_BLESS=1 remakes it"
        );
        assert!(made.len() < 40_000);
    }
}
