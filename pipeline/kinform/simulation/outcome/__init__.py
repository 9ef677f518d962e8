"""What comes out of a run: reactions, balances, drives, records."""
