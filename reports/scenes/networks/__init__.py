"""The section on network files, which is also the page about somebody's own network."""
