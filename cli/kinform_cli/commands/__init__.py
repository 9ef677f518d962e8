"""The commands, one module each. They import the library when they run, so that `--help` stays quick."""
