"""The report: the laws against rings of beads, and the paper's results, measured anew."""

from .writing import write_report as write_report
