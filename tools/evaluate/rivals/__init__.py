"""What tools/evaluate/report_rivals is made of."""
