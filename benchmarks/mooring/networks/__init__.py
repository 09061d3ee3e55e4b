"""Moving networks of lines: four systems beside MoorDyn, error against run time, growth with lines, damping."""
