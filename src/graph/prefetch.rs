//! Lists of a graph are larger than caches. Reading an entry early, while something else is done, hides the wait.

/// Starts the read of an entry and does not wait for it. Any place is allowed.
#[inline(always)]
#[cfg_attr(not(target_arch = "x86_64"), allow(unused_variables))]
pub fn prefetch<T>(entries: &[T], at: usize) {
    #[cfg(target_arch = "x86_64")]
    {
        use std::arch::x86_64::{_MM_HINT_T0, _mm_prefetch};
        let entry = entries.as_ptr().wrapping_add(at);
        // SAFETY: all x86-64 processors have the instruction, which takes any address and reads nothing.
        unsafe { _mm_prefetch::<_MM_HINT_T0>(entry.cast()) };
    }
}
