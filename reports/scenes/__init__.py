"""The section on scene files, which is also the page about somebody's own lines."""
