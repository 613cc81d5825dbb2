//! The kinds of meshes, of simple shapes.

use core::f64::consts::{PI, TAU};

use glam::{DVec3, dvec3};

use super::maker::Maker;

pub(super) fn scan(maker: &mut Maker) {
    const SIZE: [u32; 2] = [96, 192];
    let lobes: Vec<(DVec3, f64, f64)> = (0..40)
        .map(|i| {
            let unit = |maker: &mut Maker| maker.between(-1.0, 1.0);
            let towards = dvec3(unit(maker), unit(maker), unit(maker)).normalize_or(DVec3::X);
            let sharp = if i < 8 { 4.0 } else { 60.0 };
            (towards, sharp, maker.between(-2.0, 2.0) / libm::sqrt(sharp))
        })
        .collect();
    let noise: Vec<f64> = (0..(SIZE[0] + 1) * SIZE[1])
        .map(|_| maker.between(-0.005, 0.005))
        .collect();
    maker.sheet(SIZE, |row, column| {
        let polar = PI * f64::from(row) / f64::from(SIZE[0]);
        let around = TAU * f64::from(column) / f64::from(SIZE[1]);
        let mut towards = dvec3(
            libm::sin(polar) * libm::cos(around),
            libm::cos(polar),
            libm::sin(polar) * libm::sin(around),
        );
        let is_pole = row == 0 || row == SIZE[0];
        if is_pole {
            towards = DVec3::Y * towards.y.signum();
        }
        let bumps = lobes
            .iter()
            .map(|(lobe, sharp, height)| height * libm::exp(sharp * (lobe.dot(towards) - 1.0)));
        let height: f64 = bumps.sum::<f64>() * 0.25;
        let noise = match is_pole {
            true => 0.0,
            false => noise[(row * SIZE[1] + column) as usize],
        };
        let shade = |base: f64| (base + 90.0 * height).clamp(20.0, 250.0) as u8;
        let color = [shade(190.0), shade(150.0), shade(110.0)];
        (towards * (1.0 + height + noise), color)
    });
}

pub(super) fn machine(maker: &mut Maker) {
    let steel = maker.material([150, 155, 165]);
    let dark = maker.material([60, 64, 72]);
    let paint = maker.material([190, 70, 40]);
    maker.block(dvec3(-5.0, -0.3, -5.0), dvec3(5.0, 0.0, 5.0), dark);
    for _ in 0..14 {
        let low = dvec3(maker.between(-4.8, 3.0), 0.0, maker.between(-4.8, 3.0));
        let size = dvec3(
            maker.between(0.4, 1.8),
            maker.between(0.3, 2.5),
            maker.between(0.4, 1.8),
        );
        let material = [steel, paint][maker.lot.below(2) as usize];
        maker.block(low, low + size, material);
    }
    for _ in 0..60 {
        let foot = dvec3(maker.between(-4.8, 4.8), 0.0, maker.between(-4.8, 4.8));
        let radius = maker.between(0.04, 0.3);
        let top = foot + DVec3::Y * maker.between(0.2, 1.5);
        maker.tube([foot, top], [radius; 2], 32, steel);
    }
    for _ in 0..24 {
        let radius = maker.between(0.02, 0.1);
        let mut at = dvec3(maker.between(-4.5, 4.5), 0.0, maker.between(-4.5, 4.5));
        for bend in 0..5 {
            let length = maker.between(0.4, 2.5);
            let turn = [DVec3::Y, DVec3::X, DVec3::Z][bend % 3];
            let sign = if at.dot(turn) > 1.5 { -1.0 } else { 1.0 };
            let next = at + turn * length * sign;
            maker.tube([at, next], [radius; 2], 12, paint);
            at = next;
        }
    }
}

pub(super) fn wheel(maker: &mut Maker) {
    let rubber = maker.material([30, 30, 32]);
    let steel = maker.material([200, 203, 208]);
    maker.ring(DVec3::ZERO, [1.0, 0.035], [96, 16], rubber);
    maker.ring(DVec3::ZERO, [0.95, 0.015], [96, 8], steel);
    let hub = [DVec3::Z * -0.12, DVec3::Z * 0.12];
    maker.tube(hub, [0.04; 2], 24, steel);
    let pairs = 14 + maker.lot.below(5);
    let radius = maker.between(0.003, 0.005);
    let on = |angle: f64, r: f64, z: f64| dvec3(r * libm::cos(angle), r * libm::sin(angle), z);
    for pair in 0..pairs {
        for side in [-1.0, 1.0] {
            let at = TAU * (pair as f64 + side / 4.0) / pairs as f64;
            let to = at + side * maker.between(0.15, 0.25);
            let ends = [on(to, 0.05, side * 0.1), on(at, 0.945, 0.0)];
            maker.tube(ends, [radius; 2], 8, steel);
        }
    }
}

