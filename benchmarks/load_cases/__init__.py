"""Tables of load cases from the command line, and what they cost beside MoorDyn."""
