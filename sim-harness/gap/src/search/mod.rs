//! Which terms of the resistance are missing, and how sure each is.

pub mod agreement;
pub mod fits;
pub mod fitting;
pub mod headwind;
pub mod limits;
pub mod scan;
pub mod selection;
pub mod shape;
pub mod some_runs;
