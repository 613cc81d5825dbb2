//! Clusters of triangles: all in memory, or as many as a budget allows, the others in a file.

use std::collections::VecDeque;
use std::fs::File;
use std::io::{self, Seek, SeekFrom, Write};
use std::ops::Range;
use std::sync::{Arc, Mutex};

use glam::DVec3;
use rayon::prelude::*;

use super::rays::{Around, Cluster, Meeting, Query, is_any_entered};
use crate::list::lock;

pub(super) const CLUSTER: usize = 1 << 17;
/// Bytes per triangle of a cluster while it is made, or less.
pub(super) const MAKING: u64 = 320;
/// Bytes per triangle of a finished cluster, or less.
pub(super) const MADE: u64 = 80;

/// Whether a triangle, by its number in all parts, stops a ray that meets it at a point.
pub(super) type Stops<'s> = dyn Fn(usize, DVec3) -> bool + Sync + 's;

pub(super) struct Occluders<'s> {
    parts: Vec<Part>,
    /// Without, each triangle stops each ray.
    stops: Option<&'s Stops<'s>>,
    held: Held,
}

enum Held {
    All(Vec<Arc<Cluster>>),
    Some(Mutex<Cache>),
}

struct Cache {
    file: File,
    /// Where the sections of each begin and end in the file.
    sections: Vec<[u64; 4]>,
    most: u64,
    bytes: u64,
    here: VecDeque<(usize, Arc<Cluster>)>,
}

pub(super) struct Part {
    pub(super) triangles: Range<usize>,
    pub(super) around: Around,
}

impl<'s> Occluders<'s> {
    /// `within`: a file, and the most bytes in memory beside a cluster per thread.
    pub(super) fn new(
        parts: Vec<Part>,
        corners: impl Fn(usize) -> [DVec3; 3] + Sync,
        stops: Option<&'s Stops<'s>>,
        within: Option<(File, u64)>,
    ) -> io::Result<Self> {
        let make = |part: &Part| Cluster::new(part.triangles.clone().map(&corners));
        let held = match within {
            None => Held::All(parts.par_iter().map(|part| Arc::new(make(part))).collect()),
            Some((file, most)) => {
                let mut cache = Cache {
                    file,
                    sections: Vec::new(),
                    most,
                    bytes: 0,
                    here: VecDeque::new(),
                };
                for part in &parts {
                    cache.put(make(part))?;
                }
                Held::Some(Mutex::new(cache))
            }
        };
        Ok(Self { parts, stops, held })
    }

    /// The triangles that stop rays, which are within a box.
    pub(super) fn nearest(
        &self,
        within: &Around,
        queries: &[Query],
        meetings: &mut Vec<Meeting>,
    ) -> io::Result<()> {
        meetings.clear();
        meetings.resize(queries.len(), Meeting::NONE);
        // Those in the middle first: most rays end there, and hide what is behind.
        let parts = self.parts.iter().enumerate();
        let parts = parts.filter(|(_, part)| part.around.touches(within));
        let near = parts.map(|(number, part)| (part.around.square_from(within), number));
        let mut near: Vec<(f32, usize)> = near.collect();
        near.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        for (_, number) in near {
            let Part { around, triangles } = &self.parts[number];
            if is_any_entered(around, queries, meetings) {
                let cluster = self.get(number)?;
                let first = triangles.start as u32;
                cluster.meet_all(around, first, self.stops, queries, meetings);
            }
        }
        Ok(())
    }

    fn get(&self, number: usize) -> io::Result<Arc<Cluster>> {
        match &self.held {
            Held::All(all) => Ok(all[number].clone()),
            Held::Some(cache) => lock(cache).get(number),
        }
    }
}

impl Cache {
    fn put(&mut self, cluster: Cluster) -> io::Result<()> {
        let mut end = self.sections.last().map_or(0, |sections| sections[3]);
        let mut places = [end; 4];
        for (section, place) in cluster.sections().into_iter().zip(&mut places[1..]) {
            self.file.write_all(section)?;
            end += section.len() as u64;
            *place = end;
        }
        self.sections.push(places);
        self.make_room(cluster.bytes());
        self.keep(self.sections.len() - 1, Arc::new(cluster));
        Ok(())
    }

    fn make_room(&mut self, bytes: u64) {
        while self.bytes + bytes > self.most
            && let Some((_, old)) = self.here.pop_front()
        {
            self.bytes -= old.bytes();
        }
    }

    fn keep(&mut self, number: usize, cluster: Arc<Cluster>) {
        self.bytes += cluster.bytes();
        self.here.push_back((number, cluster));
    }

    fn get(&mut self, number: usize) -> io::Result<Arc<Cluster>> {
        if let Some(at) = self.here.iter().position(|(other, _)| *other == number)
            && let Some(found) = self.here.remove(at)
        {
            let cluster = found.1.clone();
            self.here.push_back(found);
            return Ok(cluster);
        }
        let sections @ [begin, .., end] = self.sections[number];
        self.make_room(end - begin);
        self.file.seek(SeekFrom::Start(begin))?;
        let lengths = [0, 1, 2].map(|k| (sections[k + 1] - sections[k]) as usize);
        let cluster = Arc::new(Cluster::read(&mut self.file, lengths)?);
        self.keep(number, cluster.clone());
        Ok(cluster)
    }
}
