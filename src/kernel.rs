//! How the loops over columns run: in wide vectors where the machine has them, and on as many threads as they are told to.
//!
//! A loop is written once, over fixed arrays of lanes, and compiled once for each width; which one runs is decided when
//! it runs. The arithmetic is the same: nothing is fused or reordered, so that neither width nor threads change an
//! answer. This is the one file of the crate with unsafe code: calls of functions that are compiled for more than the
//! machine is sure to have, made once it is known to have it.

use std::sync::atomic::{AtomicU8, Ordering};

/// How wide vectors are.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[repr(u8)]
pub enum Width {
    /// What the crate is compiled for: on x86-64 that is 128 bits unless the build says otherwise.
    Compiled,
    /// 256 bits.
    Avx2,
    /// 512 bits.
    Avx512,
}

impl Width {
    /// All widths, the narrowest first.
    pub const ALL: [Self; 3] = [Self::Compiled, Self::Avx2, Self::Avx512];

    /// Whether the machine has it.
    pub fn is_here(self) -> bool {
        match self {
            Self::Compiled => true,
            #[cfg(target_arch = "x86_64")]
            Self::Avx2 => has_avx2(),
            #[cfg(target_arch = "x86_64")]
            Self::Avx512 => has_avx2() && has_avx512(),
            #[cfg(not(target_arch = "x86_64"))]
            _ => false,
        }
    }
}

/// One more than the width in use; 0 where that is yet to be found out.
static WIDEST: AtomicU8 = AtomicU8::new(0);

/// Keeps all frames of this process to vectors no wider than this, for tests and measurements: answers are the same.
/// Returns the width in use from now on.
pub fn limit_width(width: Width) -> Width {
    let here = |w: &&Width| **w <= width && w.is_here();
    let widest = Width::ALL.iter().rev().find(here).copied().unwrap_or(Width::Compiled);
    WIDEST.store(widest as u8 + 1, Ordering::Relaxed);
    widest
}

/// The width in use: 256 bits where the machine has them, unless it is [limited](limit_width) to more or less. By
/// default 512 are not used: measured on a machine that has them they were no faster, and slower while the columns are
/// in the caches.
pub fn width() -> Width {
    match WIDEST.load(Ordering::Relaxed) {
        0 => limit_width(Width::Avx2),
        1 => Width::Compiled,
        2 => Width::Avx2,
        _ => Width::Avx512,
    }
}

/// A loop without branches on its data. [`Kernel::run`] and all that it calls must be `#[inline(always)]` or small, or
/// they are compiled for narrow vectors alone.
pub(crate) trait Kernel: Sized {
    /// What it adds up.
    type Sum;

    /// Runs it.
    fn run(self) -> Self::Sum;
}

/// A kernel over columns that can be cut in two.
pub(crate) trait Divisible: Kernel<Sum: Send> + Send {
    /// How many objects it is about, roughly.
    fn len(&self) -> usize;

    /// The two halves, one of which may be empty.
    fn halves(self) -> [Self; 2];

    /// The sum of the whole from those of the halves.
    fn join(sums: [Self::Sum; 2]) -> Self::Sum;
}

/// Runs a kernel in vectors of the width in use.
#[inline]
pub(crate) fn run<K: Kernel>(kernel: K) -> K::Sum {
    match width() {
        Width::Compiled => kernel.run(),
        #[cfg(target_arch = "x86_64")]
        Width::Avx2 => avx2(kernel),
        #[cfg(target_arch = "x86_64")]
        Width::Avx512 => avx512(kernel),
        #[cfg(not(target_arch = "x86_64"))]
        _ => kernel.run(),
    }
}

/// Fewer objects are not worth another thread.
const PART: usize = 1 << 14;

/// Runs a kernel on so many threads of the pool that the caller is in; on the caller's alone without the feature
/// `rayon`.
pub(crate) fn run_on<K: Divisible>(threads: usize, kernel: K) -> K::Sum {
    if threads < 2 || kernel.len() < 2 * PART {
        return run(kernel);
    }
    let ([first, second], half) = (kernel.halves(), threads / 2);
    K::join(both(|| run_on(threads - half, first), || run_on(half, second)))
}

#[cfg(feature = "rayon")]
fn both<T: Send>(first: impl FnOnce() -> T + Send, second: impl FnOnce() -> T + Send) -> [T; 2] {
    rayon::join(first, second).into()
}

#[cfg(not(feature = "rayon"))]
fn both<T>(first: impl FnOnce() -> T, second: impl FnOnce() -> T) -> [T; 2] {
    [first(), second()]
}

#[cfg(target_arch = "x86_64")]
fn has_avx2() -> bool {
    is_x86_feature_detected!("avx2")
        && is_x86_feature_detected!("bmi1")
        && is_x86_feature_detected!("bmi2")
        && is_x86_feature_detected!("lzcnt")
        && is_x86_feature_detected!("popcnt")
}

#[cfg(target_arch = "x86_64")]
fn has_avx512() -> bool {
    is_x86_feature_detected!("avx512f")
        && is_x86_feature_detected!("avx512bw")
        && is_x86_feature_detected!("avx512cd")
        && is_x86_feature_detected!("avx512dq")
        && is_x86_feature_detected!("avx512vl")
}

/// Runs a kernel compiled for 256 bits. Fused multiplication is left out: rounding once instead of twice would change
/// answers.
#[cfg(target_arch = "x86_64")]
#[expect(unsafe_code, reason = "a call of what is compiled for more than the baseline")]
fn avx2<K: Kernel>(kernel: K) -> K::Sum {
    #[target_feature(enable = "avx2,bmi1,bmi2,lzcnt,popcnt")]
    fn compiled<K: Kernel>(kernel: K) -> K::Sum {
        kernel.run()
    }
    debug_assert!(Width::Avx2.is_here());
    // SAFETY: a width comes into use only where the machine has it, see `limit_width`.
    unsafe { compiled(kernel) }
}

/// Runs a kernel compiled for 512 bits, as [`avx2`] does for 256.
#[cfg(target_arch = "x86_64")]
#[expect(unsafe_code, reason = "a call of what is compiled for more than the baseline")]
fn avx512<K: Kernel>(kernel: K) -> K::Sum {
    #[target_feature(enable = "avx2,bmi1,bmi2,lzcnt,popcnt,avx512f,avx512bw,avx512cd,avx512dq,avx512vl")]
    fn compiled<K: Kernel>(kernel: K) -> K::Sum {
        kernel.run()
    }
    debug_assert!(Width::Avx512.is_here());
    // SAFETY: as above.
    unsafe { compiled(kernel) }
}
