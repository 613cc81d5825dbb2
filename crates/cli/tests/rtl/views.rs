//! The views that machines draw: chosen ones, and random ones by seed.

pub(crate) const TREE: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../assets/tree.vox");
/// In the middle of the sponge's hollow, looking at a corner of it.
pub(crate) const INSIDE: [&str; 7] = [
    "gen:menger,depth=3",
    "--size",
    "64",
    "--eye",
    "13.4,12.7,13.5",
    "--target",
    "20,16,11",
];

/// The bundled tree, a sponge, terrain, and an eye within them; sizes that fill the picture's quadtree and that do not.
pub(crate) const SCENES: [&[&str]; 6] = [
    &[TREE, "--size", "128"],
    &[
        TREE,
        "--size",
        "200x90",
        "--azimuth",
        "80",
        "--elevation",
        "-20",
    ],
    &["gen:menger,depth=4", "--size", "96", "--view", "iso"],
    &[
        "gen:terrain,depth=7",
        "--size",
        "128x64",
        "--lod",
        "0",
        "--view",
        "right",
    ],
    &[
        "gen:terrain,depth=6",
        "--size",
        "64",
        "--eye",
        "20.2,30.7,25.1",
        "--target",
        "40,40,10",
    ],
    &[
        "gen:menger,depth=3",
        "--size",
        "50x70",
        "--lod",
        "4",
        "--zoom",
        "6",
    ],
];

/// A number below another, from the seed.
pub(crate) type Dice<'d> = &'d mut dyn FnMut(u64) -> u64;

/// Scattered voxels by seed, from all sides and from near by, at random sizes and levels of detail.
pub(crate) fn any_view(next: Dice<'_>) -> Vec<String> {
    let scene = format!("gen:random,depth={},seed={}", 2 + next(4), next(1000));
    let size = format!("{}x{}", 1 + next(60), 1 + next(60));
    let lod = ["0", "1", "3"][next(3) as usize];
    let (azimuth, elevation, zoom) = (next(360), next(180) as i64 - 90, 1 + next(8));
    let camera = format!("--azimuth={azimuth} --elevation={elevation} --zoom={zoom}");
    words(&format!("{scene} --size {size} --lod {lod} {camera}"))
}

/// From between them; every other eye has a voxel's corner for its place.
pub(crate) fn view_from_within(next: Dice<'_>) -> Vec<String> {
    let (depth, on_corner) = (2 + next(3), next(2) == 0);
    let scene = format!("gen:random,depth={depth},seed={}", next(1000));
    let size = format!("{}x{}", 1 + next(30), 1 + next(30));
    let mut place = |tenths: u64| {
        let mut coordinate = || next(10 << depth) / tenths * tenths;
        let [x, y, z] = [(); 3].map(|()| coordinate() as f64 / 10.0);
        format!("{x:.1},{y:.1},{z:.1}")
    };
    let (eye, target) = (place(if on_corner { 10 } else { 1 }), place(1));
    let fov = 40 + next(100);
    words(&format!(
        "{scene} --size {size} --fov {fov} --eye {eye} --target {target}5"
    ))
}

fn words(line: &str) -> Vec<String> {
    line.split(' ').map(str::to_owned).collect()
}
