//! The kinds of events, and of reasons why an attempt was rolled back, without their values.

use std::fmt;
use std::str::FromStr;

use super::{Event, Why};

/// Makes the enum of the kinds of a data enum from one list: each variant with its name in files and conditions.
macro_rules! kinds {
    ($(#[$doc:meta])* $kinds:ident of $data:ident { $($variant:ident $name:literal,)* }) => {
        $(#[$doc])*
        #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
        #[repr(u8)]
        pub enum $kinds {
            $(#[doc = concat!("The kind of [`", stringify!($data), "::", stringify!($variant), "`].")] $variant,)*
        }

        impl $kinds {
            /// All kinds, in the order of the variants.
            pub const ALL: &[$kinds] = &[$($kinds::$variant,)*];
            /// Their names, in the same order.
            pub const NAMES: &[&str] = &[$($name,)*];

            /// Its name, as in JSON (`kind`), in reports and in conditions of breakpoints.
            pub fn name(self) -> &'static str {
                $kinds::NAMES[self as usize]
            }
        }

        impl FromStr for $kinds {
            type Err = ();

            fn from_str(name: &str) -> Result<$kinds, ()> {
                $kinds::NAMES.iter().position(|&known| known == name).map(|index| $kinds::ALL[index]).ok_or(())
            }
        }

        impl fmt::Display for $kinds {
            fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str(self.name())
            }
        }

        impl $data {
            /// Its kind.
            pub fn kind(&self) -> $kinds {
                match self {
                    $($data::$variant { .. } => $kinds::$variant,)*
                }
            }
        }
    };
}

kinds! {
    /// The kind of an [`Event`].
    EventKind of Event {
        BaseSelected "base_selected",
        PickLost "pick_lost",
        SideIsFront "side_is_front",
        SideChosen "side_chosen",
        SideSwapped "side_swapped",
        SideDivided "side_divided",
        TopSwapped "top_swapped",
        TopSmoothed "top_smoothed",
        TopFound "top_found",
        NodeRemoved "node_removed",
        Formed "formed",
        RolledBack "rolled_back",
        Deferred "deferred",
        Enhanced "enhanced",
        Smoothed "smoothed",
        Seamed "seamed",
        TransitionSeamed "transition_seamed",
        SeamRefused "seam_refused",
        Split "split",
        SplitRefused "split_refused",
        Closed "closed",
        SecondPass "second_pass",
        Matched "matched",
        Patched "patched",
        LastResort "last_resort",
        Cleaned "cleaned",
        Refilled "refilled",
        RowLaid "row_laid",
        Swept "swept",
        Unfolded "unfolded",
        FaceConverted "face_converted",
        PostProcessed "post_processed",
        Mirrored "mirrored",
        Finished "finished",
    }
}

kinds! {
    /// The kind of a [`Why`].
    WhyKind of Why {
        NoSide "no_side",
        NoDivision "no_division",
        TopBlocked "top_blocked",
        TopThroughNode "top_through_node",
        TopTooLong "top_too_long",
        TopStuck "top_stuck",
        TooLong "too_long",
        NotDisc "not_disc",
        NotConvex "not_convex",
        Poor "poor",
        OddLoop "odd_loop",
        NoMetric "no_metric",
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The name that serde's `snake_case` gives to a variant.
    fn snake_case(variant: String) -> String {
        let words =
            variant.chars().map(|c| if c.is_uppercase() { format!("_{}", c.to_ascii_lowercase()) } else { c.into() });
        words.collect::<String>().trim_start_matches('_').to_owned()
    }

    #[test]
    fn names_are_those_of_json_and_can_be_parsed() {
        for &kind in EventKind::ALL {
            assert_eq!((kind.name(), kind.name().parse()), (snake_case(format!("{kind:?}")).as_str(), Ok(kind)));
        }
        for &kind in WhyKind::ALL {
            assert_eq!((kind.name(), kind.name().parse()), (snake_case(format!("{kind:?}")).as_str(), Ok(kind)));
        }
        assert_eq!("seam".parse::<EventKind>(), Err(()));
        let finished = serde_json::to_value(Event::Finished).unwrap();
        assert_eq!(finished["kind"], EventKind::Finished.name());
    }
}
