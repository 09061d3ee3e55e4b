"""The first page: five questions with their answers in short, one figure each."""
