"""The command `kinform`: one module per command, where output goes, and exit codes. No mathematics."""
