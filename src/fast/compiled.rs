//! The steps of the walk, compiled for each instruction set.

use super::lanes::Scalar;
use super::state::{Brick, Compiled, Record, Walk};
use super::window::Window;
use super::{bricks, voxels, walk};

impl Compiled for Scalar {
    fn turn(self, walk: &mut Walk<'_, Self>, record: &Record) {
        walk::turn(walk, record);
    }
    fn brick(self, walk: &mut Walk<'_, Self>, brick: Brick<'_>, window: &Window) {
        bricks::draw(walk, brick, window);
    }
    fn deep_brick(self, walk: &mut Walk<'_, Self>, brick: Brick<'_>, window: &Window) {
        bricks::draw_deep(walk, brick, window);
    }
    fn voxels(self, walk: &mut Walk<'_, Self>, brick: Brick<'_>, window: &Window) {
        voxels::draw(walk, brick, window);
    }
}

#[cfg(target_arch = "x86_64")]
mod avx2 {
    use super::*;
    use crate::fast::lanes::Avx2;

    /// A function that is compiled for the set, and its call.
    macro_rules! compiled {
        ($($name:ident($($argument:ident: $type:ty),*) = $body:path;)*) => {
            impl Compiled for Avx2 {
                $(#[inline(always)]
                fn $name(self, walk: &mut Walk<'_, Self>, $($argument: $type),*) {
                    #[inline(never)]
                    #[target_feature(enable = "avx2,fma,bmi1,bmi2,lzcnt,popcnt")]
                    fn compiled(walk: &mut Walk<'_, Avx2>, $($argument: $type),*) {
                        $body(walk, $($argument),*);
                    }
                    // SAFETY: an `Avx2` is only made where these features were found.
                    unsafe { compiled(walk, $($argument),*) };
                })*
            }
        };
    }
    compiled! {
        turn(record: &Record) = walk::turn;
        brick(brick: Brick<'_>, window: &Window) = bricks::draw;
        deep_brick(brick: Brick<'_>, window: &Window) = bricks::draw_deep;
        voxels(brick: Brick<'_>, window: &Window) = voxels::draw;
    }
}
