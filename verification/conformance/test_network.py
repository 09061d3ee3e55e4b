"""Is the answer of the judged code right, for every case of a network at rest?"""

LEVEL = "network"


def test_network(conformance, conformance_case):
    """By the bounds of the case; a failure says what mistake the answer matches."""
    conformance.check(conformance_case)
