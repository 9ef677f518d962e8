"""Connected components, blocks, spanning trees, cycles. No physics here."""
