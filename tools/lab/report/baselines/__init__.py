"""What tools/lab/report/report_baselines is made of."""
