//! `mutants`: do the tests notice when a line of the board's code does something else?
//!
//! By hand, not in CI: each mutant is a build. A mutant is run with the tests of its module alone, none of which needs
//! the harness. What was found: `docs/firmware.md`, "Mutants".

use crate::shell::{ask, cargo, run, target};

/// A module, where it lies, and the tests that ask it.
struct Module {
    name: &'static str,
    package: &'static str,
    files: &'static str,
    test_packages: &'static [&'static str],
    /// What is built of those packages. Nothing else is: each mutant waits for it.
    targets: &'static [&'static str],
    /// Which of their tests.
    tests: &'static [&'static str],
}

const MODULES: [Module; 5] = [
    Module {
        name: "plausibility",
        package: "rundown",
        files: "src/tick/plausibility.rs",
        test_packages: &["rundown"],
        targets: &["--lib"],
        tests: &["tick::plausibility"],
    },
    Module {
        name: "store",
        package: "rundown",
        files: "src/onboard/store/*.rs",
        test_packages: &["rundown", "board-tests"],
        targets: &["--lib", "--test=store"],
        // What takes longer than all else; what survives the others is to be asked by these, too.
        tests: &["--", "--skip=a_cut_before_any_operation", "--skip=after_many_cuts", "--skip=wear_of_a_year"],
    },
    Module {
        name: "auth",
        package: "rundown",
        files: "src/onboard/auth/*.rs",
        test_packages: &["rundown", "board-tests"],
        targets: &["--lib", "--test=auth", "--test=task"],
        tests: &[],
    },
    Module {
        name: "task",
        package: "rundown",
        files: "src/onboard/task/*.rs",
        test_packages: &["board-tests"],
        targets: &["--test=task", "--test=hostile", "--test=events", "--test=faults"],
        tests: &[],
    },
    Module {
        name: "link",
        package: "rundown-wire",
        files: "wire/src/link/**",
        test_packages: &["rundown-wire", "board-tests"],
        targets: &["--lib", "--test=link_can", "--test=link_serial", "--test=link_document"],
        // It flips every two bits, which takes longer than all else.
        tests: &["--", "--skip=no_single_or_double_flip"],
    },
];

/// The mutants of a module, or of each n-th one from the k-th on: `k/n`. Fails where one survives.
pub fn mutants(name: &str, share: &str) -> Result<(), String> {
    let names = MODULES.map(|module| module.name).join(", ");
    let module = MODULES.iter().find(|module| module.name == name);
    let module = module.ok_or_else(|| format!("expected a module ({names}), found `{name}`"))?;
    ask("cargo", &["mutants", "--version"]).ok_or("needs cargo-mutants: cargo install cargo-mutants --locked")?;
    unchanged(module)?;
    let mut command = cargo();
    command.args(["mutants", "--package", module.package, "--file", module.files, "--profile", "mutants"]);
    command.args(["--test-package", &module.test_packages.join(","), "--shard", share, "--sharding", "round-robin"]);
    command.args(module.targets.iter().map(|target| format!("--cargo-arg={target}")));
    command.args(["--baseline", "skip", "--timeout", "60", "--jobs", "1"]);
    command.arg("--output").arg(target().join("mutants").join(name));
    run(command.arg("--").args(module.tests)).map_err(|error| {
        format!("{error}\nwhich mutants survived is said above and in target/mutants/{name}/mutants.out/missed.txt")
    })
}

/// The tests with nothing changed: where they fail, each mutant would count as caught. The baseline of cargo-mutants
/// asks the changed package alone, which does not have the tests of `board-tests`.
fn unchanged(module: &Module) -> Result<(), String> {
    let mut command = cargo();
    command.args(["test", "--quiet", "--profile", "mutants"]);
    command.args(module.test_packages.iter().map(|package| format!("--package={package}")));
    run(command.args(module.targets).args(module.tests))
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

    #[test]
    fn every_test_target_exists() {
        let tests = crate::shell::root().join("host-tests/board/tests");
        let targets = MODULES.iter().flat_map(|module| module.targets);
        for name in targets.filter_map(|target| target.strip_prefix("--test=")) {
            let exists = tests.join(format!("{name}.rs")).exists() || tests.join(name).join("main.rs").exists();
            assert!(exists, "{name}");
        }
    }
}
