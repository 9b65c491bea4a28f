//! Instructions of one filter step (predict and update, gradient look-ups included), counted by valgrind's callgrind.
//!
//! `cargo bench -p host-tests --bench instructions`. The program runs itself under callgrind with n and with 2n steps;
//! the difference over n is the count of one step, exactly, with nothing of the start in it.

mod drive;

use drive::Drive;
use std::hint::black_box;
use std::process::Command;

const STEPS: usize = 900;

fn main() {
    let arguments: Vec<String> = std::env::args().collect();
    if let [_, flag, which, steps] = arguments.as_slice()
        && flag == "--run"
    {
        let drive = Drive::of_reference();
        let steps = steps.parse().expect("a number of steps");
        black_box(match which.as_str() {
            "ours" => drive.ours(steps),
            "textbook" => drive.textbook(steps),
            _ => drive.nothing(steps),
        });
        return;
    }
    if Command::new("valgrind").arg("--version").output().is_err() {
        println!("instructions: not counted, valgrind is not on the PATH");
        return;
    }
    let per_step = |which: &str| {
        let once = counted(which, STEPS);
        let twice = counted(which, 2 * STEPS);
        (twice - once) as f64 / STEPS as f64
    };
    let loop_alone = per_step("nothing");
    let ours = per_step("ours") - loop_alone;
    let textbook = per_step("textbook") - loop_alone;
    println!("instructions of one step, paper's model, reference track (goal: at most 500)");
    println!("  rundown   {ours:8.1}    90 steps {:9.0}", 90.0 * ours);
    println!("  textbook  {textbook:8.1}    90 steps {:9.0}    {:.1} times ours", 90.0 * textbook, textbook / ours);
}

/// Instructions of the whole process.
fn counted(which: &str, steps: usize) -> i64 {
    let program = std::env::current_exe().expect("path of this bench");
    let output = Command::new("valgrind")
        .args(["--tool=callgrind", "--callgrind-out-file=/dev/null"])
        .arg(program)
        .args(["--run", which, &steps.to_string()])
        .output()
        .expect("valgrind runs");
    let text = String::from_utf8_lossy(&output.stderr);
    let count =
        text.lines().find_map(|line| line.split_once("Collected :")).and_then(|(_, count)| count.trim().parse().ok());
    count.unwrap_or_else(|| panic!("callgrind printed no count:\n{text}"))
}
