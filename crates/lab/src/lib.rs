//! Experiments: what the renderer's rules cost and what they do to a picture.
//! Each gives plain data and a table. What was found: `spec/lab.md`.

pub mod bench;
pub mod bounds;
pub mod float_rays;
pub mod measure;
pub mod model;
pub mod quality;
pub mod report;
pub mod reproduce;
pub mod stress;

#[cfg(test)]
mod test_graphs {
    //! Graphs of one node for tests.

    use shiftvox::graph::{Graph, Placement, Store};

    /// A node of a colour that is its own child in these octants, at every level.
    pub(crate) fn one_node(depth: u32, octants: u8, color: [u8; 3]) -> Graph {
        let children = octants.count_ones();
        Graph {
            depth,
            root: 0,
            mask: Store::from(vec![octants; usize::from(depth > 0)]),
            first: Store::from(vec![0; usize::from(depth > 0)]),
            links: Store::from(vec![0; children as usize]),
            color: Store::from(vec![color]),
            normal: Store::from(vec![]),
            opacity: Store::from(vec![]),
            level_start: vec![],
            voxels: u64::from(children).pow(depth),
            placement: Placement::default(),
        }
    }
}
