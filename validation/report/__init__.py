"""The report: errors and run times of the contact laws, the paper's results, on one page."""
