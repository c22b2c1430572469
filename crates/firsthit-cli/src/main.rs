//! The firsthit program; everything is in its library.

use std::process::ExitCode;

fn main() -> ExitCode {
    ExitCode::from(firsthit_cli::run(std::env::args_os()))
}
