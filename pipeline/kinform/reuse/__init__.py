"""Reuse of earlier results under one promise: the bytes of a run from nothing."""
