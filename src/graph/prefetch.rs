//! Lists of a graph are larger than caches. Reading an entry early, while something else is done, hides the wait.

/// Begins to read an entry. Any place is allowed.
#[inline(always)]
#[cfg_attr(not(target_arch = "x86_64"), allow(unused_variables))]
pub fn prefetch<T>(entries: &[T], at: usize) {
    #[cfg(target_arch = "x86_64")]
    {
        use std::arch::x86_64::{_MM_HINT_T0, _mm_prefetch};
        let entry = entries.as_ptr().wrapping_add(at);
        // SAFETY: any address may be prefetched; nothing is read. All x86-64 processors have the instruction.
        unsafe { _mm_prefetch::<_MM_HINT_T0>(entry.cast()) };
    }
}
