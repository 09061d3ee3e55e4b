"""What a run of the cases leaves: verdicts summed by feature, a report in JSON, a badge."""