/// A trunk, branches that fork so many times, and leaves around the last ones.
pub(super) fn tree(maker: &mut Maker, [x, z]: [f64; 2], height: f64, forks: u32) {
    let bark = maker.material([95, 70, 50]);
    let leaves = [[70, 120, 40], [95, 140, 50], [60, 100, 45]].map(|c| maker.material(c));
    let foot = dvec3(x, 0.0, z);
    let mut growing = vec![(foot, DVec3::Y, height * 0.35, height * 0.03, 0)];
    while let Some((from, towards, length, radius, fork)) = growing.pop() {
        let to = from + towards * length;
        maker.tube([from, to], [radius, radius * 0.65], 8, bark);
        if fork == forks {
            for _ in 0..22 {
                let mut offset = || maker.between(-0.5, 0.5) * height * 0.11;
                let middle = to + dvec3(offset(), offset(), offset());
                let mut unit = || maker.between(-1.0, 1.0);
                let long = dvec3(unit(), unit(), unit()).normalize_or(DVec3::X);
                let across = long.any_orthonormal_vector();
                let size = height * maker.between(0.008, 0.013);
                let (long, across) = (long * size, across * size * 0.6);
                let corners = [
                    middle - long,
                    middle - across,
                    middle + long,
                    middle + across,
                ];
                let material = leaves[maker.lot.below(3) as usize];
                maker.quad(corners, material);
            }
            continue;
        }
        for _ in 0..4 {
            let mut unit = || maker.between(-1.0, 1.0);
            let aside = dvec3(unit(), unit() * 0.5 + 0.2, unit());
            let towards = (towards * 0.6 + aside).normalize_or(DVec3::Y);
            let shorter = length * maker.between(0.55, 0.75);
            growing.push((to, towards, shorter, radius * 0.6, fork + 1));
        }
    }
}

/// Rings of steps with seats on them, whose faces lie in common planes.
pub(super) fn stadium(maker: &mut Maker) {
    let concrete = maker.material([170, 168, 160]);
    let grass = maker.material([70, 130, 60]);
    let seats = [[180, 50, 40], [40, 70, 150]].map(|c| maker.material(c));
    let corner = dvec3(30.0, 0.0, 20.0);
    let up = DVec3::Y * -0.2;
    maker.block(-corner + up, corner, grass);
    for tier in 0..10 {
        let (inner, height) = (f64::from(tier) + 1.0, 0.6 * f64::from(tier + 1));
        for side in 0..4u32 {
            let is_long = side % 2 == 0;
            let sign = if side < 2 { 1.0 } else { -1.0 };
            let (half, out) = if is_long { (30.0, 20.0) } else { (20.0, 30.0) };
            let place = |along: f64, y: f64, away: f64| {
                let away = sign * (out + away);
                if is_long {
                    dvec3(along, y, away)
                } else {
                    dvec3(away, y, along)
                }
            };
            let mut block = |[a0, a1]: [f64; 2], [y0, y1]: [f64; 2], [o0, o1]: [f64; 2], m| {
                let (a, b) = (place(a0, y0, o0), place(a1, y1, o1));
                maker.block(a.min(b), a.max(b), m);
            };
            block([-half, half], [0.0, height], [inner, inner + 1.0], concrete);
            for seat in 0..(half * 0.8) as u32 {
                let along = -half + 1.0 + 2.4 * f64::from(seat);
                let seat_color = seats[(seat / 6 % 2) as usize];
                let width = [along, along + 1.6];
                for (top, front, back) in [(0.3, 0.3, 0.7), (0.8, 0.7, 0.8)] {
                    let depth = [inner + front, inner + back];
                    block(width, [height, height + top], depth, seat_color);
                }
            }
        }
    }
    let roofs = 3 + maker.lot.below(4);
    for _ in 0..roofs {
        let x = maker.between(-24.0, 20.0);
        let top = maker.between(9.0, 11.0);
        maker.block(
            dvec3(x, top, 18.0),
            dvec3(x + 8.0, top + 0.3, 32.0),
            concrete,
        );
        let mast = [0.0, top].map(|y| dvec3(x + 4.0, y, 31.0));
        maker.tube(mast, [0.2; 2], 12, concrete);
    }
}

