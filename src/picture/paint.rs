//! The colours of a frame, one row of pixels at a time. Neighbours share work: samples without a voxel are found
//! sixteen at a time, and consecutive samples of one node look it up once.

use super::ResolveError;
use super::shade::{Shader, is_turned};
use super::shares::{Facing, Run, Shares, TOGETHER};
use crate::frame::{Blend, Frame, NO_NODE};
use crate::graph::{PackedNormal, prefetch};

/// Runs of [`TOGETHER`] samples, of whose nodes colours and normals are read ahead.
const AHEAD: usize = 2;

pub(super) struct Painter<'p, const N: usize> {
    frame: &'p Frame,
    shader: &'p Shader<'p>,
    color: &'p [[u8; 3]],
    normal: &'p [PackedNormal],
    shares: Option<&'p Shares>,
    aa: u32,
    behind: Vec<[u8; N]>,
}

/// The last sample's node, colour and result, since the next often shows the same.
struct Look<T> {
    node: u32,
    color: [u8; 3],
    packed: PackedNormal,
    facing: Facing,
    /// Of a node without normal, if the frame has no voxels.
    place: Option<[i32; 4]>,
    share: u32,
    made: T,
}

impl<'p, const N: usize> Painter<'p, N> {
    pub(super) fn new(
        frame: &'p Frame,
        shader: &'p Shader<'p>,
        shares: Option<&'p Shares>,
        aa: u32,
    ) -> Self {
        let behind = match shader.background() {
            Some(light) => pixel(shader.encode(light), 255),
            None => [0; N],
        };
        Self {
            frame,
            shader,
            color: &shader.graph.color,
            normal: &shader.graph.normal,
            shares,
            aa,
            behind: vec![behind; frame.width as usize >> aa],
        }
    }

    pub(super) fn row(&self, y: u32, to: &mut [[u8; N]]) -> Result<(), ResolveError> {
        match (&self.frame.blend, self.aa) {
            (Some(blend), _) => {
                self.blended(y, blend, to);
                Ok(())
            }
            (None, 0) => self.single(y, to),
            (None, _) => self.several(y, to),
        }
    }

    fn single(&self, y: u32, to: &mut [[u8; N]]) -> Result<(), ResolveError> {
        if self.shares.is_none() {
            self.flat(y, to);
            return Ok(());
        }
        to.copy_from_slice(&self.behind);
        let linear = self.shader.linear;
        let shown = |color, share| pixel(linear.encode_16(lit(linear.decode(color), share)), 255);
        self.for_samples(y, [0; N], shown, |x, shown| {
            if let Some(to) = to.get_mut(x) {
                *to = shown;
            }
        })
    }

    /// One sample per pixel, fully lit: colours need no conversion to light and back.
    fn flat(&self, y: u32, to: &mut [[u8; N]]) {
        let width = self.frame.width as usize;
        let nodes = &self.frame.node[y as usize * width..][..width];
        for ((to, &node), &behind) in to.iter_mut().zip(nodes).zip(&self.behind) {
            *to = match self.color.get(node as usize) {
                Some(&color) => pixel(color, 255),
                None if node == NO_NODE => behind,
                None => pixel([0; 3], 255),
            };
        }
    }

    fn several(&self, y: u32, to: &mut [[u8; N]]) -> Result<(), ResolveError> {
        let mut sums = vec![[0u32; 4]; to.len()];
        let linear = self.shader.linear;
        let light = |color, share| {
            let [r, g, b] = lit(linear.decode(color), share);
            [r, g, b, 1]
        };
        for y in y << self.aa..(y + 1) << self.aa {
            self.for_samples(y, [0; 4], light, |x, light| {
                if let Some(sum) = sums.get_mut(x >> self.aa) {
                    *sum = std::array::from_fn(|i| sum[i] + light[i]);
                }
            })?;
        }
        for ((to, [r, g, b, seen]), &behind) in to.iter_mut().zip(sums).zip(&self.behind) {
            *to = match seen {
                0 => behind,
                _ => self.mix([r, g, b], seen),
            };
        }
        Ok(())
    }

    /// Calls `put` with each sample of a row that shows a voxel, and the result of `make` for its colour and lit share.
    #[inline(always)]
    fn for_samples<T: Copy>(
        &self,
        y: u32,
        nothing: T,
        make: impl Fn([u8; 3], u32) -> T,
        mut put: impl FnMut(usize, T),
    ) -> Result<(), ResolveError> {
        let width = self.frame.width as usize;
        let (runs, last) = self.frame.node[y as usize * width..][..width].as_chunks::<TOGETHER>();
        let mut padded = [NO_NODE; TOGETHER];
        padded[..last.len()].copy_from_slice(last);
        let down = self.shares.map_or(0.0, |shares| shares.down(y));
        let mut look = Look {
            node: NO_NODE,
            color: [0; 3],
            packed: PackedNormal::NONE,
            facing: Facing::UNKNOWN,
            place: None,
            share: 0,
            made: nothing,
        };
        let starts = (0usize..).step_by(TOGETHER);
        for (start, nodes) in starts.zip(runs.iter().chain([&padded])) {
            if let Some(ahead) = runs.get(start / TOGETHER + AHEAD) {
                self.prefetch(ahead);
            }
            if nodes
                .iter()
                .fold(true, |all, &node| all & (node == NO_NODE))
            {
                continue;
            }
            let run = match self.shares {
                Some(shares) => shares.run(start as u32, down),
                None => Run::FLAT,
            };
            for i in 0..TOGETHER {
                let node = nodes[i];
                if node == NO_NODE {
                    continue;
                }
                if node != look.node {
                    self.look_at(&mut look, node, down);
                }
                let share = match run.share(i, &look.facing) {
                    Some(share) => share,
                    None => {
                        let x = (start + i) as u32;
                        self.share_by_rule(look.packed, look.facing, look.place, x, y)?
                    }
                };
                if share != look.share {
                    look.share = share;
                    look.made = make(look.color, share);
                }
                put(start + i, look.made);
            }
        }
        Ok(())
    }

