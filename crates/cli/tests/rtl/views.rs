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
    /// A number below another.
    pub(crate) fn next(&mut self, most: u64) -> u64 {
        self.0 = self
            .0
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 33) % most
    }
}

/// Scattered voxels by seed, from all sides and from near by, at random sizes and levels of detail.
pub(crate) fn any_view(dice: &mut Dice) -> String {
    let mut next = |most| dice.next(most);
    let scene = format!("gen:random,depth={},seed={}", 2 + next(4), next(1000));
    let size = format!("{}x{}", 1 + next(60), 1 + next(60));
    let lod = ["0", "1", "3"][next(3) as usize];
    let (azimuth, elevation, zoom) = (next(360), next(180) as i64 - 90, 1 + next(8));
    let camera = format!("--azimuth={azimuth} --elevation={elevation} --zoom={zoom}");
    format!("{scene} --size {size} --lod {lod} {camera}")
}

/// From between voxels. Every other eye is at a voxel's corner.
pub(crate) fn view_from_within(dice: &mut Dice) -> String {
    let (depth, on_corner) = (2 + dice.next(3), dice.next(2) == 0);
    let scene = format!("gen:random,depth={depth},seed={}", dice.next(1000));
    let size = format!("{}x{}", 1 + dice.next(30), 1 + dice.next(30));
    let mut place = |tenths: u64| {
        let mut coordinate = || dice.next(10 << depth) / tenths * tenths;
        let [x, y, z] = [(); 3].map(|()| coordinate() as f64 / 10.0);
        format!("{x:.1},{y:.1},{z:.1}")
    };
    let (eye, target) = (place(if on_corner { 10 } else { 1 }), place(1));
    let fov = 40 + dice.next(100);
    format!("{scene} --size {size} --fov {fov} --eye {eye} --target {target}5")
}

/// A view with tiles: more than eight samples across.
pub(crate) fn with_tiles(make: fn(&mut Dice) -> String, dice: &mut Dice) -> String {
    loop {
        let view = make(dice);
        let (_, size) = view.split_once("--size ").unwrap();
        if size.split('x').next().unwrap().parse::<u32>().unwrap() > 8 {
            return view;
        }
    }
}
