//! Phosphor's icons by name.

pub const SKIP_BACK: &str = "\u{e5a4}";
pub const CARET_DOUBLE_LEFT: &str = "\u{e128}";
pub const CARET_LEFT: &str = "\u{e138}";
pub const PLAY: &str = "\u{e3d0}";
pub const PAUSE: &str = "\u{e39e}";
pub const CARET_RIGHT: &str = "\u{e13a}";
pub const CARET_DOUBLE_RIGHT: &str = "\u{e12a}";
pub const SKIP_FORWARD: &str = "\u{e5a6}";
pub const ARROW_LINE_LEFT: &str = "\u{e062}";
pub const ARROW_LINE_RIGHT: &str = "\u{e064}";
pub const BOOKMARK: &str = "\u{e0ea}";
pub const CROSSHAIR: &str = "\u{e1d6}";
pub const STACK: &str = "\u{e466}";
pub const CORNERS_OUT: &str = "\u{e1d0}";
pub const CHECK_CIRCLE: &str = "\u{e184}";
pub const X_CIRCLE: &str = "\u{e4f8}";
pub const MAGNIFYING_GLASS: &str = "\u{e30c}";
pub const RESET: &str = "\u{e038}";
pub const LIST: &str = "\u{e2f2}";
pub const X: &str = "\u{e4f6}";
pub const CARET_UP: &str = "\u{e13c}";
pub const CARET_DOWN: &str = "\u{e136}";
pub const CHECK: &str = "\u{e182}";
pub const EYE: &str = "\u{e220}";
