"""What the whole can do: loops, freedoms, mobility."""
