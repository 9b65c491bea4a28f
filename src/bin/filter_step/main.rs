//! Test-only, for the emulated mps2-an386: what a step of the filter costs. Nothing on the host.
#![cfg_attr(target_os = "none", no_std, no_main)]

#[cfg(target_os = "none")]
mod image;

#[cfg(not(target_os = "none"))]
fn main() {}
