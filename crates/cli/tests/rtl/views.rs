//! The views that machines draw: chosen ones, and random ones by seed.

pub(crate) const TREE: &str = concat!(
    env!("CARGO_MANIFEST_DIR"),
    "/../../assets/tree.vox --size 64"
);
/// In the middle of the sponge's hollow, looking at a corner of it.
pub(crate) const INSIDE: &str =
    "gen:menger,depth=3 --size 64 --eye 13.4,12.7,13.5 --target 20,16,11";

/// The bundled tree, a sponge, terrain, and an eye within them; sizes that fill the picture's quadtree and that do not.
pub(crate) const SCENES: [&str; 6] = [
    concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/../../assets/tree.vox --size 128"
    ),
    concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/../../assets/tree.vox --size 200x90 --azimuth 80 --elevation -20"
    ),
    "gen:menger,depth=4 --size 96 --view iso",
    "gen:terrain,depth=7 --size 128x64 --lod 0 --view right",
    "gen:terrain,depth=6 --size 64 --eye 20.2,30.7,25.1 --target 40,40,10",
    "gen:menger,depth=3 --size 50x70 --lod 4 --zoom 6",
];

/// Random numbers by seed.
pub(crate) struct Dice(pub(crate) u64);

impl Dice {
    pub(crate) fn below(&mut self, most: u64) -> u64 {
        self.0 = self
            .0
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 33) % most
    }
}

/// Scattered voxels from all sides and from near by, at random sizes and levels of detail, at least `least` samples
/// across.
pub(crate) fn view_from_outside(dice: &mut Dice, least: u64) -> String {
    let mut below = |most| dice.below(most);
    let scene = format!("gen:random,depth={},seed={}", 2 + below(4), below(1000));
    let size = format!("{}x{}", least + below(61 - least), 1 + below(60));
    let lod = ["0", "1", "3"][below(3) as usize];
    let (azimuth, elevation, zoom) = (below(360), below(180) as i64 - 90, 1 + below(8));
    let camera = format!("--azimuth={azimuth} --elevation={elevation} --zoom={zoom}");
    format!("{scene} --size {size} --lod {lod} {camera}")
}

/// From between voxels. Every other eye is at a voxel's corner.
pub(crate) fn view_from_within(dice: &mut Dice, least: u64) -> String {
    let (depth, on_corner) = (2 + dice.below(3), dice.below(2) == 0);
    let scene = format!("gen:random,depth={depth},seed={}", dice.below(1000));
    let size = format!("{}x{}", least + dice.below(31 - least), 1 + dice.below(30));
    let mut place = |tenths: u64| {
        let [x, y, z] = [(); 3].map(|()| dice.below(10 << depth) / tenths * tenths);
        let [x, y, z] = [x, y, z].map(|tenths| tenths as f64 / 10.0);
        format!("{x:.1},{y:.1},{z:.1}")
    };
    let (eye, target) = (place(if on_corner { 10 } else { 1 }), place(1));
    let fov = 40 + dice.below(100);
    format!("{scene} --size {size} --fov {fov} --eye {eye} --target {target}5")
}
