//! Does the board do what it is asked, and only that? The tick task over a flash and a link of the test's own.

mod description;
mod effects;
mod keeping;
mod messages;
mod pace;
mod pieces;
mod report;
mod runs;
mod security;
mod snapshots;

use board_tests::board::Board;
use board_tests::flash::Flash;

fn board() -> Board {
    Board::start(Flash::erased(8))
}
