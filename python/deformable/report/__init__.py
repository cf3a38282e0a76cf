"""The report: what studies measure and draw, on one page."""
