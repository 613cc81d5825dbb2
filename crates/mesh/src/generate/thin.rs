//! The kinds whose parts are all thin: from afar no part is as wide as a pixel, and still all of them are seen.

use core::f64::consts::TAU;

use glam::{DVec3, dvec3};

use super::maker::Maker;

/// A point of a wire that sags between its ends, from 0 to 1.
fn hanging([from, to]: [DVec3; 2], sag: f64, share: f64) -> DVec3 {
    from.lerp(to, share) - DVec3::Y * (4.0 * sag * share * (1.0 - share))
}

fn wire(maker: &mut Maker, ends: [DVec3; 2], sag: f64, radius: f64, material: u32) {
    const PIECES: u32 = 16;
    let at = |piece: u32| hanging(ends, sag, f64::from(piece) / f64::from(PIECES));
    for piece in 0..PIECES {
        maker.tube([at(piece), at(piece + 1)], [radius; 2], 4, material);
    }
}

const CORNERS: [[f64; 2]; 4] = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]];

/// A lattice of bars with three pairs of arms, and a wire through the tip of each.
pub(super) fn tower(maker: &mut Maker) {
    const STOREYS: u32 = 14;
    const HEIGHT: f64 = 30.0;
    let steel = maker.material([125, 130, 135]);
    let copper = maker.material([70, 60, 55]);
    let (foot, top) = (maker.between(2.6, 3.4), maker.between(0.4, 0.7));
    let half = |y: f64| foot + (top - foot) * y / HEIGHT;
    let at = |storey: u32, corner: u32| {
        let y = HEIGHT * f64::from(storey) / f64::from(STOREYS);
        let [x, z] = CORNERS[corner as usize % 4];
        dvec3(x * half(y), y, z * half(y))
    };
    for storey in 0..STOREYS {
        for corner in 0..4 {
            let (low, high) = (at(storey, corner), at(storey + 1, corner));
            let (next, above) = (at(storey, corner + 1), at(storey + 1, corner + 1));
            maker.tube([low, high], [0.08; 2], 6, steel);
            for bar in [[low, above], [next, high], [high, above]] {
                maker.tube(bar, [0.04; 2], 4, steel);
            }
        }
    }
    for y in [19.0, 23.0, 27.0] {
        for side in [-1.0, 1.0] {
            let tip = dvec3(side * maker.between(4.5, 5.5), y, 0.0);
            for [rise, z] in [[0.0, -1.0], [0.0, 1.0], [1.5, -1.0], [1.5, 1.0]] {
                let half = half(y + rise);
                let root = dvec3(side * half, y + rise, z * half);
                maker.tube([root, tip], [0.05; 2], 4, steel);
            }
            for end in [-25.0, 25.0] {
                let away = dvec3(tip.x, y, end);
                wire(maker, [tip, away], 2.0, 0.02, copper);
            }
        }
    }
}

/// Netting of crossed wires between posts, around a square.
pub(super) fn fence(maker: &mut Maker) {
    const SIDE: f64 = 6.0;
    const HEIGHT: f64 = 2.0;
    const WIRES: u32 = 60;
    let steel = maker.material([150, 160, 155]);
    let green = maker.material([60, 95, 70]);
    for corner in 0..4 {
        let [from, to] = [corner, (corner + 1) % 4].map(|corner: usize| {
            let [x, z] = CORNERS[corner];
            dvec3(x, 0.0, z) * SIDE
        });
        let at = |along: f64, y: f64| from.lerp(to, along) + DVec3::Y * y;
        for post in 0..4 {
            let along = f64::from(post) / 4.0;
            let lean = maker.between(-0.01, 0.01);
            maker.tube(
                [at(along, 0.0), at(along + lean, HEIGHT)],
                [0.05; 2],
                8,
                steel,
            );
        }
        for y in [0.05, HEIGHT - 0.05] {
            maker.tube([at(0.0, y), at(1.0, y)], [0.02; 2], 6, steel);
        }
        // Wires that rise as steeply as they go along, and those that fall.
        let run = HEIGHT / (2.0 * SIDE);
        for wire in 0..WIRES {
            let along = (1.0 - run) * f64::from(wire) / f64::from(WIRES - 1);
            for ends in [[0.0, HEIGHT], [HEIGHT, 0.0]] {
                let ends = [at(along, ends[0]), at(along + run, ends[1])];
                maker.tube(ends, [0.006; 2], 4, green);
            }
        }
    }
}

/// Bent blades on no ground.
pub(super) fn grass(maker: &mut Maker) {
    const BLADES: u32 = 12_000;
    let greens = [[80, 130, 45], [110, 150, 60], [150, 150, 80]].map(|c| maker.material(c));
    for _ in 0..BLADES {
        let foot = dvec3(maker.between(-5.0, 5.0), 0.0, maker.between(-5.0, 5.0));
        let (sin, cos) = libm::sincos(TAU * maker.lot.unit());
        let across = dvec3(cos, 0.0, sin) * 0.008;
        let lean = dvec3(-sin, 0.0, cos) * maker.between(0.02, 0.2);
        let height = DVec3::Y * maker.between(0.3, 0.7);
        let middle = foot + height * 0.6 + lean * 0.3;
        let material = greens[maker.lot.below(3) as usize];
        let [a, b, c, d] = [
            foot - across,
            foot + across,
            middle + across,
            middle - across,
        ];
        maker.quad([a, b, c, d], material);
        maker.triangle([d, c, foot + height + lean], None, material);
    }
}

/// Rows of chains between posts. Each link is a long ring, turned a quarter against the next one.
pub(super) fn chains(maker: &mut Maker) {
    const ROWS: u32 = 4;
    const LINKS: u32 = 60;
    const SIDES: u32 = 8;
    let wood = maker.material([120, 90, 60]);
    let iron = maker.material([95, 95, 105]);
    for row in 0..ROWS {
        let z = 1.5 * f64::from(row);
        let ends = [0.0, 6.0].map(|x| dvec3(x, 1.0, z));
        for end in ends {
            maker.block(
                end - dvec3(0.06, 1.0, 0.06),
                end + dvec3(0.06, 0.1, 0.06),
                wood,
            );
        }
        let sag = maker.between(0.4, 0.9);
        for link in 0..LINKS {
            let at = |link: f64| hanging(ends, sag, link / f64::from(LINKS));
            let half = (at(f64::from(link) + 1.0) - at(f64::from(link))) * 0.65;
            let middle = at(f64::from(link) + 0.5);
            let across = [DVec3::Z, half.cross(DVec3::Z).normalize_or(DVec3::Y)];
            let across = across[link as usize % 2] * 0.04;
            let corner = |side: u32| {
                let (sin, cos) = libm::sincos(TAU * f64::from(side % SIDES) / f64::from(SIDES));
                middle + half * cos + across * sin
            };
            for side in 0..SIDES {
                maker.tube([corner(side), corner(side + 1)], [0.009; 2], 4, iron);
            }
        }
    }
}
