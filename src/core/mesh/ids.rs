//! Typed ids. A half-edge is `4 * element + corner`; a triangle uses three of the four slots of its element.

use std::fmt;

use serde::Serialize;

macro_rules! id {
    ($(#[$doc:meta])* $name:ident) => {
        $(#[$doc])*
        #[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize)]
        #[repr(transparent)]
        pub struct $name(pub u32);

        impl $name {
            /// The index of this id in the arrays.
            #[inline]
            pub fn index(self) -> usize {
                self.0 as usize
            }
        }

        impl fmt::Debug for $name {
            fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                write!(f, concat!(stringify!($name), "({})"), self.0)
            }
        }
    };
}

id! {
    /// A node of the mesh, with one fan of elements around it.
    NodeId
}
id! {
    /// A triangle or a quadrilateral.
    ElementId
}
id! {
    /// A side of an element, directed anticlockwise: slot `corner` of its element starts at the node of that corner.
    HalfEdgeId
}
id! {
    /// A point of the geometry or of the output: the nodes on both sides of a repeated line share one.
    PointId
}

impl ElementId {
    /// The half-edge that starts at the given corner (0..3).
    #[inline]
    pub fn half_edge(self, corner: u32) -> HalfEdgeId {
        HalfEdgeId(self.0 * 4 + corner)
    }
}

impl HalfEdgeId {
    /// The element of this side.
    #[inline]
    pub fn element(self) -> ElementId {
        ElementId(self.0 >> 2)
    }

    /// The corner (0..3) of its element at which it starts.
    #[inline]
    pub fn corner(self) -> u32 {
        self.0 & 3
    }
}
