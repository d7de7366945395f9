//! gradation: being written.
