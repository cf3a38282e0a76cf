"""Files: what is written, how it is read back. Everything here takes plain values."""
