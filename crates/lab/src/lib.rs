//! Experiments: what the renderer's rules cost and what they do to a picture.
//! Each gives plain data and a table. What was found: `spec/lab.md`.
#![allow(missing_docs, reason = "the names of figures end with their units")]

pub mod bench;
pub mod bounds;
pub mod float_rays;
pub mod measure;
pub mod model;
pub mod quality;
pub mod report;
pub mod reproduce;
pub mod rival;
pub mod stress;
