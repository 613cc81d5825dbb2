//! Where there are no vector instructions.

pub(in crate::fast) use super::Scalar as Vector;
