"""Links between pages, from claims to tests, and what a reader can search for."""
