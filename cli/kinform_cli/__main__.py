"""`python -m kinform_cli` is `kinform`."""

from kinform_cli import working_folder

working_folder.forget(first=True)

from kinform_cli.main import entry  # noqa: E402

entry()
