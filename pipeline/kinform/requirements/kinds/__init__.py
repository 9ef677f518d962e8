"""One kind of requirement a module; its name is the `kind` of the table, and `KIND` is what there is of it."""
