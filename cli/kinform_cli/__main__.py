"""`python -m kinform_cli` is `kinform`."""

from kinform_cli.main import entry

entry()
