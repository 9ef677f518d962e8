"""What comes apart: contact pushes and does not pull."""
