//! Edited files with right lengths and checksums are refused or drawn, in little memory: the allocator refuses more.
#![allow(clippy::unwrap_used, reason = "the helpers of tests fail like tests")]

mod exercise;
mod seal;

use std::alloc::{GlobalAlloc, Layout, System};
use std::sync::atomic::{AtomicUsize, Ordering};

use exercise::Format;
use shiftvox::split_mix::SplitMix;

/// Files are of 2 to 20 kB.
const MOST: usize = 256 << 20;

/// The system's allocator, but for at most [`MOST`] bytes in use.
struct Limited(AtomicUsize);

#[global_allocator]
static ALLOCATOR: Limited = Limited(AtomicUsize::new(0));

// SAFETY: a request is refused, or passed on to the system's allocator as it is.
unsafe impl GlobalAlloc for Limited {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        let before = self.0.fetch_add(layout.size(), Ordering::Relaxed);
        if before + layout.size() > MOST {
            self.0.fetch_sub(layout.size(), Ordering::Relaxed);
            return std::ptr::null_mut();
        }
        // SAFETY: the caller keeps the contract, which is the system's.
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        self.0.fetch_sub(layout.size(), Ordering::Relaxed);
        // SAFETY: the pointer came from `alloc`.
        unsafe { System.dealloc(pointer, layout) }
    }
}

#[test]
fn truncated_and_damaged_files_are_refused() {
    for (format, sound, _) in exercise::sound_files() {
        let is_sound = |bytes: &[u8]| exercise::is_sound(format, bytes);
        assert!(is_sound(&sound) && !is_sound(&[&sound[..], &[0]].concat()));
        for at in 0..sound.len() {
            let mut damaged = sound.clone();
            damaged[at] ^= 1 << (at % 8);
            let is_refused = !is_sound(&damaged) && !is_sound(&sound[..at]);
            assert!(is_refused, "{format:?}, byte {at}");
        }
    }
}

#[test]
fn edited_files_are_refused_or_drawn() {
    const ALL: [Format; 3] = [Format::Vxg, Format::Far, Format::Tvx];
    let folder = tempfile::tempdir().unwrap();
    // Of each format: refused, sound.
    let mut found = [[0u32; 2]; 3];
    for seed in 0..1500 {
        let mut random = SplitMix::new(seed);
        let edits = random.below(5);
        let choices = (0..=edits).map(|_| random.bits());
        let Some((format, bytes)) = exercise::edited(&ALL, choices) else {
            continue;
        };
        let path = folder.path().join("edited.vxg");
        println!("seed {seed}");
        let is_sound = exercise::exercise(format, &bytes, &path);
        found[format as usize][usize::from(is_sound)] += 1;
        // Putting a sound file right changes nothing.
        assert!(is_sound || edits > 0);
    }
    // Neither all nor none: what is behind the checksums is reached.
    assert!(found.iter().flatten().all(|&files| files > 50), "{found:?}");
}
