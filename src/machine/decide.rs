//! The work on one record without its children: it is drawn, dropped (`SPEC.md`, R7, R10) or subdivided.

use hwmodel::{Datapath, Memory, Probe, Short, Stage};

use super::alpha::BlendColor;
use super::blocks::{ADDRESS_BITS, Block, Port};
use super::cage::CageCoordinate;
use super::canvas::{Canvas, Paint};
use super::constants::Constants;
use super::counters::Counts;
use super::planes::Silhouette;
use super::record::{Pose, Record};
use super::size;
use super::state::Job;
use super::to_screen;
use super::undrawn::first_undrawn;
use super::verdict::{Verdict, is_hidden, verdict};
use crate::frame::QuadNode;

pub(super) enum RemainingWork {
    Nothing,
    Children,
}

/// Draws or drops a record, unless its children are needed.
#[inline(always)]
pub(super) fn decide<P: Probe, L: CageCoordinate>(
    dp: &mut Datapath<P>,
    job: &Job<'_>,
    canvas: &mut Canvas<'_>,
    counts: &mut Counts,
    record: &mut Record<L>,
) -> RemainingWork {
    let (c, place) = (&job.constants, record.place);
    if let Pose::Clip(clip, _) = &record.pose
        && to_screen::may_change(dp, c, record.cube.level, place, clip)
    {
        counts.changed_to_screen += 1;
        record.pose = Pose::Screen(to_screen::change(dp, c, place, clip));
    }

    dp.stage(Stage::OnePixel);
    let cube = &mut record.cube;
    // With leaf masks, a record reads its node only if it is subdivided.
    let is_read_late = job.layout.leaf_masks;
    if !cube.solid {
        let (node, level) = (cube.node, cube.level);
        cube.solid = level >= c.depth || job.graph.mask(node) == 0;
        if !is_read_late {
            read_node(dp, job, node, level);
        }
    }
    match verdict(dp, c, counts, record) {
        Verdict::DrawCentre => {
            if let Some(sample) = centre_sample(dp, c, record) {
                canvas.draw(dp, counts, sample, &paint(c, record, None));
            }
        }
        Verdict::DrawBox => {
            let paint = paint(c, record, None);
            while let Some(sample) = first_undrawn(dp, c, &canvas.fill, record) {
                canvas.draw(dp, counts, sample, &paint);
            }
        }
        Verdict::DrawSolid => draw_solid(dp, job, canvas, counts, record),
        Verdict::Drop => {}
        Verdict::Subdivide if is_hidden(dp, job, canvas, record) => {
            counts.hidden_across_bisectors += 1;
        }
        Verdict::Subdivide => {
            if is_read_late && !record.cube.solid {
                dp.stage(Stage::OnePixel);
                read_node(dp, job, record.cube.node, record.cube.level);
            }
            return RemainingWork::Children;
        }
    }
    RemainingWork::Nothing
}

/// Reads the words of an octree node, or its part of a brick's.
#[inline(always)]
fn read_node<P: Probe>(dp: &mut Datapath<P>, job: &Job<'_>, node: u32, level: u32) {
    for word in job.layout.words(node, level) {
        dp.read(Memory::Node, word);
        let data = (
            Short::unsigned(job.graph.mask(node), 8),
            Short::unsigned(job.graph.first(node), ADDRESS_BITS),
        );
        Port::NodeRead.tap(dp, word, &data);
    }
}

/// The sample of a record's centre, if it is in the picture and not before the near plane.
fn centre_sample<P: Probe, L: CageCoordinate>(
    dp: &mut Datapath<P>,
    c: &Constants,
    record: &Record<L>,
) -> Option<QuadNode> {
    dp.stage(Stage::Draw);
    match &record.pose {
        Pose::Clip(clip, _) => {
            let w = clip.w.centre(dp);
            dp.tap(Block::CageCentre, &clip.w, &w);
            if dp.lt(w, c.near) {
                return None;
            }
            size::clip_sample(dp, c, record.place, clip, w)
        }
        Pose::Screen(screen) => size::screen_sample(dp, c, record.place, screen),
    }
}

fn draw_solid<P: Probe, L: CageCoordinate>(
    dp: &mut Datapath<P>,
    job: &Job<'_>,
    canvas: &mut Canvas<'_>,
    counts: &mut Counts,
    record: &Record<L>,
) {
    let Pose::Clip(clip, planes) = &record.pose else {
        unreachable!("`FrameSetup::screen_depth` lets no record change under these rules");
    };
    counts.solids_drawn += 1;
    dp.stage(Stage::Draw);
    let (c, cube) = (&job.constants, &record.cube);
    let mut color = None;
    if let Some(eye) = &c.blend_eye {
        let node = cube.node;
        let (opacity, light) = (job.graph.opacity_of(node), job.graph.light_of(node));
        color = BlendColor::of_voxel(dp, eye, &c.eye_floor, cube, opacity, light);
        dp.stage(Stage::Draw);
        if color.is_none() {
            return;
        }
    }
    let paint = paint(c, record, color);
    let silhouette = Silhouette::new(dp, c, cube, planes, clip.w_min);
    dp.next_step(0);
    canvas.draw_silhouette(dp, counts, record.place.quad, silhouette, &paint);
}

fn paint<L>(c: &Constants, record: &Record<L>, color: Option<BlendColor>) -> Paint {
    let cube = &record.cube;
    let side_log2 = c.depth - cube.voxel_level;
    let [x, y, z] = cube.min.map(|min| {
        let voxel = min.to_host() >> c.sub_levels; // host: the voxel's number in the picture
        (voxel >> side_log2 << side_log2) as i32
    });
    Paint {
        node: cube.node,
        voxel: [x, y, z, cube.voxel_level as i32],
        color,
    }
}
