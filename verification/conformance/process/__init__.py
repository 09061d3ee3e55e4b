"""A judged code in a process of its own: how it is named, started, asked and ended."""
