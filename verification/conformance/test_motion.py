"""Is the answer of the judged code right, for every case of a line or a network in motion?"""

LEVEL = "motion"


def test_motion(conformance, conformance_case):
    """By the bounds of the case; a failure says what mistake the answer matches."""
    conformance.check(conformance_case)
