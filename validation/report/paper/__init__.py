"""The paper's results on one particle between walls, and its packing."""
