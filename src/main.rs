//! The firmware. On the host a program that runs the same application over stdin and stdout.
#![cfg_attr(target_os = "none", no_std, no_main)]

mod application;
#[cfg(target_os = "none")]
mod board;
#[cfg(target_os = "none")]
mod firmware;
#[cfg(not(target_os = "none"))]
mod host;

#[cfg(not(target_os = "none"))]
fn main() -> std::io::Result<()> {
    host::run()
}
