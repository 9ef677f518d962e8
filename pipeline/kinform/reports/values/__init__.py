"""The values of a design as plain objects: what `kinform show --format json` prints, and the page embeds."""