    #[inline(always)]
    fn prefetch(&self, nodes: &[u32; TOGETHER]) {
        let mut before = NO_NODE;
        for &node in nodes {
            if node != before && node != NO_NODE {
                prefetch(self.color, node as usize);
                prefetch(self.normal, node as usize);
            }
            before = node;
        }
    }

    #[inline(always)]
    fn look_at<T>(&self, look: &mut Look<T>, node: u32, down: f32) {
        let at = node as usize;
        look.node = node;
        // An impossible share, since the colour changes.
        look.share = u32::MAX;
        look.color = self.color.get(at).copied().unwrap_or_default();
        let Some(shares) = self.shares else {
            look.facing = Facing::FLAT;
            return;
        };
        look.packed = self.normal.get(at).copied().unwrap_or_default();
        look.facing = match shares.facing(look.packed, down) {
            Some(facing) => facing,
            None => {
                look.place = self.place_of(node);
                Facing::UNKNOWN
            }
        };
    }

    #[cold]
    fn place_of(&self, node: u32) -> Option<[i32; 4]> {
        match self.frame.voxel.is_empty() {
            true => self.shader.graph.place_of(node),
            false => None,
        }
    }

    #[cold]
    fn share_by_rule(
        &self,
        packed: PackedNormal,
        facing: Facing,
        place: Option<[i32; 4]>,
        x: u32,
        y: u32,
    ) -> Result<u32, ResolveError> {
        let sight = &self.shader.sight;
        if let Some(normal) = packed.decode() {
            return Ok(match is_turned(normal, sight.ray(x, y)) {
                true => facing.back,
                false => facing.front,
            });
        }
        let at = y as usize * self.frame.width as usize + x as usize;
        let voxel = self.frame.voxel.get(at).copied().or(place);
        let voxel = voxel.ok_or(ResolveError::Voxel)?;
        Ok(self.shader.light.on(sight.meet(x, y, voxel).face))
    }

    fn mix(&self, sum: [u32; 3], seen: u32) -> [u8; N] {
        let samples_log2 = 2 * self.aa;
        let samples = 1u32 << samples_log2;
        let half = samples >> 1;
        if let Some(behind) = self.shader.background() {
            // All samples count, so their number is a power of two.
            let mean: [u32; 3] = std::array::from_fn(|c| {
                (sum[c] + (samples - seen) * behind[c] + half) >> samples_log2
            });
            return pixel(self.shader.encode(mean), 255);
        }
        let alpha = ((seen << 8) - seen + half) >> samples_log2;
        // PNG stores colours that are not premultiplied, so the host divides.
        let mean = sum.map(|channel| (channel + seen / 2) / seen);
        pixel(self.shader.encode(mean), alpha as u8)
    }

    fn blended(&self, y: u32, blend: &[Blend], to: &mut [[u8; N]]) {
        let width = self.frame.width as usize;
        let side = 1usize << self.aa;
        let rows = &blend[y as usize * side * width..][..side * width];
        for (x, to) in to.iter_mut().enumerate() {
            let mut blended = Blended::default();
            for row in rows.chunks_exact(width) {
                for sample in &row[x * side..][..side] {
                    blended.add(sample, self.shader.background());
                }
            }
            *to = blended.mix(self.shader, 2 * self.aa);
        }
    }
}

#[inline]
fn lit(light: [u32; 3], share: u32) -> [u32; 3] {
    light.map(|channel| (channel * share) >> 8)
}

#[inline]
fn pixel<const N: usize>([r, g, b]: [u8; 3], alpha: u8) -> [u8; N] {
    let all = [r, g, b, alpha];
    std::array::from_fn(|i| all[i])
}

/// Sums of a pixel's blended samples, of 256 each.
#[derive(Default)]
struct Blended {
    light: [u64; 3],
    covered: u32,
}

impl Blended {
    fn add(&mut self, sample: &Blend, background: Option<[u32; 3]>) {
        self.covered += 256 - u32::from(sample.left);
        let behind = background.unwrap_or([0; 3]);
        for c in 0..3 {
            let through = u32::from(sample.left) * behind[c];
            self.light[c] += u64::from(sample.light[c] + through);
        }
    }

    fn mix<const N: usize>(&self, shader: &Shader<'_>, samples_log2: u32) -> [u8; N] {
        let places = 8 + samples_log2;
        let half = 1u32 << (places - 1);
        if shader.background().is_some() {
            let mean = self.light.map(|c| ((c + u64::from(half)) >> places) as u32);
            return pixel(shader.encode(mean), 255);
        }
        if self.covered == 0 {
            return [0; N];
        }
        let covered = u64::from(self.covered);
        let mean = self.light.map(|c| ((c + covered / 2) / covered) as u32);
        let alpha = ((self.covered << 8) - self.covered + half) >> places;
        pixel(shader.encode(mean), alpha as u8)
    }
}
