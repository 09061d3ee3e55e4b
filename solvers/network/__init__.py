"""Networks of lines at rest: MSQS sections 3 to 5."""
