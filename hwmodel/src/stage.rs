//! Stages: the blocks of a design, which a program names.

use std::cmp::Ordering;
use std::fmt;
use std::hash::{Hash, Hasher};

use serde::{Serialize, Serializer};

/// Most stages of a design.
pub const MAX_STAGES: usize = 16;

/// A stage of a design: work that one block of the hardware does. Stages are equal if their numbers are. A record visits
/// its stages in the order of their numbers; number 0 takes it from the stack.
///
/// A program lists its stages with [`stages!`](crate::stages), and passes them where a `Stage` is expected.
#[derive(Clone, Copy)]
pub struct Stage {
    number: u8,
    name: &'static str,
}

impl Stage {
    /// The stage of a number below [`MAX_STAGES`], with its name in words.
    ///
    /// # Panics
    /// If the number is too large.
    pub const fn new(number: u8, name: &'static str) -> Self {
        assert!((number as usize) < MAX_STAGES, "too many stages");
        Self { number, name }
    }

    /// The number.
    #[inline(always)]
    pub const fn number(self) -> usize {
        // The remainder gives the compiler the bound.
        self.number as usize % MAX_STAGES
    }

    /// The name in words.
    pub const fn name(self) -> &'static str {
        self.name
    }

    /// The name in files: letters, digits and `_`.
    pub fn key(self) -> String {
        let name = self.name.trim_end_matches('?');
        name.replace(|letter: char| !letter.is_ascii_alphanumeric(), "_")
    }
}

impl Default for Stage {
    fn default() -> Self {
        Self::new(0, "start")
    }
}

/// The name without spaces, such as `VertexPool`.
impl fmt::Debug for Stage {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.key().split('_').try_for_each(|word| {
            let (first, rest) = word.split_at(word.len().min(1));
            write!(f, "{}{rest}", first.to_ascii_uppercase())
        })
    }
}

impl PartialEq for Stage {
    fn eq(&self, other: &Self) -> bool {
        self.number == other.number
    }
}

impl Eq for Stage {}

impl PartialOrd for Stage {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for Stage {
    fn cmp(&self, other: &Self) -> Ordering {
        self.number.cmp(&other.number)
    }
}

impl Hash for Stage {
    fn hash<H: Hasher>(&self, state: &mut H) {
        self.number.hash(state);
    }
}

impl Serialize for Stage {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_str(&self.key())
    }
}

/// Lists the stages of a design as an enum that converts into [`Stage`].
///
/// ```
/// hwmodel::stages! {
///     /// Stages of a box filter.
///     pub enum Filter {
///         Load = "load",
///         RowSum = "row sum",
///     }
/// }
///
/// let stage = hwmodel::Stage::from(Filter::RowSum);
/// assert_eq!((stage.number(), stage.key()), (1, "row_sum".to_owned()));
/// ```
#[macro_export]
macro_rules! stages {
    ($(#[$meta:meta])* $visible:vis enum $type:ident {
        $($(#[$doc:meta])* $variant:ident = $name:literal,)+
    }) => {
        $crate::named! {
            $(#[$meta])*
            #[derive(Debug, Clone, Copy, PartialEq, Eq)]
            #[repr(u8)]
            $visible enum $type { $($(#[$doc])* $variant = $name,)+ }
        }

        impl From<$type> for $crate::Stage {
            #[inline(always)]
            fn from(stage: $type) -> Self {
                Self::new(stage as u8, stage.name())
            }
        }

        impl PartialEq<$type> for $crate::Stage {
            fn eq(&self, other: &$type) -> bool {
                *self == Self::from(*other)
            }
        }
    };
}
