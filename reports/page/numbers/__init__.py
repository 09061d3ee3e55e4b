"""Numbers as the page says them: counts and ratios, profiles, tables, verdicts, how they are printed."""
