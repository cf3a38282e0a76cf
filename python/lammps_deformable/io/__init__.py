"""Files, written and read from plain values."""
