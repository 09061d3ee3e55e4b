"""Tools of the checks that do not depend on what is checked."""
