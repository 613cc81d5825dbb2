//! Lists of a mesh: in memory, or in mapped files of a [`ListFolder`], for meshes larger than memory.
//!
//! The system writes pages of mapped files to the disk when it needs their memory. Until then they count as memory of
//! the program, so a thread drops them from it where they are many.

use std::fs::File;
use std::io::{self, Seek, SeekFrom, Write};
use std::marker::PhantomData;
use std::ops::{Deref, DerefMut};
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError, Weak};
use std::time::Duration;
use std::{fmt, slice, thread};

use memmap2::{MmapOptions, MmapRaw};

use super::SceneError;
use shiftvox::budget;

/// A file grows by half of its size, within these bytes.
const LEAST_GROWTH: usize = 1 << 16;
const MOST_GROWTH: usize = 1 << 25;
/// How often the thread checks how many pages there are.
const INTERVAL: Duration = Duration::from_millis(4);

/// Where lists are files without names. They vanish with their lists.
#[derive(Debug)]
pub struct ListFolder {
    pub(crate) path: PathBuf,
    maps: Mutex<Vec<Weak<MmapRaw>>>,
    failure: Mutex<Option<io::Error>>,
}

impl ListFolder {
    /// Keeps about `most` bytes of its files in the program's memory, where the system reports how many there are.
    pub fn new(path: &Path, most: u64) -> Arc<Self> {
        let folder = Arc::new(Self {
            path: path.to_owned(),
            maps: Mutex::default(),
            failure: Mutex::default(),
        });
        if let Some(before) = budget::resident_files() {
            let folder = Arc::downgrade(&folder);
            let watch = move || {
                while let Some(folder) = folder.upgrade() {
                    if budget::resident_files() > Some(before + most) {
                        folder.release();
                    }
                    drop(folder);
                    thread::sleep(INTERVAL);
                }
            };
            // Without it, only the system takes pages back.
            let _ = thread::Builder::new().spawn(watch);
        }
        folder
    }

    /// Drops all pages of its files from the program's memory. They return when they are next used.
    pub fn release(&self) {
        lock(&self.maps).retain(|map| {
            let map = map.upgrade();
            #[cfg(unix)]
            if let Some(map) = &map {
                // SAFETY: the map is shared with its file, which keeps what was written to a dropped page.
                let _ = unsafe { map.unchecked_advise(memmap2::UncheckedAdvice::DontNeed) };
            }
            map.is_some()
        });
    }

    /// Bytes of all its files.
    pub fn bytes(&self) -> u64 {
        let maps = lock(&self.maps);
        let maps = maps.iter().filter_map(Weak::upgrade);
        maps.map(|map| map.len() as u64).sum()
    }

    /// Whether all files could grow so far.
    pub(crate) fn has_room(&self) -> bool {
        lock(&self.failure).is_none()
    }

    /// Fails once after a file could not grow. Lists lack items then.
    pub(crate) fn check(&self) -> Result<(), SceneError> {
        let failed = |source| SceneError::Io {
            file: self.path.display().to_string(),
            action: "write temporary files",
            source,
        };
        let failure = lock(&self.failure).take();
        failure.map_or(Ok(()), |source| Err(failed(source)))
    }

    /// The content of a file, which must not change meanwhile.
    pub(crate) fn read(
        self: &Arc<Self>,
        file: File,
    ) -> io::Result<impl Deref<Target = [u8]> + use<>> {
        let map = Arc::new(MmapOptions::new().map_raw_read_only(&file)?);
        lock(&self.maps).push(Arc::downgrade(&map));
        Ok(List::<u8>(Held::File(Mapped {
            len: map.len(),
            map: Some(map),
            file: Some(file),
            is_full: false,
            folder: self.clone(),
            items: PhantomData,
        })))
    }
}

pub(crate) fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

/// A list that grows. A copy of it is in memory.
pub(crate) struct List<T>(Held<T>);

enum Held<T> {
    Memory(Vec<T>),
    File(Mapped<T>),
}

struct Mapped<T> {
    folder: Arc<ListFolder>,
    /// None before the first item.
    file: Option<File>,
    map: Option<Arc<MmapRaw>>,
    /// Items, which are at the beginning of the map.
    len: usize,
    /// It could not grow.
    is_full: bool,
    items: PhantomData<Vec<T>>,
}

impl<T: Copy> Mapped<T> {
    fn capacity(&self) -> usize {
        self.map
            .as_ref()
            .map_or(0, |map| map.len() / size_of::<T>())
    }

    fn first(&self) -> *mut T {
        let map = self.map.as_ref();
        map.map_or(std::ptr::dangling_mut(), |map| map.as_mut_ptr().cast())
    }

    #[cold]
    fn grow(&mut self) -> io::Result<()> {
        if self.file.is_none() {
            self.file = Some(tempfile::tempfile_in(&self.folder.path)?);
        }
        let Some(file) = &mut self.file else {
            return Ok(());
        };
        let mut end = file.seek(SeekFrom::End(0))?;
        // Zeros are written, because a page that finds no room on the disk later would end the program.
        let zeros = [0; LEAST_GROWTH];
        let growth = (end as usize / 2).clamp(LEAST_GROWTH, MOST_GROWTH);
        for _ in 0..growth.div_ceil(LEAST_GROWTH) {
            file.write_all(&zeros)?;
            end += LEAST_GROWTH as u64;
        }
        let map = MmapOptions::new().len(end as usize).map_raw(&*file)?;
        let map = Arc::new(map);
        lock(&self.folder.maps).push(Arc::downgrade(&map));
        self.map = Some(map);
        Ok(())
    }

