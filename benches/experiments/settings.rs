//! What is held against what: the questions, and the settings that answer them.

use quadfront::core::case::Parameters;

/// Parameters of an experiment.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Setting {
    /// The defaults.
    Defaults,
    /// The defaults but for these keys.
    With(&'static [(&'static str, &'static str)]),
    /// The paper's own reading of everything.
    Paper,
}

/// A question with the settings that answer it; each table begins with the defaults.
pub struct Question {
    pub asks: &'static str,
    /// How the defaults are called in its table.
    pub defaults: &'static str,
    pub others: &'static [Setting],
    /// Whether it is also asked of the mesh as the front leaves it.
    pub of_the_front: bool,
}

/// All of them, in the order of the paper's sections.
pub const QUESTIONS: [Question; 10] = [
    Question {
        asks: "Which order of base segments? (4.3.3)",
        defaults: "table1, metric_length_times_h",
        others: &[
            Setting::With(&[("selection_window", "h_value")]),
            Setting::With(&[("selection_window", "physical_length")]),
            Setting::With(&[("selection", "level")]),
            Setting::With(&[("selection", "smallest_angle")]),
            Setting::With(&[("selection", "shortest")]),
        ],
        of_the_front: true,
    },
    Question {
        asks: "How far may the window reach, and what is a corner? (4.3.3, table 1)",
        defaults: "c 2, theta_rect 135",
        others: &[
            Setting::With(&[("c", "1.5")]),
            Setting::With(&[("c", "3")]),
            Setting::With(&[("theta_rect", "120")]),
            Setting::With(&[("theta_rect", "150")]),
        ],
        of_the_front: true,
    },
    Question {
        asks: "Where do side edges aim, and which are taken? (4.3.4)",
        defaults: "right angle, side_deviation 30, side_split 1.5",
        others: &[
            Setting::With(&[("bisector", "true")]),
            Setting::With(&[("side_deviation", "40")]),
            Setting::With(&[("side_split", "1.25")]),
            Setting::With(&[("side_split", "2")]),
        ],
        of_the_front: true,
    },
    Question {
        asks: "Which sides are divided, and where, and what is tried first on failure? (4.3.4, vi)",
        defaults: "whole_below 1, midpoint, left_neighbour",
        others: &[
            Setting::With(&[("whole_below", "0")]),
            Setting::With(&[("division_at", "metric_middle")]),
            Setting::With(&[("first_rescue", "division")]),
        ],
        of_the_front: true,
    },
    Question {
        asks: "Are new top nodes placed, or smoothed by eq. (9)? (4.3.6)",
        defaults: "placement",
        others: &[Setting::With(&[("placement", "false")])],
        of_the_front: true,
    },
    Question {
        asks: "What do smoothing and enhancement around each new quadrilateral give? (4.3.6)",
        defaults: "both",
        others: &[
            Setting::With(&[("smoothing", "false")]),
            Setting::With(&[("enhancement", "false")]),
            Setting::With(&[("smoothing", "false"), ("enhancement", "false")]),
        ],
        of_the_front: true,
    },
    Question {
        asks: "In which order, over which nodes and by which weights? (4.3.4 top v, 4.3.6, eqs. 10)",
        defaults: "delete_first, all three groups, printed, top_smoothing",
        others: &[
            Setting::With(&[("enhancement_order", "swap_first")]),
            Setting::With(&[("smooth_joined", "false")]),
            Setting::With(&[("smoothing_weights", "determinant")]),
            Setting::With(&[("top_smoothing", "false")]),
        ],
        of_the_front: true,
    },
    Question {
        asks: "What do seams and front splitting give? (4.3.6)",
        defaults: "both, theta_seam 30, seam_widening 3",
        others: &[
            Setting::With(&[("seam_widening", "1")]),
            Setting::With(&[("seam_widening", "2")]),
            Setting::With(&[("theta_seam", "45")]),
            Setting::With(&[("seaming", "false")]),
            Setting::With(&[("splitting", "false")]),
            Setting::With(&[("seaming", "false"), ("splitting", "false")]),
        ],
        of_the_front: true,
    },
    Question {
        asks: "What does the post-processing of the whole mesh give? (4.3.7)",
        defaults: "clean-up and smoothing",
        others: &[Setting::With(&[("clean_up", "traditional")]), Setting::With(&[("post_processing", "false")])],
        of_the_front: false,
    },
    Question {
        asks: "What does the paper's own reading come to?",
        defaults: "defaults",
        others: &[
            Setting::Paper,
            Setting::With(&[("selection_window", "physical_length"), ("clean_up", "traditional")]),
            Setting::With(&[("placement", "false"), ("clean_up", "traditional")]),
        ],
        of_the_front: true,
    },
];

impl Setting {
    /// Every setting that a question needs, once.
    pub fn all() -> Vec<Setting> {
        let mut all = vec![Setting::Defaults];
        for setting in QUESTIONS.iter().flat_map(|question| question.others) {
            if !all.contains(setting) {
                all.push(*setting);
            }
        }
        all
    }

    /// The parameters of a case by this setting: its size and its rows stay.
    pub fn applied_to(&self, parameters: &Parameters) -> Parameters {
        let mut parameters = parameters.clone();
        match self {
            Setting::Defaults => {}
            Setting::With(keys) => keys.iter().for_each(|(key, value)| parameters.set(key, value).unwrap()),
            Setting::Paper => parameters = parameters.read_as_paper(),
        }
        parameters
    }

    /// As it would be written on the command line, but for the defaults.
    pub fn words(&self) -> String {
        match self {
            Setting::Defaults => "defaults".to_owned(),
            Setting::With(keys) => {
                keys.iter().map(|(key, value)| format!("`{key}={value}`")).collect::<Vec<_>>().join(", ")
            }
            Setting::Paper => "`--paper`".to_owned(),
        }
    }
}
