//! Options of `feedwright completions`.

use std::path::PathBuf;

use clap::Args;
use clap_complete::Shell;

/// Print the completion script of a shell
///
/// Shells read it from a place of their own, and complete commands, options and file names then.
#[derive(Debug, Args)]
#[command(after_long_help = "\
Examples:
  feedwright completions bash --out ~/.local/share/bash-completion/completions/feedwright
  feedwright completions zsh --out ~/.zfunc/_feedwright    (with fpath+=~/.zfunc before compinit in .zshrc)
  feedwright completions fish --out ~/.config/fish/completions/feedwright.fish")]
pub(crate) struct CompletionsArgs {
    /// The shell.
    pub(crate) shell: Shell,
    /// Place of the script.
    #[arg(long, value_name = "FILE", default_value = "-")]
    pub(crate) out: PathBuf,
}
