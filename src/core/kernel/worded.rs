//! Enumerations whose variants have one word each.

/// Defines an enumeration with the list of all its variants, `ALL`, and a method of the given name for their words.
macro_rules! worded {
    (
        $(#[$meta:meta])*
        pub enum $name:ident by $method:ident { $( $(#[$of_variant:meta])* $variant:ident = $word:literal, )+ }
    ) => {
        $(#[$meta])*
        pub enum $name { $( $(#[$of_variant])* $variant, )+ }

        impl $name {
            /// All of them, in the order of menus and messages.
            pub const ALL: [$name; [$($word),+].len()] = [$($name::$variant),+];

            /// The word of the variant.
            pub fn $method(self) -> &'static str {
                [$($word),+][self as usize]
            }
        }
    };
}

pub(crate) use worded;