fn house(maker: &mut Maker, [x, z]: [f64; 2], size: DVec3) {
    let shade = maker.between(-30.0, 30.0);
    let wall = maker.material([(205.0 + shade) as u8, (195.0 + shade) as u8, 175]);
    let roof = maker.material([150, (70.0 + shade) as u8, 55]);
    let glass = maker.material([70, 90, 110]);
    let at = |dx: f64, y: f64, dz: f64| dvec3(x + dx, y, z + dz);
    maker.block(at(0.0, 0.0, 0.0), at(size.x, size.y, size.z), wall);
    let (ridge, over) = (size.y + size.x * 0.5, 0.3);
    let eaves = |dx: f64, dz: f64| at(dx, size.y - over, dz);
    let (front, back) = (-over, size.z + over);
    let top = |dz: f64| at(size.x / 2.0, ridge, dz);
    for (dx, from, to) in [(-over, front, back), (size.x + over, back, front)] {
        maker.quad([eaves(dx, from), top(from), top(to), eaves(dx, to)], roof);
    }
    for dz in [0.0, size.z] {
        let gable = [
            at(0.0, size.y, dz),
            at(size.x, size.y, dz),
            at(size.x / 2.0, ridge, dz),
        ];
        maker.triangle(gable, None, wall);
    }
    let storeys = (size.y / 2.6) as u32;
    let windows = (size.z / 1.8) as u32;
    for storey in 0..storeys {
        let y = 0.9 + 2.6 * f64::from(storey);
        for window in 0..windows {
            let dz = 0.6 + 1.8 * f64::from(window);
            for dx in [-0.02, size.x + 0.02] {
                let corners = [[0.0, 0.0], [1.2, 0.0], [1.2, 0.9], [0.0, 0.9]];
                let corners = corners.map(|[up, along]| at(dx, y + up, dz + along));
                maker.quad(corners, glass);
            }
        }
    }
    let chimney = [
        at(size.x * 0.7, size.y, 1.0),
        at(size.x * 0.7 + 0.6, ridge + 0.4, 1.6),
    ];
    maker.block(chimney[0], chimney[1], wall);
}

pub(super) fn village(maker: &mut Maker) {
    let ground = maker.material([120, 130, 90]);
    maker.block(dvec3(-5.0, -0.3, -5.0), dvec3(95.0, 0.0, 95.0), ground);
    for row in 0..6 {
        for column in 0..6 {
            let place = [
                f64::from(row) * 16.0 + maker.between(0.0, 3.0),
                f64::from(column) * 16.0 + maker.between(0.0, 3.0),
            ];
            let size = dvec3(
                maker.between(5.0, 9.0),
                maker.between(2.8, 9.0),
                maker.between(6.0, 11.0),
            );
            house(maker, place, size);
        }
    }
}

pub(super) fn garden(maker: &mut Maker) {
    let ground = maker.material([110, 135, 80]);
    let wood = maker.material([225, 220, 210]);
    maker.block(dvec3(-9.0, -0.2, -9.0), dvec3(17.0, 0.0, 17.0), ground);
    house(maker, [0.0, 0.0], dvec3(7.0, 5.4, 9.0));
    for [x, z] in [[-5.0, -4.0], [12.0, -5.0], [12.0, 12.0], [-5.0, 13.0]] {
        let place = [x + maker.between(-1.0, 1.0), z + maker.between(-1.0, 1.0)];
        let height = maker.between(5.0, 8.0);
        tree(maker, place, height, 3);
    }
    for side in [-8.5, 16.5] {
        for picket in 0..100 {
            let along = -8.5 + 0.25 * f64::from(picket);
            let low = dvec3(along, 0.0, side);
            maker.block(low, low + dvec3(0.1, 1.1, 0.03), wood);
        }
        for y in [0.3, 0.8] {
            let low = dvec3(-8.5, y, side + 0.03);
            maker.block(low, low + dvec3(25.0, 0.08, 0.03), wood);
        }
    }
}
