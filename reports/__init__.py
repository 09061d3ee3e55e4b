"""The page: runs tests and benchmarks as child processes and shows what they wrote. It computes no physics."""
