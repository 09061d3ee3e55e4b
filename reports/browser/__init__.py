"""The finished page in a real browser: does it load, is everything there, does nothing overlap or run over the edge?"""
