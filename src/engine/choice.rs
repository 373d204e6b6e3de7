//! Closed sets of named alternatives: methods, samplers, tone operators. Each is defined once, by
//! `choice!` or `choices!`; the command line, view files and reports share its names and help texts.

use serde::de::{Deserializer, Error, Visitor};
use std::fmt;
use std::marker::PhantomData;

/// A value of a closed set that users choose from by name.
pub trait Choice: Copy + PartialEq + Send + Sync + 'static {
    /// The names of [`Choice::all`], in the same order.
    const NAMES: &'static [&'static str];
    /// Returns all alternatives, in the order in which help texts list them.
    fn all() -> &'static [Self];
    /// Returns the name in the command line, in view files and in reports.
    fn name(self) -> &'static str;
    /// Returns the help text: one sentence.
    fn about(self) -> &'static str;
    /// Returns the alternative with this name; names are case-sensitive.
    fn from_name(name: &str) -> Option<Self> {
        Self::all().iter().copied().find(|choice| choice.name() == name)
    }
}

/// Deserialises a [`Choice`] from its name; an unknown name is an error that lists the known ones.
pub fn deserialize<'de, C: Choice, D: Deserializer<'de>>(deserializer: D) -> Result<C, D::Error> {
    struct Name<C>(PhantomData<C>);
    impl<C: Choice> Visitor<'_> for Name<C> {
        type Value = C;
        fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
            f.write_str("a string")
        }
        fn visit_str<E: Error>(self, name: &str) -> Result<C, E> {
            C::from_name(name).ok_or_else(|| E::unknown_variant(name, C::NAMES))
        }
    }
    deserializer.deserialize_str(Name(PhantomData))
}

/// Makes a type a [`Choice`] of the values in parentheses, each with a name and a help text. In files
/// a value is its name.
macro_rules! choice {
    ($Choice:ident: $(($($value:tt)+) = $name:literal, $about:literal;)+) => {
        impl $Choice {
            /// All alternatives, in the order in which help texts list them.
            pub const ALL: [Self; [$($name),+].len()] = [$($($value)+),+];

            /// Returns the name in the command line, in view files and in reports.
            pub const fn name(self) -> &'static str {
                match self { $($($value)+ => $name),+ }
            }
        }

        impl $crate::choice::Choice for $Choice {
            const NAMES: &'static [&'static str] = &[$($name),+];
            fn all() -> &'static [Self] {
                &Self::ALL
            }
            fn name(self) -> &'static str {
                self.name()
            }
            fn about(self) -> &'static str {
                match self { $($($value)+ => $about),+ }
            }
        }

        impl serde::Serialize for $Choice {
            fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
                serializer.serialize_str(self.name())
            }
        }

        impl<'de> serde::Deserialize<'de> for $Choice {
            fn deserialize<D: serde::Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
                $crate::choice::deserialize(deserializer)
            }
        }
    };
}

/// Defines an enum that is a [`Choice`]. The help text of each variant is also the first paragraph of its
/// documentation.
macro_rules! choices {
    (
        $(#[$meta:meta])*
        pub enum $Choice:ident {
            $($(#[$variant_meta:meta])* $Variant:ident = $name:literal, $about:literal;)+
        }
    ) => {
        $(#[$meta])*
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
        pub enum $Choice {
            $(#[doc = $about] $(#[$variant_meta])* $Variant,)+
        }

        $crate::choice::choice!($Choice: $((Self::$Variant) = $name, $about;)+);
    };
}

pub(crate) use {choice, choices};
