"""Is the answer of the judged code right, for every case of a line at rest?"""

LEVEL = "statics"


def test_statics(conformance, conformance_case):
    """By the bounds of the case; a failure says what mistake the answer matches."""
    conformance.check(conformance_case)
