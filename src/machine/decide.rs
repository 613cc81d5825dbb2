//! The drawing rules (`SPEC.md`, R7, and R10, termination): a record is drawn, dropped or subdivided.

use crate::machine::stages::RecordStage;
use hwmodel::{Datapath, Memory, OpClass, Probe, Short};

use super::alpha::BlendColor;
use super::blocks::{ADDRESS_BITS, Block, Port};
use super::cage::CageCoordinate;
use super::canvas::{Canvas, Paint};
use super::constants::Constants;
use super::counters::Counts;
use super::levels;
use super::planes::Silhouette;
use super::record::{Clip, ImagePlace, Pose, Record};
use super::size;
use super::state::Job;
use super::to_screen;
use super::undrawn::first_undrawn;
use crate::frame::QuadNode;
use crate::project::options::OutlineRule;

/// Draws or drops a record, or returns true: its children are needed.
#[inline(always)]
pub(super) fn decide<P: Probe, L: CageCoordinate>(
    dp: &mut Datapath<P>,
    job: &Job<'_>,
    canvas: &mut Canvas<'_>,
    record: &mut Record<L>,
) -> bool {
    let (c, place) = (&job.constants, record.place);
    if let Pose::Clip(clip, _) = &record.pose
        && to_screen::may_change(dp, c, record.cube.level, place, clip)
    {
        canvas.counts.changed_to_screen += 1;
        record.pose = Pose::Screen(to_screen::change(dp, c, place, clip));
    }

    dp.stage(RecordStage::OnePixel);
    let cube = &mut record.cube;
    // With leaf masks, a record reads its node only if it is subdivided.
    let is_read_late = job.layout.leaf_masks;
    if !cube.solid {
        let (node, level) = (cube.node, cube.level);
        // The eight bits of the mask are one gate.
        dp.control(OpClass::Logic, 8);
        cube.solid = levels::reaches(dp, level, c.depth) || job.graph.mask(node) == 0;
        if !is_read_late {
            read_node(dp, job, node, level);
        }
    }
    match verdict(dp, c, &mut canvas.counts, record) {
        verdict @ (Verdict::DrawCentre | Verdict::DrawFarthest) => {
            let sample = match &record.pose {
                Pose::Clip(clip, _) if verdict == Verdict::DrawFarthest => {
                    farthest_sample(dp, c, record.place, clip)
                }
                _ => centre_sample(dp, c, record),
            };
            if let Some(sample) = sample {
                canvas.draw(dp, sample, &paint(c, record, None));
            }
        }
        Verdict::DrawBox => {
            let paint = paint(c, record, None);
            while let Some(sample) = first_undrawn(dp, c, &canvas.fill, record) {
                canvas.draw(dp, sample, &paint);
            }
        }
        Verdict::DrawSolid => draw_solid(dp, job, canvas, record),
        Verdict::Drop => {}
        Verdict::Subdivide if is_hidden(dp, job, canvas, record) => {
            canvas.counts.hidden_across_bisectors += 1;
        }
        Verdict::Subdivide => {
            if is_read_late && !record.cube.solid {
                dp.stage(RecordStage::OnePixel);
                read_node(dp, job, record.cube.node, record.cube.level);
            }
            return true;
        }
    }
    false
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
    dp.stage(RecordStage::Draw);
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

/// The sample of a cage's farthest vertex.
fn farthest_sample<P: Probe, L: CageCoordinate>(
    dp: &mut Datapath<P>,
    c: &Constants,
    place: ImagePlace,
    clip: &Clip<L>,
) -> Option<QuadNode> {
    dp.stage(RecordStage::Draw);
    let edges = clip.w.edges(dp);
    let [x, y, z] = edges.map(|edge| usize::from(!dp.is_negative(edge)));
    let vertex = [&clip.x, &clip.y, &clip.w].map(|cage| cage.vertices(dp)[x << 2 | y << 1 | z]);
    size::point_sample(dp, c, place, vertex)
}

fn draw_solid<P: Probe, L: CageCoordinate>(
    dp: &mut Datapath<P>,
    job: &Job<'_>,
    canvas: &mut Canvas<'_>,
    record: &Record<L>,
) {
    let Pose::Clip(clip, planes) = &record.pose else {
        unreachable!("`FrameSetup::screen_depth` lets no record change under these rules");
    };
    canvas.counts.solids_drawn += 1;
    dp.stage(RecordStage::Draw);
    let (c, cube) = (&job.constants, &record.cube);
    let mut color = None;
    if let Some(eye) = &c.blend_eye {
        let node = cube.node;
        let (opacity, light) = (job.graph.opacity_of(node), job.graph.light_of(node));
        color = BlendColor::of_voxel(dp, eye, &c.eye_floor, cube, opacity, light);
        dp.stage(RecordStage::Draw);
        if color.is_none() {
            return;
        }
    }
    let paint = paint(c, record, color);
    let silhouette = Silhouette::new(dp, c, cube, planes, clip.w_min);
    dp.next_step(0);
    canvas.draw_silhouette(dp, record.place.quad, silhouette, &paint);
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

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Verdict {
    /// At the sample of its centre (`any`, `center`).
    DrawCentre,
    /// At the sample of its farthest vertex, in a wide view (`any`, `center`).
    DrawFarthest,
    /// At every sample that its box overlaps (`any`).
    DrawBox,
    DrawSolid,
    Drop,
    Subdivide,
}

fn verdict<P: Probe, L: CageCoordinate>(
    dp: &mut Datapath<P>,
    c: &Constants,
    counts: &mut Counts,
    record: &mut Record<L>,
) -> Verdict {
    let has_near_plane = match c.outline {
        OutlineRule::Silhouette => false,
        OutlineRule::Box | OutlineRule::Centre => true,
    };
    if has_near_plane && is_sliver_at_near(dp, c, record) {
        return Verdict::Drop;
    }
    apply_level_of_detail(dp, c, record);
    let is_drawn = match c.outline {
        OutlineRule::Silhouette => record.cube.solid,
        OutlineRule::Box => is_in_one_sample(dp, c, record),
        OutlineRule::Centre => {
            record.cube.solid && !crosses_near(dp, c, record) && is_at_most_a_sample(dp, c, record)
        }
    };
    let is_last = levels::reaches(dp, record.cube.level, c.level_bound);
    // Rounded screen positions cannot separate its vertices.
    let mut is_least = || match &record.pose {
        Pose::Clip(..) => false,
        Pose::Screen(screen) => size::screen_at_most(dp, screen, c.least_size_screen),
    };
    let (draw, is_at_bound) = match c.outline {
        // A record at the level of the finest voxels is solid.
        OutlineRule::Silhouette => (Verdict::DrawSolid, false),
        OutlineRule::Box => (Verdict::DrawBox, is_last || is_least()),
        OutlineRule::Centre => (Verdict::DrawCentre, is_last),
    };
    if is_drawn {
        return draw;
    }
    if c.is_wide
        && has_near_plane
        && record.cube.solid
        && let Pose::Clip(clip, _) = &record.pose
        && size::is_about_one_sample(dp, c, record.place, clip)
    {
        return Verdict::DrawFarthest;
    }
    if !is_at_bound {
        return Verdict::Subdivide;
    }
    counts.at_level_bound += 1;
    if crosses_near(dp, c, record) {
        Verdict::DrawCentre
    } else {
        draw
    }
}

/// Whether all samples that a record may cover are drawn. Where occluded nodes are read, only records up to a sample's
/// size across a bisector are tested: their parts would be kept until both sides are full.
fn is_hidden<P: Probe, L: CageCoordinate>(
    dp: &mut Datapath<P>,
    job: &Job<'_>,
    canvas: &mut Canvas<'_>,
    record: &Record<L>,
) -> bool {
    let c = &job.constants;
    canvas.fill.rejects_full
        && if job.organisation.hidden_unread {
            !is_seen(dp, c, canvas, record)
        } else {
            !levels::reaches(dp, record.place.quad.level, c.levels)
                && !crosses_near(dp, c, record)
                && is_at_most_a_sample(dp, c, record)
                && first_undrawn(dp, c, &canvas.fill, record).is_none()
        }
}

/// Whether the ray of an undrawn sample meets a record.
fn is_seen<P: Probe, L: CageCoordinate>(
    dp: &mut Datapath<P>,
    c: &Constants,
    canvas: &mut Canvas<'_>,
    record: &Record<L>,
) -> bool {
    let Pose::Clip(clip, planes) = &record.pose else {
        unreachable!("`FrameSetup::screen_depth` lets no record change under these rules");
    };
    dp.stage(RecordStage::Draw);
    let silhouette = Silhouette::new(dp, c, &record.cube, planes, clip.w_min);
    dp.next_step(0);
    canvas.sees(dp, record.place.quad, silhouette)
}

/// Near plane (R7.2): whether a record across it spans so little depth that it is dropped.
fn is_sliver_at_near<P: Probe, L: CageCoordinate>(
    dp: &mut Datapath<P>,
    c: &Constants,
    record: &Record<L>,
) -> bool {
    let Pose::Clip(clip, _) = &record.pose else {
        return false;
    };
    if !dp.lt(clip.w_min, c.near) {
        return false;
    }
    let (w_min, w_max) = clip.w.span(dp);
    let span = dp.sub(w_max, w_min);
    dp.lt(span, c.near_crossing)
}

/// The image-order paper's rule, `any`: a solid whose box lies in one sample.
fn is_in_one_sample<P: Probe, L: CageCoordinate>(
    dp: &mut Datapath<P>,
    c: &Constants,
    record: &Record<L>,
) -> bool {
    let one = levels::reaches(dp, record.place.quad.level, c.levels) && record.place.inside;
    if !one || crosses_near(dp, c, record) {
        return false;
    }
    // A box within one sample fulfils a level of detail of one sample or more.
    let lod = c.lod_limit.as_ref();
    let is_coarse = lod.is_some_and(|limit| limit.value() >= c.size_limit.value());
    record.cube.solid || is_coarse
}

/// Level of detail (R7.1): makes a node with children solid if it is small enough.
#[inline(always)]
pub(super) fn apply_level_of_detail<P: Probe, L: CageCoordinate>(
    dp: &mut Datapath<P>,
    c: &Constants,
    record: &mut Record<L>,
) {
    if record.cube.solid {
        return;
    }
    record.cube.solid = match &record.pose {
        Pose::Clip(clip, _) => c.lod_depth[record.cube.level as usize].is_some_and(|least| {
            let solid = dp.le(least, clip.w_min);
            dp.tap(Block::DetailDepth, &(clip.w_min, least), &solid);
            solid
        }),
        Pose::Screen(screen) => size::screen_at_most(dp, screen, c.lod_limit_screen),
    };
}

fn crosses_near<P: Probe, L: CageCoordinate>(
    dp: &mut Datapath<P>,
    c: &Constants,
    record: &Record<L>,
) -> bool {
    match &record.pose {
        Pose::Clip(clip, _) => dp.lt(clip.w_min, c.near),
        Pose::Screen(_) => false,
    }
}

/// Less twice the tolerance.
#[inline(always)]
fn is_at_most_a_sample<P: Probe, L: CageCoordinate>(
    dp: &mut Datapath<P>,
    c: &Constants,
    record: &Record<L>,
) -> bool {
    match &record.pose {
        Pose::Clip(clip, _) => {
            let below = levels::above(dp, record.place.quad.level, c.levels);
            size::clip_at_most(dp, clip, &c.size_limit, below)
        }
        Pose::Screen(screen) => size::screen_at_most(dp, screen, c.size_limit_screen),
    }
}
