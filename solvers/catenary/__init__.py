"""One elastic line at rest: MSQS section 2."""
