"""The page: tables, claims, verdicts, summary, templates."""
