"""Stages of the report as child processes, their results, and what each result depends on."""
