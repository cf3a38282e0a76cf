"""The report: the laws against smooth rings, and the paper's results, measured anew."""

from .writing import write_report as write_report
