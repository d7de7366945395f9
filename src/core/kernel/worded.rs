//! Enumerations whose variants have one word each.

/// Defines an enumeration with the list of all its variants, `ALL`, and a method that gives the word of each.
macro_rules! worded {
    (
        $(#[$meta:meta])*
        pub enum $name:ident { $( $(#[$of_variant:meta])* $variant:ident = $word:literal, )+ }
        $(#[$of_all:meta])*
        const ALL;
        $(#[$of_method:meta])*
        fn $method:ident;
    ) => {
        $(#[$meta])*
        pub enum $name { $( $(#[$of_variant])* $variant, )+ }

        impl $name {
            $(#[$of_all])*
            pub const ALL: [$name; [$($word),+].len()] = [$($name::$variant),+];

            $(#[$of_method])*
            pub fn $method(self) -> &'static str {
                [$($word),+][self as usize]
            }
        }
    };
}

pub(crate) use worded;
