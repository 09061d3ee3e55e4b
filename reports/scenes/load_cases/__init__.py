"""The sections on tables of load cases: what lines feel, and what the tables cost and err by."""
