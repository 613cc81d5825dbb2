mod common;
use common::*;
use hwmodel::*;
use shiftvox::project::*;
struct Lim {
    n: u64,
    by: [u64; 64],
}
impl Probe for Lim {
    fn record(&mut self, _i: u64, level: u32) {
        self.n += 1;
        self.by[level as usize] += 1;
        if self.n > 2_000_000 {
            panic!("{:?}", self.by);
        }
    }
}
#[test]
fn dbg() {
    let g = octree(3, &|[x, y, z]| (x + y + z) % 3 == 0);
    let cam = camera([-10.0, -14.0, 12.0], [4.0, 4.0, 4.0], 48);
    let options = SetupOptions {
        coverage: Coverage::Any,
        lod_px: 1.0,
        tolerance_px: f64::INFINITY,
        cage: CageKind::Corners,
        ..Default::default()
    };
    let s = setup(&g, &cam, &options);
    let mut frame = shiftvox::frame::Frame::new(48, 48, false);
    std::panic::set_hook(Box::new(|_| {}));
    let r = shiftvox::machine::Machine::default()
        .render_probed(&g.view(), &s, &mut frame, Lim { n: 0, by: [0; 64] })
        .unwrap();
    println!("L{:?} {:?}", r.0, r.1.by);
}
