//! Arithmetic of eight numbers at once, for code that is written for one.

use super::lanes::{Lanes, inlined};
use crate::geometry::arithmetic::Arithmetic;

/// Eight float64 at a time.
#[derive(Debug, Clone, Copy)]
pub struct InLanes<L>(pub L);

impl<L: Lanes> Arithmetic for InLanes<L> {
    type Number = L::Doubles;
    type Mask = u8;

    inlined! {
        fn number(self, x: f64) -> L::Doubles = self.0.splat64(x);
        fn add(self, a: L::Doubles, b: L::Doubles) -> L::Doubles = self.0.add64(a, b);
        fn sub(self, a: L::Doubles, b: L::Doubles) -> L::Doubles = self.0.sub64(a, b);
        fn mul(self, a: L::Doubles, b: L::Doubles) -> L::Doubles = self.0.mul64(a, b);
        fn div(self, a: L::Doubles, b: L::Doubles) -> L::Doubles = self.0.div64(a, b);
        fn sqrt(self, a: L::Doubles) -> L::Doubles = self.0.sqrt64(a);
        fn max(self, a: L::Doubles, b: L::Doubles) -> L::Doubles = self.0.max64(a, b);
        fn lt(self, a: L::Doubles, b: L::Doubles) -> u8 = self.0.lt64(a, b);
        fn le(self, a: L::Doubles, b: L::Doubles) -> u8 = self.0.le64(a, b);
        fn is_everywhere(self, mask: u8) -> bool = mask == u8::MAX;
        fn is_anywhere(self, mask: u8) -> bool = mask != 0;
    }

    #[inline(always)]
    fn fused_mul_add(self, a: L::Doubles, b: L::Doubles, c: L::Doubles) -> L::Doubles {
        self.0.fused_mul_add64(a, b, c)
    }
    #[inline(always)]
    fn fused_mul_sub(self, a: L::Doubles, b: L::Doubles, c: L::Doubles) -> L::Doubles {
        self.0.fused_mul_sub64(a, b, c)
    }
    #[inline(always)]
    fn fused_neg_mul_add(self, a: L::Doubles, b: L::Doubles, c: L::Doubles) -> L::Doubles {
        self.0.fused_neg_mul_add64(a, b, c)
    }
    #[inline(always)]
    fn select(self, mask: u8, a: L::Doubles, b: L::Doubles) -> L::Doubles {
        self.0.select64(mask, a, b)
    }
}
