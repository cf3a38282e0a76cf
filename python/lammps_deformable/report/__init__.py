"""The report: studies on one page."""
