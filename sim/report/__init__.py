"""The results of a run: verdict, summary.json, report.html."""
