//! The `lod` command: parses, calls the library, prints. Every command is a file of its own.
#![forbid(unsafe_code)]

mod bake;
mod compare;
mod generate;
mod inspect;
mod solve;
mod text;

use std::io::{self, BufWriter, Write};
use std::process::ExitCode;

use clap::error::ErrorKind;
use clap::{Parser, Subcommand};

/// Level-of-detail selection under a frame-time budget.
#[derive(Parser)]
#[command(name = "lod", version, after_help = EXAMPLES)]
struct Cli {
    #[command(subcommand)]
    command: Command,
}

const EXAMPLES: &str = "\
Examples:
  lod compare                        every policy in the bundled building
  lod compare city --out report      … and a report with plots in ./report
  lod bake rock.obj                  levels of a mesh, measured, in ./baked
  lod inspect scene.glb              what is in a file, and what is odd about it
  lod solve instance.json --exact    one knapsack, solved to the optimum

Exit status: 0 done, 1 a check failed, 2 bad input or usage.";

#[derive(Subcommand)]
enum Command {
    Compare(Box<compare::Args>),
    Bake(Box<bake::Args>),
    Inspect(inspect::Args),
    Solve(solve::Args),
    Generate(generate::Args),
}

/// Bad input or usage.
const REFUSED: u8 = 2;

fn main() -> ExitCode {
    match Cli::try_parse() {
        Ok(cli) => run(cli.command).unwrap_or_else(|error| refuse(&error)),
        Err(usage) => explain(&usage),
    }
}

fn run(command: Command) -> anyhow::Result<ExitCode> {
    let mut out = BufWriter::new(io::stdout().lock());
    let mut complaints = Vec::new();
    match command {
        Command::Compare(args) => compare::run(&args, &mut out)?,
        Command::Bake(args) => complaints = bake::run(&args, &mut out)?,
        Command::Inspect(args) => inspect::run(&args, &mut out)?,
        Command::Solve(args) => solve::run(&args, &mut out)?,
        Command::Generate(args) => generate::run(&args, &mut out)?,
    }
    out.flush()?;
    let status = complaints.iter().fold(ExitCode::SUCCESS, |_, message| complain(message));
    Ok(status)
}

/// Says in one line what was wrong. A reader of ours that has seen enough is nothing wrong.
fn refuse(error: &anyhow::Error) -> ExitCode {
    let io_kinds = error.chain().filter_map(|e| e.downcast_ref::<io::Error>()).map(io::Error::kind);
    if io_kinds.into_iter().any(|kind| kind == io::ErrorKind::BrokenPipe) {
        return ExitCode::SUCCESS;
    }
    complain(&format!("{error:#}"))
}

fn complain(message: &str) -> ExitCode {
    // Where nobody listens to errors, the exit status still tells.
    let _ = writeln!(io::stderr(), "lod: {}", message.replace(['\n', '\r'], " "));
    ExitCode::from(REFUSED)
}

/// Prints help and version as they were asked for, and one line about any other usage.
fn explain(usage: &clap::Error) -> ExitCode {
    match usage.kind() {
        ErrorKind::DisplayHelp | ErrorKind::DisplayVersion => {
            // Nothing is left to be done for a reader who is gone.
            let _ = usage.print();
            ExitCode::SUCCESS
        }
        ErrorKind::DisplayHelpOnMissingArgumentOrSubcommand => {
            let _ = usage.print();
            ExitCode::from(REFUSED)
        }
        _ => complain(&first_paragraph(&usage.to_string())),
    }
}

/// The error itself, without its label, tips and usage.
fn first_paragraph(message: &str) -> String {
    let paragraph = message.split("\n\n").next().unwrap_or_default();
    let lines: Vec<&str> = paragraph.lines().map(str::trim).collect();
    let line = lines.join(" ");
    line.strip_prefix("error: ").unwrap_or(&line).to_owned()
}
