"""What every measurement shares: command line, harness, result files, machine, kept oracle answers."""
