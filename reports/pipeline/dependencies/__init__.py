"""What each result depends on, where the packages are, and which results are still valid."""
