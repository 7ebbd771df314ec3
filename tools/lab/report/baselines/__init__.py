"""Modules of tools/lab/report/report_baselines."""
