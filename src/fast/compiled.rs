//! The steps of the traversal, compiled for each instruction set.

use super::band::{Band, Brick, Compiled, Record};
use super::lanes::Scalar;
use super::window::Window;
use super::{bricks, traversal, voxels};

impl Compiled for Scalar {
    fn visit_children(self, band: &mut Band<'_, Self>, record: &Record) {
        traversal::visit_children(band, record);
    }
    fn brick(self, band: &mut Band<'_, Self>, brick: Brick<'_>, window: &Window) {
        bricks::draw(band, brick, window);
    }
    fn deep_brick(self, band: &mut Band<'_, Self>, brick: Brick<'_>, window: &Window) {
        bricks::draw_deep(band, brick, window);
    }
    fn voxels(self, band: &mut Band<'_, Self>, brick: Brick<'_>, window: &Window) {
        voxels::draw(band, brick, window);
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
                fn $name(self, band: &mut Band<'_, Self>, $($argument: $type),*) {
                    #[inline(never)]
                    #[target_feature(enable = "avx2,fma,bmi1,bmi2,lzcnt,popcnt")]
                    fn compiled(band: &mut Band<'_, Avx2>, $($argument: $type),*) {
                        $body(band, $($argument),*);
                    }
                    // SAFETY: an `Avx2` is only made where these features were found.
                    unsafe { compiled(band, $($argument),*) };
                })*
            }
        };
    }
    compiled! {
        visit_children(record: &Record) = traversal::visit_children;
        brick(brick: Brick<'_>, window: &Window) = bricks::draw;
        deep_brick(brick: Brick<'_>, window: &Window) = bricks::draw_deep;
        voxels(brick: Brick<'_>, window: &Window) = voxels::draw;
    }
}
