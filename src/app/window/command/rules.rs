//! Sets of values of all parameters.

use crate::core::case::Parameters;
use crate::core::kernel::worded::worded;

worded! {
    /// Values of all parameters at once.
    #[derive(Clone, Copy, Debug, PartialEq, Eq)]
    pub enum Rules by name {
        /// As `--paper` sets them.
        Paper = "Paper",
        /// The defaults of the program.
        Default = "Default",
    }
}

impl Rules {
    /// The parameters; those that belong to a case have no meaning.
    pub fn parameters(self) -> Parameters {
        match self {
            Rules::Paper => Parameters::paper(),
            Rules::Default => Parameters::default(),
        }
    }
}
