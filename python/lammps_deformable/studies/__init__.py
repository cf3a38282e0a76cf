"""Studies: each measures and draws one thing, and says what it shows."""
