"""Options of pytest, here so that a file of any folder takes them alone."""


def pytest_addoption(parser):
    parser.addoption(
        "--deep",
        action="store_true",
        default=False,
        help="the long version: 5000 random lines and 5000 Hypothesis examples against 50 digits",
    )
