//! Enums whose variants have names in the window.

/// Defines such an enum, with the list of its variants and the name of each.
macro_rules! named {
    ($(#[$about:meta])* $visible:vis enum $kind:ident { $($(#[$doc:meta])* $variant:ident = $name:literal,)* }) => {
        $(#[$about])*
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        $visible enum $kind {
            $($(#[$doc])* $variant,)*
        }

        impl $kind {
            /// All of them, in order.
            pub const ALL: [$kind; [$($name),*].len()] = [$($kind::$variant),*];

            /// Its name in menus and panels.
            pub fn name(self) -> &'static str {
                match self {
                    $($kind::$variant => $name,)*
                }
            }
        }
    };
}

pub(super) use named;