    fn push(&mut self, item: T) {
        if self.len >= self.capacity()
            && !self.is_full
            && let Err(error) = self.grow()
        {
            lock(&self.folder.failure).get_or_insert(error);
            self.is_full = true;
        }
        if self.len >= self.capacity() {
            return;
        }
        // SAFETY: the map is longer than the items, writable, of this list alone, and begins at a page.
        unsafe { self.first().add(self.len).write(item) };
        self.len += 1;
    }
}

impl<T: Copy> List<T> {
    /// An empty list.
    pub(crate) fn within(folder: Option<&Arc<ListFolder>>) -> Self {
        let in_file = |folder: &Arc<ListFolder>| {
            Held::File(Mapped {
                folder: folder.clone(),
                file: None,
                map: None,
                len: 0,
                is_full: false,
                items: PhantomData,
            })
        };
        Self(folder.map_or(Held::Memory(Vec::new()), in_file))
    }

    /// Adds an item, or notes in the folder that there is no room for it.
    pub(crate) fn push(&mut self, item: T) {
        match &mut self.0 {
            Held::Memory(list) => list.push(item),
            Held::File(list) => list.push(item),
        }
    }

    /// Adds equal items up to a length.
    pub(crate) fn pad(&mut self, len: usize, item: T) {
        match &mut self.0 {
            Held::Memory(list) => list.resize(len.max(list.len()), item),
            Held::File(list) => (list.len..len).for_each(|_| list.push(item)),
        }
    }

    /// Keeps the items for which there is `true`.
    pub(crate) fn keep(&mut self, is_kept: &[bool]) {
        let mut kept = 0;
        for at in (0..self.len()).filter(|&at| is_kept[at]) {
            self[kept] = self[at];
            kept += 1;
        }
        match &mut self.0 {
            Held::Memory(list) => list.truncate(kept),
            Held::File(list) => list.len = kept,
        }
    }

    pub(crate) fn shrink_to_fit(&mut self) {
        if let Held::Memory(list) = &mut self.0 {
            list.shrink_to_fit();
        }
    }

    /// Bytes of memory.
    pub(crate) fn bytes(&self) -> usize {
        match &self.0 {
            Held::Memory(list) => size_of_val(&list[..]),
            Held::File(_) => 0,
        }
    }
}

impl<T: Copy> Deref for List<T> {
    type Target = [T];

    fn deref(&self) -> &[T] {
        match &self.0 {
            Held::Memory(list) => list,
            // SAFETY: so many items were written there, or it is a mesh file. Its bytes must not change, as those of
            // `src/graph/map.rs`.
            Held::File(list) => unsafe { slice::from_raw_parts(list.first(), list.len) },
        }
    }
}

impl<T: Copy> DerefMut for List<T> {
    fn deref_mut(&mut self) -> &mut [T] {
        match &mut self.0 {
            Held::Memory(list) => list,
            // SAFETY: as above, and the map is of this list alone.
            Held::File(list) => unsafe { slice::from_raw_parts_mut(list.first(), list.len) },
        }
    }
}

impl<T: Copy> Default for List<T> {
    fn default() -> Self {
        Self::within(None)
    }
}

impl<T: Copy> Clone for List<T> {
    fn clone(&self) -> Self {
        self.to_vec().into()
    }
}

impl<T: Copy> From<Vec<T>> for List<T> {
    fn from(list: Vec<T>) -> Self {
        Self(Held::Memory(list))
    }
}

impl<T: Copy + PartialEq> PartialEq for List<T> {
    fn eq(&self, other: &Self) -> bool {
        self[..] == other[..]
    }
}

impl<T: Copy + fmt::Debug> fmt::Debug for List<T> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self[..].fmt(f)
    }
}

#[cfg(test)]
mod tests {
    use std::fs;

    use super::*;

    #[test]
    fn a_list_in_a_file_is_as_one_in_memory() {
        let place = tempfile::tempdir().unwrap();
        let folder = ListFolder::new(place.path(), 0);
        let mut mapped = List::within(Some(&folder));
        let mut list: Vec<[u32; 3]> = Vec::new();
        assert!(mapped.is_empty());
        let items = (0..100_000).map(|n| [n, n / 2, n / 3]);
        for item in items.clone() {
            mapped.push(item);
            list.push(item);
            if item[0] % 9_999 == 0 {
                folder.release();
            }
        }
        mapped.pad(123_456, [7; 3]);
        list.resize(123_456, [7; 3]);
        assert!(mapped[..] == list[..] && mapped.bytes() == 0);
        let is_kept: Vec<bool> = (0..list.len()).map(|n| n % 3 != 1).collect();
        let mut number = 0..;
        list.retain(|_| is_kept[number.next().unwrap()]);
        mapped.keep(&is_kept);
        mapped[5] = [9; 3];
        list[5] = [9; 3];
        folder.release();
        assert!(mapped.clone() == mapped && mapped[..] == list[..]);
        assert!(fs::read_dir(place.path()).unwrap().next().is_none());
        assert!(folder.check().is_ok());
        let gone = ListFolder::new(&place.path().join("gone"), 0);
        let mut none = List::within(Some(&gone));
        none.pad(3, 1u8);
        assert!(none.is_empty());
        let told = gone.check().unwrap_err().to_string();
        assert!(told.contains("gone: cannot write"), "{told}");
    }
}
