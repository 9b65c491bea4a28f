//! The firmware. On the host a program that runs the same application over stdin and stdout.
#![cfg_attr(target_os = "none", no_std, no_main)]

#[cfg(target_os = "none")]
#[path = "../../board/mod.rs"]
mod board;
#[cfg(target_os = "none")]
mod can;
#[cfg(not(target_os = "none"))]
mod host;
#[cfg(target_os = "none")]
mod tasks;

#[cfg(not(target_os = "none"))]
fn main() -> std::io::Result<()> {
    host::run()
}
