"""Truth of moving lines of nodes and elements: loads, networks in time, friction, bounces."""
