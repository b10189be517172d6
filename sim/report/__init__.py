"""What is told of a run: verdict, summary.json, report.html."""
