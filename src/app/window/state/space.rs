//! How the window shows meshes on surfaces.

use glam::DVec2;
use serde::{Deserialize, Serialize};

use crate::render::camera::Camera;
use crate::render::look::HiddenLines;
use crate::render::scene::Form;

/// Where the main view shows a mesh on surfaces.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Place {
    /// In space.
    #[default]
    Space,
    /// In its parametric plane.
    Plane,
    /// In space, and beside that in the plane.
    Both,
}

impl Place {
    /// All of them.
    pub const ALL: [Place; 3] = [Place::Space, Place::Both, Place::Plane];

    /// What it does, for menus.
    pub fn name(self) -> &'static str {
        match self {
            Place::Space => "Show in space",
            Place::Plane => "Show in the parametric plane",
            Place::Both => "Show in space and in the plane",
        }
    }

    /// Space where it is the plane, and the plane where it is not.
    pub fn toggled(self) -> Place {
        if self == Place::Plane { Place::Space } else { Place::Plane }
    }
}

/// How meshes on surfaces are shown in space.
#[derive(Clone, Copy, Debug)]
pub struct InSpace {
    /// Where they are shown.
    pub place: Place,
    /// How covered lines are drawn.
    pub hidden: HiddenLines,
    /// Whether elements follow the surface between their nodes.
    pub curved: bool,
    /// The camera; none until a mesh is fitted to the view.
    pub camera: Option<Camera>,
    /// Whether it shows the whole mesh.
    pub fitted: bool,
    /// The size of the view in points.
    pub size: DVec2,
}

impl Default for InSpace {
    fn default() -> Self {
        InSpace {
            place: Place::Space,
            hidden: HiddenLines::Off,
            curved: false,
            camera: None,
            fitted: true,
            size: DVec2::ZERO,
        }
    }
}

impl InSpace {
    /// Another case has been opened: one on surfaces is shown in space.
    pub fn begin(&mut self) {
        (self.camera, self.fitted) = (None, true);
        if self.place == Place::Plane {
            self.place = Place::Space;
        }
    }

    /// How the scene in space is laid out.
    pub fn form(&self) -> Form {
        if self.curved { Form::Curved } else { Form::Flat }
    }
}
