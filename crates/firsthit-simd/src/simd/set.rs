//! The instruction sets, and which of them this machine has.

use std::str::FromStr;
use std::sync::OnceLock;

use crate::error::{Error, Result};
use crate::parallel;

/// A family of vector instructions that kernels are compiled for. Results do not depend on it, only
/// times do.
///
/// ```
/// use firsthit::shoot::{Cpu, Engine};
/// use firsthit::{DVec3, InstructionSet, Object, Ray, Scene, Sphere};
///
/// let scene = Scene::new(vec![Object::new(Sphere::new(DVec3::ZERO, 1.0)?)])?;
/// let ray = Ray::new(DVec3::new(0.1, 0.2, 5.0), DVec3::NEG_Z);
/// let (fast, plain) = (Cpu::current()?, Cpu::with(InstructionSet::Portable));
/// assert_eq!(fast.first_hit(&scene, &ray).t, plain.first_hit(&scene, &ray).t);
/// # Ok::<(), firsthit::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum InstructionSet {
    /// The instructions that the compiler makes of plain Rust.
    Portable,
    /// WebAssembly's `simd128`. A module that is compiled for it has no other, and runs it
    /// whichever is asked for.
    Simd128,
    /// NEON, of 64-bit ARM.
    Neon,
    /// AVX2 and fused multiply-add.
    Avx2,
    /// AVX-512 F, BW, DQ and VL.
    Avx512,
}

/// The environment variable that chooses one.
const VARIABLE: &str = "FIRSTHIT_ISA";

impl InstructionSet {
    /// All instruction sets, from the plainest to the fastest.
    pub const ALL: [Self; 5] =
        [Self::Portable, Self::Simd128, Self::Neon, Self::Avx2, Self::Avx512];

    /// The name, as in `FIRSTHIT_ISA`.
    pub fn name(self) -> &'static str {
        match self {
            Self::Portable => "portable",
            Self::Simd128 => "simd128",
            Self::Neon => "neon",
            Self::Avx2 => "avx2",
            Self::Avx512 => "avx512",
        }
    }

    /// Whether this machine has it.
    pub fn is_available(self) -> bool {
        match self {
            Self::Portable => true,
            Self::Simd128 => cfg!(all(target_arch = "wasm32", target_feature = "simd128")),
            #[cfg(all(target_arch = "aarch64", target_feature = "neon", target_endian = "little"))]
            Self::Neon => super::neon::is_available(),
            #[cfg(target_arch = "x86_64")]
            Self::Avx2 => super::avx2::is_available(),
            #[cfg(target_arch = "x86_64")]
            Self::Avx512 => super::avx512::is_available(),
            // Those of other architectures.
            _ => false,
        }
    }

    /// The instruction sets of this machine, from the plainest to the fastest.
    pub fn available() -> impl DoubleEndedIterator<Item = Self> {
        Self::ALL.into_iter().filter(|set| set.is_available())
    }

    /// The instruction set that new scenes use: that of the environment variable `FIRSTHIT_ISA`
    /// (`portable`, `simd128`, `neon`, `avx2` or `avx512`), or the fastest of this machine where
    /// that is not set or empty. The variable is read once.
    ///
    /// # Errors
    ///
    /// [`Error::Argument`] when the variable names none, or one that this machine does not have.
    pub fn current() -> Result<Self> {
        static CURRENT: OnceLock<std::result::Result<InstructionSet, String>> = OnceLock::new();
        let said = || std::env::var_os(VARIABLE).filter(|name| !name.is_empty());
        let chosen = parallel::once(&CURRENT, || match said() {
            None => Ok(Self::fastest()),
            Some(name) => {
                let name = name.to_string_lossy();
                name.parse::<Self>().map_err(|_| name.into_owned())
            }
        });
        match chosen {
            Ok(set) => Ok(*set),
            Err(name) => Err(Error::argument(VARIABLE, Self::expected(), name)),
        }
    }

    /// The instruction sets of this machine, in words.
    fn expected() -> &'static str {
        match Self::fastest() {
            Self::Portable => "portable, the only instruction set of this machine",
            Self::Simd128 => "an instruction set of this module (portable or simd128)",
            Self::Neon => "an instruction set of this machine (portable or neon)",
            Self::Avx2 => "an instruction set of this machine (portable or avx2)",
            Self::Avx512 => "an instruction set of this machine (portable, avx2 or avx512)",
        }
    }

    /// Whether [`run`](super::run) with the set ends in lanes that have packets, on this machine.
    #[doc(hidden)]
    pub fn has_packets(self) -> bool {
        match self {
            Self::Portable => cfg!(all(target_arch = "wasm32", target_feature = "simd128")),
            #[cfg(target_arch = "x86_64")]
            Self::Avx512 => super::avx2::is_available(),
            _ => self.is_available(),
        }
    }

    fn fastest() -> Self {
        Self::available().next_back().unwrap_or(Self::Portable)
    }
}

impl FromStr for InstructionSet {
    type Err = Error;

    /// # Errors
    ///
    /// [`Error::Argument`] for any other name, and for a set that this machine does not have.
    fn from_str(name: &str) -> Result<Self> {
        Self::available()
            .find(|set| set.name() == name)
            .ok_or_else(|| Error::argument("instruction set", Self::expected(), name))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_lead_back_to_what_is_available() {
        for set in InstructionSet::ALL {
            assert_eq!(set.name().parse().ok(), set.is_available().then_some(set));
        }
    }

    #[test]
    fn the_plainest_comes_first_and_the_fastest_last() {
        let sets: Vec<_> = InstructionSet::available().collect();
        assert_eq!(sets.first(), Some(&InstructionSet::Portable));
        assert_eq!(sets.last(), Some(&InstructionSet::fastest()));
        assert!(sets.is_sorted_by_key(|set| *set as u8));
    }

    #[test]
    fn only_what_the_machine_has_is_offered() {
        let error = "sse9".parse::<InstructionSet>().unwrap_err().to_string();
        assert!(error.starts_with("instruction set must be "), "{error}");
        assert!(error.ends_with(", got sse9"), "{error}");
        for set in InstructionSet::ALL {
            assert_eq!(error.contains(set.name()), set.is_available(), "{error}");
        }
    }
}
