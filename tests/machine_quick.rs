mod common;
use common::*;
use shiftvox::project::*;

#[test]
fn look() {
    for (cov, lod, tol, cage) in [
        (Coverage::Exact, 0.0, 0.0, CageKind::Frame),
        (Coverage::Exact, 0.0, 0.0, CageKind::Corners),
        (Coverage::Exact, 1.0, 0.0625, CageKind::Frame),
        (Coverage::Center, 1.0, 0.0625, CageKind::Frame),
        (Coverage::Center, 1.0, 0.0, CageKind::Corners),
        (Coverage::Any, 1.0, f64::INFINITY, CageKind::Corners),
    ] {
        let g = octree(3, &|[x, y, z]| (x + y + z) % 3 == 0);
        let cam = camera([-10.0, -14.0, 12.0], [4.0, 4.0, 4.0], 48);
        let options = SetupOptions {
            coverage: cov,
            lod_px: lod,
            tolerance_px: tol,
            cage,
            ..Default::default()
        };
        let s = setup(&g, &cam, &options);
        let (f, stats) = draw_with(Default::default(), &g, &s).unwrap();
        println!(
            "{cov:?} {cage:?} {tol} G={} S={} F={}",
            s.clip_frac,
            s.sub_levels,
            s.format.frac()
        );
        println!("{stats:?}");
        for y in (0..48).step_by(2) {
            let row: String = (0..48)
                .map(|x| {
                    let v = f.voxel[y * 48 + x];
                    if v[3] < 0 {
                        '.'
                    } else {
                        (b'a' + (v[0] * 5 + v[1] * 3 + v[2]) as u8 % 26) as char
                    }
                })
                .collect();
            println!("{row}");
        }
    }
}
