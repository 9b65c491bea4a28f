//! `mutants`: do the tests notice when a line of the board's code does something else?
//!
//! By hand, not in CI: each mutant is a build. A mutant is run with the tests of its module alone, none of which needs the harness. What was found:
//! `docs/firmware.md`, "Mutants".

use crate::shell::{ask, cargo, run, target};

/// A module, where it lies, and the tests that ask it.
struct Module {
    name: &'static str,
    package: &'static str,
    files: &'static str,
    test_packages: &'static str,
    tests: &'static [&'static str],
}

const MODULES: [Module; 5] = [
    Module {
        name: "plausibility",
        package: "rundown",
        files: "src/tick/plausibility.rs",
        test_packages: "rundown",
        tests: &["--lib", "tick::plausibility"],
    },
    Module {
        name: "store",
        package: "rundown",
        files: "src/onboard/store/*.rs",
        test_packages: "rundown,board-tests",
        // What takes longer than all else; what survives the others is to be asked by these, too.
        tests: &[
            "--lib",
            "--test",
            "store",
            "--",
            "--skip=a_cut_before_any_operation",
            "--skip=after_many_cuts",
            "--skip=wear_of_a_year",
        ],
    },
    Module {
        name: "auth",
        package: "rundown",
        files: "src/onboard/auth/*.rs",
        test_packages: "rundown,board-tests",
        tests: &["--lib", "--test", "auth", "--test", "task"],
    },
    Module {
        name: "task",
        package: "rundown",
        files: "src/onboard/task/*.rs",
        test_packages: "board-tests",
        tests: &["--test", "task", "--test", "hostile", "--test", "events", "--test", "faults"],
    },
    Module {
        name: "link",
        package: "rundown-wire",
        files: "wire/src/link/**",
        test_packages: "rundown-wire,board-tests",
        // The skipped one flips every two bits, which takes longer than all else.
        tests: &[
            "--lib",
            "--test",
            "link_can",
            "--test",
            "link_serial",
            "--test",
            "link_document",
            "--",
            "--skip=no_single_or_double_flip",
        ],
    },
];

/// The mutants of a module, or of each n-th one from the k-th on: `k/n`. Fails where one survives.
pub fn mutants(name: &str, share: &str) -> Result<(), String> {
    let names = MODULES.map(|module| module.name).join(", ");
    let module = MODULES.iter().find(|module| module.name == name);
    let module = module.ok_or_else(|| format!("expected a module ({names}), found `{name}`"))?;
    ask("cargo", &["mutants", "--version"]).ok_or("needs cargo-mutants: cargo install cargo-mutants --locked")?;
    let mut command = cargo();
    command.args(["mutants", "--package", module.package, "--file", module.files, "--profile", "mutants"]);
    command.args(["--test-package", module.test_packages, "--shard", share, "--sharding", "round-robin"]);
    command.args(["--timeout", "60", "--jobs", "1", "--output"]).arg(target().join("mutants").join(name));
    run(command.arg("--").args(module.tests)).map_err(|error| {
        format!("{error}\nwhich mutants survived is said above and in target/mutants/{name}/mutants.out/missed.txt")
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_unknown_module_is_named_beside_those_that_there_are() {
        let error = mutants("filter", "0/1").unwrap_err();
        assert_eq!(error, "expected a module (plausibility, store, auth, task, link), found `filter`");
    }

    #[test]
    fn every_module_has_files() {
        for module in MODULES {
            let folder = crate::shell::root().join(module.files.trim_end_matches(['*']).trim_end_matches("*.rs"));
            assert!(folder.exists(), "{}", module.files);
        }
    }
}
