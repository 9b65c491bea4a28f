//! The command `rundown`. All of it is in the library: [`sim_harness::commands`].
#![forbid(unsafe_code)]

fn main() -> std::process::ExitCode {
    sim_harness::commands::main()
}
